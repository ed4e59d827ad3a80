//! The search for widths at which every map is usable.

use crate::assemble::{Blend, assemble};
use crate::check::{Findings, Obstacle};
use crate::maps::{CornerMaps, Memory};
use crate::widths::{WidthOptions, Widths};
use crate::{BlendError, Network};

/// How often widths shrink before the obstacle becomes the error.
const ATTEMPTS: usize = 60;
/// By how much they shrink at a time.
const SHRINK: f64 = 0.8;
/// Lengths of strips, as multiples of the first one, that are tried in turn on an arc whose chain folds: longer ones pass over what
/// scatters, shorter ones follow what bends.
const LENGTHS: [f64; 5] = [1.0, 2.0, 0.5, 1.4, 0.7];

/// Part of the wanted width below which blends become narrower only where they cannot be made otherwise.
const NARROW: f64 = 0.2;

/// Blends a network of B-splines into one C² surface.
///
/// Widths that were not given shrink, at the corners concerned, until every map is usable; where a chain folds, the length of
/// its strips changes as well.
///
/// # Errors
/// [`BlendError`]: the network is inconsistent, or an obstacle remains (see [`Obstacle`]).
pub fn blend(network: &Network, maps: &dyn CornerMaps, options: &WidthOptions) -> Result<Blend, BlendError> {
    Sewing::new(network.clone(), maps, options)?.sew()
}

/// A network whose arcs may be drawn anew where no width fits: what did not change keeps its widths and its maps.
pub struct Sewing<'a> {
    network: Network,
    maps: &'a dyn CornerMaps,
    options: WidthOptions,
    widths: Widths,
    /// Lengths of strips that [`LENGTHS`] multiply, and how often the chain of every arc folded.
    lengths: Vec<f64>,
    folds: Vec<usize>,
    /// Whether nothing is borne that other arcs may mend.
    strict: bool,
    memory: Memory,
    findings: Findings,
}

impl<'a> Sewing<'a> {
    /// All widths as wide as wanted.
    ///
    /// # Errors
    /// [`BlendError`]: the network is inconsistent, or a width is not positive.
    pub fn new(
        network: Network,
        maps: &'a dyn CornerMaps,
        options: &WidthOptions,
    ) -> Result<Self, BlendError> {
        network.check()?;
        let widths = Widths::resolve(&network, maps, options)?;
        let lengths = widths.shortest.clone();
        let folds = vec![0; lengths.len()];
        let (memory, findings) = Default::default();
        Ok(Self { network, maps, options: *options, widths, lengths, folds, strict: false, memory, findings })
    }

    /// Goes on with other lines for some arcs: around these the widths start again.
    ///
    /// # Errors
    /// [`BlendError`]: the network is inconsistent, or not the same but for its arcs.
    pub fn redraw(&mut self, network: Network) -> Result<(), BlendError> {
        network.check()?;
        if !network.differs_in_arcs_only(&self.network) {
            return Err(BlendError::Inconsistent {
                what: "more than the course of arcs differs from before".into(),
            });
        }
        let fresh = Widths::resolve(&network, self.maps, &self.options)?;
        let before = std::mem::replace(&mut self.network, network);
        for (a, arc) in self.network.arcs.iter().enumerate() {
            if *arc == before.arcs[a] {
                continue;
            }
            self.folds[a] = 0;
            self.lengths[a] = fresh.shortest[a];
            self.widths.shortest[a] = fresh.shortest[a];
            for c in arc.corners {
                self.widths.corner[c] = fresh.corner[c];
                self.widths.reductions[c] = 0;
            }
            self.findings.forget(a, arc.corners);
        }
        Ok(())
    }

    /// Whether to refuse what other arcs may mend: narrow blends, and blends that fold though their maps do not. At first it does not.
    pub fn be_strict(&mut self, strict: bool) {
        self.strict = strict;
    }

    /// Makes the maps, narrower and narrower where they cannot be used, and of them the surface.
    ///
    /// # Errors
    /// [`BlendError`]: where no width fits. [`BlendError::Obstacles`] names every arc that could be drawn differently.
    pub fn sew(&mut self) -> Result<Blend, BlendError> {
        for attempt in 0..=ATTEMPTS {
            let obstacles = match self.maps.maps(&self.network, &self.widths, &mut self.memory) {
                Ok(set) => {
                    let report = self.findings.update(&self.network, set, &self.widths.corner);
                    let shrinks = |o: &Obstacle| attempt < ATTEMPTS && self.shrinks(o);
                    match self.findings.maps() {
                        Some(set) if report.obstacles.iter().all(|o| self.bears(o) && !shrinks(o)) => {
                            return assemble(&self.network, set, self.widths.clone(), report);
                        }
                        _ => report.obstacles,
                    }
                }
                Err(errors) => errors.into_iter().map(|e| self.too_short(e)).collect::<Result<_, _>>()?,
            };
            if attempt == ATTEMPTS || !self.narrow(&obstacles) {
                return Err(self.unusable(obstacles));
            }
        }
        Err(self.unusable(Vec::new()))
    }

