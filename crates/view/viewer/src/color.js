// Colours: those of the pictures (`color.rs`), and the maps.

/** ColorBrewer's RdBu (Brewer, Harrower 2002), the darkest classes left out. */
const DIVERGING = [0x2166ac, 0x4393c3, 0x92c5de, 0xd1e5f0, 0xf7f7f7, 0xfddbc7, 0xf4a582, 0xd6604d, 0xb2182b];
/** Viridis (van der Walt, Smith 2015) at nine places. */
const SEQUENTIAL = [0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c, 0x28ae80, 0x5ec962, 0xaddc30, 0xfde725];

/** Good to bad, for jumps across seams: unlike the maps of the surface below them. */
const JUMP = [0x0fa3b1, 0x2fb47c, 0x8cc751, 0xe6d13a, 0xf59b2b, 0xf0592a, 0xd81159];

export const MAPS = { diverging: DIVERGING, sequential: SEQUENTIAL, jump: JUMP };

export const css = (hex) => `#${hex.toString(16).padStart(6, "0")}`;
export const channels = (hex) => [hex >> 16, (hex >> 8) & 255, hex & 255];
export const toLinear = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);

/** A gradient for style sheets. */
export const gradient = (map, direction) => `linear-gradient(${direction}, ${MAPS[map].map(css).join(", ")})`;

/** The colour of a map at `x` in [0, 1], sRGB bytes. */
export function at(map, x) {
  const list = MAPS[map];
  const t = Math.min(1, Math.max(0, x)) * (list.length - 1);
  const i = Math.min(list.length - 2, Math.floor(t));
  const [a, b] = [channels(list[i]), channels(list[i + 1])];
  return a.map((c, k) => c + (b[k] - c) * (t - i));
}

/** Colours of segments: as far apart as so many can be. */
export function label(i) {
  const hue = (i * 0.61803398875 + 0.58) % 1;
  const light = [0.56, 0.7, 0.48][i % 3];
  return hsl(hue, 0.52, light);
}

function hsl(h, s, l) {
  const a = s * Math.min(l, 1 - l);
  return [0, 8, 4].map((n) => {
    const k = (n + 12 * h) % 12;
    return 255 * (l - a * Math.max(-1, Math.min(k - 3, 9 - k, 1)));
  });
}
