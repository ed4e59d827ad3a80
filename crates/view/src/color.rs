//! Colours: sRGB and linear light, the palette of patches, the diverging map.

use glam::DVec3;
use suture_surface::PatchKind;

/// Linear light of an sRGB colour `0xRRGGBB`.
pub(crate) fn linear(hex: u32) -> DVec3 {
    let channel = |shift: u32| {
        let c = f64::from(hex >> shift & 0xff) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    DVec3::new(channel(16), channel(8), channel(0))
}

/// sRGB bytes of linear light, clamped.
pub(crate) fn encode(color: DVec3) -> [u8; 3] {
    color.to_array().map(|c| {
        let s = if c <= 0.0031308 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        // The cast saturates and takes NaN to 0.
        (255.0 * s).round() as u8
    })
}

/// The colour of a kind of patch; those of trimmed B-splines, strips and N-blends after the figures of Wagner, Hormann and Greiner (2003).
pub(crate) fn of_kind(kind: PatchKind) -> DVec3 {
    linear(match kind {
        PatchKind::Trimmed => 0x4a7fd0,
        PatchKind::Strip { odd: false } => 0xcf3b35,
        PatchKind::Strip { odd: true } => 0xf0938a,
        PatchKind::AdjacentStrip => 0x4fae5a,
        PatchKind::NBlend { .. } => 0xf6d13c,
        PatchKind::Face => 0x5b9bd5,
        PatchKind::Edge => 0xe8a33d,
        PatchKind::Planar => 0x96a3b2,
        PatchKind::Bubble { .. } => 0x3fa796,
        PatchKind::Fill { .. } => 0xf4b13c,
        PatchKind::Given => 0x8ea0be,
        _ => 0xb0b0b0,
    })
}

/// ColorBrewer's RdBu (Brewer, Harrower 2002) from −1 (blue) to 1 (red): safe for colour-blind eyes. The darkest of its eleven classes are
/// left out at both ends: lit, they would be black.
const DIVERGING: [u32; 9] =
    [0x2166ac, 0x4393c3, 0x92c5de, 0xd1e5f0, 0xf7f7f7, 0xfddbc7, 0xf4a582, 0xd6604d, 0xb2182b];

/// Viridis (van der Walt, Smith 2015) at nine places: even steps of brightness.
const SEQUENTIAL: [u32; 9] =
    [0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c, 0x28ae80, 0x5ec962, 0xaddc30, 0xfde725];

/// The sequential map at `x`, clamped to `[0, 1]`; grey where `x` is not a number.
pub(crate) fn sequential(x: f64) -> DVec3 {
    if x.is_nan() {
        return linear(0x808080);
    }
    let t = x.clamp(0.0, 1.0) * 8.0;
    let i = (t as usize).min(7);
    linear(SEQUENTIAL[i]).lerp(linear(SEQUENTIAL[i + 1]), t - i as f64)
}

/// The diverging map at `x`, clamped to `[−1, 1]`; grey where `x` is not a number.
pub(crate) fn diverging(x: f64) -> DVec3 {
    if x.is_nan() {
        return linear(0x808080);
    }
    let t = (x.clamp(-1.0, 1.0) + 1.0) * 4.0;
    let i = (t as usize).min(7);
    linear(DIVERGING[i]).lerp(linear(DIVERGING[i + 1]), t - i as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_round_trips() {
        for hex in [0x000000, 0xffffff, 0x123456, 0x808080, 0x0a0b0c] {
            let [r, g, b] = encode(linear(hex)).map(u32::from);
            assert_eq!(r << 16 | g << 8 | b, hex);
        }
    }

    #[test]
    fn the_diverging_map_is_white_in_the_middle_and_clamped() {
        assert_eq!(encode(diverging(0.0)), [0xf7; 3]);
        assert_eq!(diverging(7.0), diverging(1.0));
        assert_eq!(encode(diverging(-1.0)), [0x21, 0x66, 0xac]);
        assert_eq!(encode(diverging(f64::NAN)), [0x80; 3]);
    }
}
