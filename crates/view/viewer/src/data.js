// The payload: base64 of gzip of [length of the head, 4 bytes][head, JSON][sections]. `page/payload.rs` writes it.

/** Decodes the payload of the page. */
export async function load(text) {
  const packed = bytes(text);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const all = new Uint8Array(await new Response(stream).arrayBuffer());
  const length = new DataView(all.buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(all.subarray(4, 4 + length)));
  return { head, body: all.subarray(4 + length) };
}

function bytes(text) {
  const binary = atob(text.trim());
  const out = new Uint8Array(binary.length);
  for (let i = 0; i < out.length; i++) out[i] = binary.charCodeAt(i);
  return out;
}

/**
 * The numbers of a section. They are stored as planes of bytes, the lowest first, perhaps as zigzag differences to the number
 * `delta` places before.
 */
export function integers(body, section) {
  const { offset, count, width, delta } = section;
  const out = new Uint32Array(count);
  for (let plane = 0; plane < width; plane++) {
    const from = offset + plane * count;
    const shift = 8 * plane;
    for (let i = 0; i < count; i++) out[i] |= body[from + i] << shift;
  }
  if (delta > 0) {
    for (let i = 0; i < count; i++) {
      const difference = (out[i] >>> 1) ^ -(out[i] & 1);
      out[i] = (i < delta ? 0 : out[i - delta]) + difference;
    }
  }
  return out;
}

/** Numbers of a section with a place and a step for every component. */
export function reals(body, section) {
  const raw = integers(body, section);
  const out = new Float32Array(raw.length);
  const { min, step } = section;
  const n = min.length;
  for (let i = 0; i < raw.length; i++) out[i] = min[i % n] + step[i % n] * raw[i];
  return out;
}

/** Numbers of a section that holds the upper three bytes of 32-bit floats. */
export function floats(body, section) {
  const raw = integers(body, section);
  for (let i = 0; i < raw.length; i++) raw[i] <<= 8;
  return new Float32Array(raw.buffer);
}

/** Unit vectors from octahedral coordinates (Cigolle et al. 2014). */
export function normals(body, section) {
  const raw = reals(body, section);
  const n = raw.length / 2;
  const out = new Float32Array(3 * n);
  for (let i = 0; i < n; i++) {
    let x = raw[2 * i];
    let y = raw[2 * i + 1];
    const z = 1 - Math.abs(x) - Math.abs(y);
    if (z < 0) {
      const fold = (1 - Math.abs(y)) * (x < 0 ? -1 : 1);
      y = (1 - Math.abs(x)) * (y < 0 ? -1 : 1);
      x = fold;
    }
    const length = Math.hypot(x, y, z) || 1;
    out[3 * i] = x / length;
    out[3 * i + 1] = y / length;
    out[3 * i + 2] = z / length;
  }
  return out;
}