    fn bears(&self, obstacle: &Obstacle) -> bool {
        obstacle.bearable() && !(self.strict && matches!(obstacle.error, BlendError::Crumpled { .. }))
    }

    /// Whether the blends at a corner may become narrower for the sake of this obstacle.
    fn may_shrink(&self, corner: usize, obstacle: &Obstacle) -> bool {
        let WidthOptions { d_in, d_out, narrowest, wanted, .. } = self.options;
        let comfort = self.strict || obstacle.bearable();
        let narrowest = if comfort { narrowest.max(NARROW * wanted) } else { narrowest };
        let automatic = d_in.is_none() && d_out.is_none();
        automatic && self.widths.corner[corner] * SHRINK >= narrowest * self.network.diagonal
    }

    /// Whether all blends that an obstacle depends on may become narrower.
    fn shrinks(&self, obstacle: &Obstacle) -> bool {
        !obstacle.corners.is_empty() && obstacle.corners.iter().all(|&c| self.may_shrink(c, obstacle))
    }

    /// The obstacle that an arc without room is. How narrow the blends at its ends have to be is known.
    fn too_short(&mut self, error: BlendError) -> Result<Obstacle, BlendError> {
        let BlendError::ArcTooShort { corners, limit, .. } = error else { return Err(error) };
        for c in corners {
            let limit = limit.max(self.options.narrowest) * self.network.diagonal;
            self.widths.corner[c] = self.widths.corner[c].min(limit / SHRINK);
        }
        // What takes the room is the angle between arcs that leave one of its corners.
        let arcs = corners.iter().flat_map(|&c| &self.network.corners[c].arcs).map(|end| end.arc).collect();
        Ok(Obstacle { error, corners: corners.to_vec(), chain: None, arcs })
    }

    /// Shrinks the widths that obstacles depend on; `false` where none may shrink.
    fn narrow(&mut self, obstacles: &[Obstacle]) -> bool {
        let count = self.widths.corner.len();
        let (mut shrinks, mut folds_at) = (vec![false; count], vec![false; count]);
        let mut folding = vec![false; self.folds.len()];
        for obstacle in obstacles {
            obstacle.corners.iter().for_each(|&c| shrinks[c] |= self.may_shrink(c, obstacle));
            if !obstacle.bearable() && !matches!(obstacle.error, BlendError::ArcTooShort { .. }) {
                obstacle.corners.iter().for_each(|&c| folds_at[c] = true);
            }
            if let Some(arc) = obstacle.chain.filter(|_| !obstacle.bearable()) {
                folding[arc] = true;
            }
        }
        for arc in (0..folding.len()).filter(|&a| folding[a]) {
            if self.network.arcs[arc].corners.iter().any(|&c| shrinks[c]) {
                self.folds[arc] += 1;
                self.widths.shortest[arc] = self.lengths[arc] * LENGTHS[self.folds[arc] % LENGTHS.len()];
            }
        }
        for c in (0..count).filter(|&c| shrinks[c]) {
            self.widths.corner[c] *= SHRINK;
            self.widths.reductions[c] += u32::from(folds_at[c]);
        }
        shrinks.contains(&true)
    }

    fn unusable(&self, mut obstacles: Vec<Obstacle>) -> BlendError {
        obstacles.retain(|o| !self.bears(o));
        let segment = |o: &Obstacle| match o.error {
            BlendError::Fold { segment, .. }
            | BlendError::Overlap { segment }
            | BlendError::OutsideDomain { segment, .. } => Some(segment),
            _ => None,
        };
        let mut segments: Vec<usize> = obstacles.iter().filter_map(segment).collect();
        segments.sort_unstable();
        segments.dedup();
        let mut arcs: Vec<usize> = obstacles.iter().flat_map(|o| &o.arcs).copied().collect();
        arcs.sort_unstable();
        arcs.dedup();
        let none = BlendError::Inconsistent { what: "no width was found in the attempts allowed".into() };
        match obstacles.into_iter().next().map_or(none, |o| o.error) {
            first if arcs.is_empty() => first,
            first => BlendError::Obstacles { first: Box::new(first), segments, arcs },
        }
    }
}
