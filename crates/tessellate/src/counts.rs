//! The number of segments of every curve, common to both sides and, where that is cheap, to opposite edges.
//!
//! Opposite edges of a rectangle, and all edges of a polygon, join a family with one count, so that the patch gets a regular
//! grid. A family takes the largest demand of its members; it does not grow beyond [`SPREAD`] times the smallest one, or a single bent
//! patch would refine a whole network. Patches whose edges then disagree are triangulated freely.

use suture_surface::Domain;

use crate::{
    demand::{Demand, QuadDemand},
    net::Net,
    options::Limits,
    union_find::UnionFind,
};

/// Largest ratio between the demands within one family.
const SPREAD: f64 = 6.0;

/// Numbers of segments.
pub(crate) struct Counts {
    /// Family of every curve.
    family: Vec<usize>,
    /// Number of segments of every family, by its smallest curve.
    count: Vec<usize>,
    /// Whether a patch gets a regular grid.
    pub(crate) structured: Vec<bool>,
    most: usize,
}

impl Counts {
    /// From the demand of every curve and of the interior of every rectangle and polygon.
    pub(crate) fn new(net: &Net, curves: &[Demand], patches: &[Option<QuadDemand>], limits: &Limits) -> Self {
        let mut families = Families {
            sets: UnionFind::new(net.curves.len()),
            range: curves
                .iter()
                .zip(&net.curves)
                .map(|(demand, curve)| {
                    // A collapsed curve takes any count: it asks for nothing and limits nothing.
                    if curve.collapsed { [f64::INFINITY, 2.0] } else { [demand.segments(limits).max(2.0); 2] }
                })
                .collect(),
        };
        let mut structured = vec![false; net.frames.len()];
        let mut even = vec![false; net.curves.len()];
        // Rectangles first: strips in rows are where regular grids matter most.
        for polygons in [false, true] {
            for (patch, frame) in net.frames.iter().enumerate() {
                let curves: Vec<usize> = frame.sides.iter().map(|s| s.curve).collect();
                let Some(demand) = &patches[patch] else { continue };
                let [nu, nv] = demand.segments(limits);
                structured[patch] |= match frame.domain {
                    Domain::Rectangle { .. } if !polygons => {
                        let joined = [
                            families.join(&[curves[0], curves[2]], nu),
                            families.join(&[curves[1], curves[3]], nv),
                        ];
                        joined == [true; 2]
                    }
                    // The two directions of the quadrilateral around a corner are half-edges.
                    Domain::Polygon(_) if polygons => {
                        let joined = families.join(&curves, 2.0 * nu.max(nv));
                        curves.iter().filter(|_| joined).for_each(|&c| even[c] = true);
                        joined
                    }
                    _ => continue,
                };
            }
        }
        let most = limits.segments & !1;
        let family: Vec<usize> = (0..net.curves.len()).map(|c| families.sets.find(c)).collect();
        let mut count = vec![2; family.len()];
        for (c, &f) in family.iter().enumerate() {
            let curve = &net.curves[c];
            let wanted = (families.range[f][1] * (1.0 - 1e-12)).ceil().min(most as f64) as usize;
            // A closed curve of two segments would be one edge, run through both ways.
            let least = if curve.ends[0] == curve.ends[1] && !curve.collapsed { 3 } else { 2 };
            count[f] = count[f].max(wanted).max(least);
        }
        for (c, &f) in family.iter().enumerate() {
            if even[c] {
                count[f] += count[f] % 2;
            }
        }
        Self { family, count, structured, most }
    }

    /// Number of segments of curve `c`.
    pub(crate) fn of(&self, c: usize) -> usize {
        self.count[self.family[c]]
    }

    /// Doubles the number of segments of the family of `c`; `false` if it is as large as allowed.
    pub(crate) fn raise(&mut self, c: usize) -> bool {
        let count = &mut self.count[self.family[c]];
        let raised = (2 * *count).min(self.most);
        std::mem::replace(count, raised) < raised
    }
}

/// Families under construction with the smallest and largest demand of each.
struct Families {
    sets: UnionFind,
    range: Vec<[f64; 2]>,
}

impl Families {
    /// Joins the families of `curves` with one more demand; refuses if their demands differ too much.
    fn join(&mut self, curves: &[usize], demand: f64) -> bool {
        let demand = demand.max(2.0);
        let range = curves.iter().fold([demand; 2], |[lo, hi], &c| {
            let [l, h] = self.range[self.sets.find(c)];
            [lo.min(l), hi.max(h)]
        });
        // Not `hi > SPREAD * lo`: NaN must refuse.
        let joins = range[1] <= SPREAD * range[0];
        if joins {
            curves.iter().for_each(|&c| self.sets.join(curves[0], c));
            let root = self.sets.find(curves[0]);
            self.range[root] = range;
        }
        joins
    }
}
