//! The data of a page: a head and sections of numbers, packed.
//!
//! Bytes: length of the head (4, little endian), the head (JSON), the sections; all of it compressed (RFC 1952) and written as base64 (RFC
//! 4648). A section holds unsigned numbers of 1 to 4 bytes as planes, the lowest bytes of all numbers first: planes of high bytes hardly change
//! and take little room. `viewer/src/data.js` reads them.

use std::io::Write;

use base64::{Engine, engine::general_purpose::STANDARD};
use flate2::{Compression, write::GzEncoder};
use glam::DVec3;
use serde::Serialize;

use crate::ViewError;

/// Largest number of 24 bits.
const MOST: f64 = ((1u32 << 24) - 1) as f64;

/// Where a section is and how its numbers are read.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Section {
    offset: usize,
    count: usize,
    width: usize,
    /// Numbers are differences to the one so many places before, sign in the lowest bit; 0: they are themselves.
    delta: usize,
    /// Number `i` means `min[i mod n] + step[i mod n] ×` itself; empty for plain numbers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    min: Vec<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    step: Vec<f64>,
}

/// Sections under construction.
#[derive(Debug, Default)]
pub(crate) struct Payload {
    body: Vec<u8>,
}

impl Payload {
    /// Plain numbers.
    pub(crate) fn integers(&mut self, numbers: &[u32], delta: usize) -> Section {
        let coded: Vec<u32> = if delta == 0 {
            numbers.to_vec()
        } else {
            (0..numbers.len())
                .map(|i| {
                    let before = if i < delta { 0 } else { numbers[i - delta] };
                    let d = numbers[i].wrapping_sub(before) as i32;
                    (d << 1 ^ d >> 31) as u32
                })
                .collect()
        };
        let most = coded.iter().fold(0, |m, &c| m | c);
        let width = (4 - most.leading_zeros() as usize / 8).max(1);
        let offset = self.body.len();
        self.body.reserve(width * coded.len());
        for plane in 0..width {
            self.body.extend(coded.iter().map(|c| (c >> (8 * plane)) as u8));
        }
        Section { offset, count: numbers.len(), width, delta, min: vec![], step: vec![] }
    }

    /// Points in 24 bits per coordinate of their box.
    pub(crate) fn points(&mut self, points: &[DVec3]) -> Section {
        let first = points.first().copied().unwrap_or_default();
        let (lo, hi) = points.iter().fold((first, first), |(lo, hi), &p| (lo.min(p), hi.max(p)));
        let extent = (hi - lo).max(DVec3::splat(f64::MIN_POSITIVE));
        let numbers: Vec<u32> = points
            .iter()
            .flat_map(|&p| ((p - lo) / extent * MOST).to_array())
            // The cast takes what is not a number to 0.
            .map(|x| x.round() as u32)
            .collect();
        let section = self.integers(&numbers, 3);
        Section { min: lo.to_array().to_vec(), step: (extent / MOST).to_array().to_vec(), ..section }
    }

    /// Numbers of `[low, high]` in 16 bits, `n` of them to one point.
    pub(crate) fn shares(
        &mut self,
        numbers: impl Iterator<Item = f64>,
        [low, high]: [f64; 2],
        n: usize,
    ) -> Section {
        let step = (high - low) / 65535.0;
        let coded: Vec<u32> =
            numbers.map(|x| ((x - low) / step).round().clamp(0.0, 65535.0) as u32).collect();
        let section = self.integers(&coded, n);
        Section { min: vec![low; n], step: vec![step; n], ..section }
    }

    /// Unit vectors by octahedral coordinates (Cigolle et al. 2014, *A survey of efficient representations for independent unit vectors*).
    pub(crate) fn normals(&mut self, normals: &[DVec3]) -> Section {
        let coded = normals.iter().flat_map(|n| {
            let n = *n / (n.x.abs() + n.y.abs() + n.z.abs());
            let fold = |a: f64, b: f64| if n.z < 0.0 { (1.0 - b.abs()).copysign(a) } else { a };
            [fold(n.x, n.y), fold(n.y, n.x)]
        });
        self.shares(coded, [-1.0, 1.0], 2)
    }

    /// Numbers of any size with 15 binary digits: the upper three bytes of 32-bit floats.
    pub(crate) fn floats(&mut self, numbers: impl Iterator<Item = f64>) -> Section {
        let coded: Vec<u32> = numbers
            .map(|x| {
                let x = if x.is_nan() { 0.0 } else { x as f32 };
                let bits = x.to_bits();
                if x.is_finite() { (bits + 0x80) >> 8 } else { bits >> 8 }
            })
            .collect();
        self.integers(&coded, 0)
    }

