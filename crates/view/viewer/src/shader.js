// The shades of the surface. Light and bands are those of the pictures (`shade.rs`).
import { DataTexture, DoubleSide, GLSL3, LinearFilter, RGBAFormat, ShaderMaterial, UnsignedByteType, Vector3 } from "three";
import { at } from "./color.js";

/** What the number `uMode` of the shader means. */
export const MODES = {
  patches: 0, plain: 1, reflection: 2, isophotes: 3, mean: 4, gaussian: 5, largest: 6, smallest: 7, deviation: 8,
};

const VERTEX = /* glsl */ `
in vec2 curvature;
in vec2 parameter;
in float deviation;
in float patchNumber;
out vec3 vPosition;
out vec3 vNormal;
out vec2 vCurvature;
out vec2 vParameter;
out float vDeviation;
flat out float vPatch;
void main() {
  vec4 p = modelViewMatrix * vec4(position, 1.0);
  vPosition = p.xyz;
  vNormal = normalMatrix * normal;
  vCurvature = curvature;
  vParameter = parameter;
  vDeviation = deviation;
  vPatch = patchNumber;
  gl_Position = projectionMatrix * p;
}`;

const FRAGMENT = /* glsl */ `
precision highp float;
uniform int uMode;
uniform vec3 uLight;
uniform float uBands;
uniform float uRange;
uniform float uLines;
uniform float uSelected;
uniform vec3 uAccent;
uniform vec3 uUp;
uniform sampler2D uMap;
uniform sampler2D uKinds;
in vec3 vPosition;
in vec3 vNormal;
in vec2 vCurvature;
in vec2 vParameter;
in float vDeviation;
flat in float vPatch;
out vec4 outColor;

const float PI = 3.141592653589793;
const vec3 LAMP = vec3(-0.4616, 0.5934, 0.6594);

vec3 encode(vec3 c) {
  return mix(12.92 * c, 1.055 * pow(max(c, 0.0), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}
vec3 decode(vec3 c) {
  return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c));
}
float light(vec3 n, vec3 v) {
  return 0.16 + 0.10 * dot(n, uUp) + 0.42 * max(dot(n, v), 0.0) + 0.40 * max(dot(n, LAMP), 0.0);
}
vec3 gloss(vec3 n, vec3 v) {
  return vec3(0.10 * pow(max(dot(n, normalize(LAMP + v)), 0.0), 40.0));
}
// Light or dark by the angle; where bands are narrower than pixels, their mean.
vec3 band(float angle, vec3 n, vec3 v) {
  float f = angle * uBands / PI;
  float w = fwidth(f);
  float wave = abs(fract(f) * 2.0 - 1.0);
  float s = smoothstep(0.5 - 1.4 * w, 0.5 + 1.4 * w, wave);
  s = mix(s, 0.5, smoothstep(0.35, 0.9, w));
  vec3 base = mix(decode(vec3(0.114, 0.153, 0.200)), decode(vec3(0.957, 0.965, 0.973)), s);
  return base * min(0.45 + 0.55 * light(n, v), 1.0);
}
void main() {
  vec3 v = normalize(-vPosition);
  vec3 n = normalize(vNormal);
  float c = dot(n, v);
  bool outside = abs(c) > 0.25 ? c > 0.0 : gl_FrontFacing;
  if (!outside) n = -n;
  c = dot(n, v);
  if (c < 0.0) n = normalize(n - v * c);
  float side = outside ? 1.0 : -1.0;
  vec3 color;
  if (uMode <= 1) {
    vec3 base = decode(vec3(0.788, 0.800, 0.820));
    if (uMode == 0) {
      int i = int(vPatch + 0.5);
      base = decode(texelFetch(uKinds, ivec2(i & 1023, i >> 10), 0).rgb);
    }
    if (!outside) base = mix(base, vec3(0.25), 0.6);
    color = base * light(n, v) + gloss(n, v);
  } else if (uMode == 2) {
    color = band(asin(clamp(dot(reflect(-v, n), uLight), -1.0, 1.0)), n, v);
  } else if (uMode == 3) {
    color = band(acos(clamp(dot(n, uLight), -1.0, 1.0)), n, v);
  } else {
    float x;
    vec2 k = vCurvature;
    if (uMode == 4) x = 0.5 * (k.x + k.y) * side;
    else if (uMode == 5) x = k.x * k.y;
    else if (uMode == 6) x = outside ? k.x : -k.y;
    else if (uMode == 7) x = outside ? k.y : -k.x;
    else x = vDeviation;
    float t = uMode == 8 ? x / uRange : 0.5 + 0.5 * x / uRange;
    vec3 base = decode(texture(uMap, vec2((clamp(t, 0.0, 1.0) * 255.0 + 0.5) / 256.0, 0.5)).rgb);
    color = base * min(0.35 + 0.65 * light(n, v), 1.0);
  }
  if (uLines > 0.0) {
    vec2 q = vParameter * uLines;
    vec2 g = abs(fract(q - 0.5) - 0.5) / max(fwidth(q), 1e-6);
    float line = 1.0 - smoothstep(0.3, 1.1, min(g.x, g.y));
    line *= 1.0 - smoothstep(0.3, 0.6, max(fwidth(q).x, fwidth(q).y));
    float bright = dot(color, vec3(0.2126, 0.7152, 0.0722));
    color = mix(color, bright < 0.07 ? vec3(0.75, 0.80, 0.85) : vec3(0.012, 0.02, 0.035), 0.65 * line);
  }
  if (uSelected >= 0.0) {
    if (abs(vPatch - uSelected) < 0.5) {
      float rim = 0.35 + 0.3 * (1.0 - max(dot(n, v), 0.0));
      color = mix(color, uAccent, rim);
    }
  }
  outColor = vec4(encode(color), 1.0);
}`;

/** The material of one surface; `kinds` is the texture of the colours of its patches. */
export function surfaceMaterial(kinds) {
  return new ShaderMaterial({
    glslVersion: GLSL3,
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    side: DoubleSide,
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
    uniforms: {
      uMode: { value: 0 },
      uLight: { value: new Vector3(0, 1, 0) },
      uUp: { value: new Vector3(0, 1, 0) },
      uBands: { value: 24 },
      uRange: { value: 1 },
      uLines: { value: 0 },
      uSelected: { value: -1 },
      uAccent: { value: new Vector3(0.9, 0.25, 0.6) },
      uMap: { value: null },
      uKinds: { value: kinds },
    },
  });
}

/** A colour map as a texture. */
export function mapTexture(name) {
  const pixels = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; i++) pixels.set([...at(name, i / 255).map(Math.round), 255], 4 * i);
  const texture = new DataTexture(pixels, 256, 1, RGBAFormat, UnsignedByteType);
  texture.magFilter = texture.minFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

/** One pixel per patch: the colour of its kind. */
export function kindTexture(patchKinds, colors) {
  const width = 1024;
  const height = Math.max(1, Math.ceil(patchKinds.length / width));
  const pixels = new Uint8Array(4 * width * height);
  patchKinds.forEach((kind, i) => {
    const c = colors[kind];
    pixels.set([c >> 16, (c >> 8) & 255, c & 255, 255], 4 * i);
  });
  const texture = new DataTexture(pixels, width, height, RGBAFormat, UnsignedByteType);
  texture.needsUpdate = true;
  return texture;
}