    /// Everything as text that HTML can hold.
    ///
    /// # Errors
    /// [`ViewError::Page`] when the head has no JSON form or is too long.
    pub(crate) fn pack(self, head: &impl Serialize) -> Result<String, ViewError> {
        let failed = |what: String| ViewError::Page { what };
        let head = serde_json::to_vec(head).map_err(|e| failed(e.to_string()))?;
        let length = u32::try_from(head.len()).map_err(|_| failed("its head is longer than 4 GB".into()))?;
        let mut out = GzEncoder::new(Vec::new(), Compression::default());
        let write = |out: &mut GzEncoder<Vec<u8>>| {
            out.write_all(&length.to_le_bytes())?;
            out.write_all(&head)?;
            out.write_all(&self.body)
        };
        // Writing to memory does not fail.
        write(&mut out).map_err(|e| failed(e.to_string()))?;
        Ok(STANDARD.encode(out.finish().map_err(|e| failed(e.to_string()))?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the page reads it.
    fn read(payload: &Payload, s: &Section) -> Vec<u32> {
        let mut out = vec![0u32; s.count];
        for plane in 0..s.width {
            for (i, o) in out.iter_mut().enumerate() {
                *o |= u32::from(payload.body[s.offset + plane * s.count + i]) << (8 * plane);
            }
        }
        if s.delta > 0 {
            for i in 0..s.count {
                let d = (out[i] >> 1) ^ (out[i] & 1).wrapping_neg();
                out[i] = d.wrapping_add(if i < s.delta { 0 } else { out[i - s.delta] });
            }
        }
        out
    }

    #[test]
    fn numbers_come_back() {
        let mut payload = Payload::default();
        let numbers = [7, 0, u32::MAX, 3, 1 << 31, 12, 12, 65536];
        for delta in [0, 1, 3] {
            let section = payload.integers(&numbers, delta);
            assert_eq!(read(&payload, &section), numbers, "{delta}");
        }
        let section = payload.integers(&[1000, 1001, 1002, 1003], 1);
        assert_eq!((section.width, read(&payload, &section)), (2, vec![1000, 1001, 1002, 1003]));
        assert_eq!(payload.integers(&[], 3).count, 0);
    }

    #[test]
    fn points_and_normals_are_as_exact_as_they_say() {
        let mut payload = Payload::default();
        let points = [DVec3::new(-3.0, 2.0, 5.0), DVec3::new(0.123, 2.0, 5.5), DVec3::new(1.0, 2.0, 5.25)];
        let s = payload.points(&points);
        for (i, n) in read(&payload, &s).into_iter().enumerate() {
            let back = s.min[i % 3] + s.step[i % 3] * f64::from(n);
            assert!((back - points[i / 3].to_array()[i % 3]).abs() <= 4.0 / MOST);
        }
        for n in [DVec3::Z, -DVec3::Z, DVec3::new(0.3, -0.4, -0.5), DVec3::new(-1.0, 1e-9, -1e-9)] {
            let n = n.normalize();
            let s = payload.normals(&[n]);
            let [x, y] = [0, 1].map(|i| -1.0 + 2.0 / 65535.0 * f64::from(read(&payload, &s)[i]));
            let z = 1.0 - x.abs() - y.abs();
            let fold =
                |a: f64, b: f64| if z < 0.0 { (1.0 - b.abs()) * if a < 0.0 { -1.0 } else { 1.0 } } else { a };
            let back = DVec3::new(fold(x, y), fold(y, x), z).normalize();
            assert!(back.distance(n) < 1e-4, "{n} {back}");
        }
    }

    #[test]
    fn floats_keep_four_digits() {
        let mut payload = Payload::default();
        let numbers = [0.0, 1.0, -2.34567, 1e-16, 6e4, f64::INFINITY, f64::NAN];
        let s = payload.floats(numbers.into_iter());
        for (n, bits) in numbers.into_iter().zip(read(&payload, &s)) {
            let back = f64::from(f32::from_bits(bits << 8));
            let same = back == n || (back - n).abs() < 4e-5 * n.abs() || (n.is_nan() && back == 0.0);
            assert!(same, "{n} {back}");
        }
    }
}
