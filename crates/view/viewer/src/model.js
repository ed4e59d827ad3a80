// One surface with everything that can be shown of it, from the sections of the payload. Coordinates are relative to the middle of the
// surface and to the diagonal of its box, so that 32-bit numbers suffice wherever the part lies.
import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial,
  MeshLambertMaterial,
} from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import { at, label, toLinear } from "./color.js";
import { floats, integers, normals, reals } from "./data.js";
import { kindTexture, surfaceMaterial } from "./shader.js";

/** More segments than this are drawn one pixel wide: wide ones cost eight triangles each. The second number is for machines without graphics hardware. */
const MOST_WIDE = [60_000, 8_000];
const ORDERS = ["—", "C0", "G1", "C1", "G2", "C2"];
const ORDER_COLORS = [0xff2d55, 0xff7a1a, 0xf2c230, 0xb9cf3a, 0x35b779, 0x2f9e6d];

export class Model {
  constructor(head, body, kinds, software) {
    this.mostWide = MOST_WIDE[software ? 1 : 0];
    this.head = head;
    this.kinds = kinds;
    const s = head.sections;
    this.section = (name, read = integers) => (s[name] ? read(body, s[name]) : null);

    this.patchKind = this.section("patch_kind");
    this.patchWorst = this.section("patch_worst", floats);
    this.counts = this.section("patch_vertices");
    this.triangleCounts = this.section("patch_triangles");
    this.seams = {
      patches: this.section("seam_patches"), orders: this.section("seam_orders"), jumps: this.section("seam_jumps", floats),
    };
    this.seamCount = this.seams.patches ? this.seams.patches.length / 2 : 0;

    this.group = new Group();
    this.surface = this.buildSurface();
    this.seamLines = this.buildSeams();
    this.nets = this.lines("nets", 0x8a3ffc, 0.0035, 0.75);
    this.hull = this.buildHull();
    Object.assign(this, this.buildMesh());
    for (const part of [this.surface, this.seamLines, this.nets, this.hull, this.mesh, this.segments]) {
      if (part) this.group.add(part);
    }
  }

  buildSurface() {
    const position = this.section("position", reals);
    const geometry = new BufferGeometry();
    const n = position.length / 3;
    geometry.setAttribute("position", new BufferAttribute(position, 3));
    geometry.setAttribute("normal", new BufferAttribute(this.section("normal", normals), 3));
    this.curvature = this.section("curvature", floats);
    geometry.setAttribute("curvature", new BufferAttribute(this.curvature, 2));
    geometry.setAttribute("parameter", new BufferAttribute(this.section("parameter", reals), 2));
    this.deviation = this.section("deviation", floats) ?? new Float32Array(n);
    geometry.setAttribute("deviation", new BufferAttribute(this.deviation, 1));
    const patch = new Float32Array(n);
    const local = this.section("triangles");
    const index = new Uint32Array(local.length);
    this.firstVertex = [];
    this.firstTriangle = [];
    let vertex = 0;
    let corner = 0;
    this.counts.forEach((count, i) => {
      this.firstVertex.push(vertex);
      this.firstTriangle.push(corner / 3);
      patch.fill(i, vertex, vertex + count);
      const end = corner + 3 * this.triangleCounts[i];
      for (; corner < end; corner++) index[corner] = local[corner] + vertex;
      vertex += count;
    });
    geometry.setAttribute("patchNumber", new BufferAttribute(patch, 1));
    geometry.setIndex(new BufferAttribute(index, 1));
    geometry.computeBoundingSphere();
    geometry.computeBoundingBox();
    this.triangles = index.length / 3;
    return new Mesh(geometry, surfaceMaterial(kindTexture(this.patchKind, this.kinds.map((k) => k.color))));
  }

  /** The patch of a triangle: triangles are in the order of their patches. */
  patchOf(triangle) {
    let [lo, hi] = [0, this.firstTriangle.length - 1];
    while (lo < hi) {
      const middle = (lo + hi + 1) >> 1;
      if (this.firstTriangle[middle] <= triangle) lo = middle;
      else hi = middle - 1;
    }
    return lo;
  }

  buildSeams() {
    const ends = this.section("seam_edges");
    if (!ends) return null;
    const position = this.surface.geometry.getAttribute("position").array;
    const points = new Float32Array(3 * ends.length);
    ends.forEach((v, i) => points.set(position.subarray(3 * v, 3 * v + 3), 3 * i));
    this.edgeSeam = this.section("edge_seam");
    // Many seams in full strength would hide what they lie on.
    this.seamWidth = this.seamCount > 2000 ? 0.9 : 1.6;
    return this.strokes(points, { color: 0x0b1220, width: this.seamWidth, towards: 0.0015, opacity: this.seamCount > 2000 ? 0.55 : 1 });
  }

  /** Colours the seams: `plain`, by measured `order`, by jump of `normal` or `curvature`. */
  colorSeams(by, ink) {
    const lines = this.seamLines;
    if (!lines) return;
    const plain = by === "plain";
    lines.material.vertexColors = !plain;
    lines.material.color.set(plain ? ink : 0xffffff);
    lines.material.linewidth = (plain ? 1 : 1.6) * this.seamWidth;
    lines.material.needsUpdate = true;
    if (plain) return;
    const color = (seam) => {
      if (seam >= this.seamCount) return [140, 140, 140];
      if (by === "order") {
        const c = ORDER_COLORS[this.seams.orders[2 * seam + 1]];
        return [c >> 16, (c >> 8) & 255, c & 255];
      }
      return at("jump", jumpPlace(this.seams.jumps[3 * seam + (by === "normal" ? 1 : 2)]));
    };
    const cache = new Map();
    const count = this.edgeSeam.length;
    const colors = new Float32Array(6 * count);
    for (let i = 0; i < count; i++) {
      const seam = this.edgeSeam[i];
      let c = cache.get(seam);
      if (!c) cache.set(seam, (c = color(seam).map((x) => toLinear(x / 255))));
      colors.set(c, 6 * i);
      colors.set(c, 6 * i + 3);
    }
    if (lines.isLineSegments2) lines.geometry.setColors(colors);
    else lines.geometry.setAttribute("color", new BufferAttribute(colors, 3));
  }

  /** Pairs of points of a section as lines. */
  lines(name, color, towards, opacity) {
    const points = this.section(name, reals);
    return points && this.strokes(points, { color, width: 1.2, towards, opacity });
  }

  buildHull() {
    const points = this.section("hull", reals);
    if (!points) return null;
    const kinds = this.section("hull_kind");
    const corners = [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3];
    const edges = [0, 1, 1, 2, 2, 0, 0, 3, 1, 3, 2, 3];
    const n = kinds.length;
    const faces = new Float32Array(36 * n);
    const lines = new Float32Array(36 * n);
    const colors = new Float32Array(36 * n);
    const tints = [new Color(0x3c7fd6), new Color(0xe8912d)];
    for (let t = 0; t < n; t++) {
      const put = (to, list) =>
        list.forEach((c, k) => to.set(points.subarray(12 * t + 3 * c, 12 * t + 3 * c + 3), 36 * t + 3 * k));
      put(faces, corners);
      put(lines, edges);
      for (let k = 0; k < 12; k++) tints[kinds[t]].toArray(colors, 36 * t + 3 * k);
    }
    const group = new Group();
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(faces, 3));
    geometry.setAttribute("color", new BufferAttribute(colors, 3));
    group.add(
      new Mesh(
        geometry,
        new MeshBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.1, side: DoubleSide, depthWrite: false }),
      ),
    );
    const wire = new BufferGeometry();
    wire.setAttribute("position", new BufferAttribute(lines, 3));
    wire.setAttribute("color", new BufferAttribute(colors, 3));
    group.add(new LineSegments(wire, new LineBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.55 })));
    return group;
  }

  /** The input: its edges, and its faces coloured by segment. */
  buildMesh() {
    const position = this.section("mesh_position", reals);
    if (!position) return { mesh: null, segments: null };
    const faces = this.section("mesh_faces");
    const seen = new Set();
    const pairs = [];
    const n = position.length / 3;
    for (let f = 0; f < faces.length; f += 3) {
      for (let k = 0; k < 3; k++) {
        const [a, b] = [faces[f + k], faces[f + ((k + 1) % 3)]];
        const key = a < b ? a * n + b : b * n + a;
        if (!seen.has(key)) {
          seen.add(key);
          pairs.push(a, b);
        }
      }
    }
    const points = new Float32Array(3 * pairs.length);
    pairs.forEach((v, i) => points.set(position.subarray(3 * v, 3 * v + 3), 3 * i));
    const mesh = this.strokes(points, { color: 0xd6336c, width: 1, towards: 0.004, opacity: 0.85 });
    this.meshFaces = faces.length / 3;
    const labels = this.section("mesh_labels");
    let segments = null;
    if (labels) {
      const corners = new Float32Array(3 * faces.length);
      const colors = new Float32Array(3 * faces.length);
      const cache = new Map();
      faces.forEach((v, i) => {
        const l = labels[(i / 3) | 0];
        let c = cache.get(l);
        if (!c) cache.set(l, (c = label(l).map((x) => toLinear(x / 255))));
        corners.set(position.subarray(3 * v, 3 * v + 3), 3 * i);
        colors.set(c, 3 * i);
      });
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(corners, 3));
      geometry.setAttribute("color", new BufferAttribute(colors, 3));
      geometry.computeVertexNormals();
      segments = new Mesh(geometry, new MeshLambertMaterial({ vertexColors: true, side: DoubleSide, flatShading: true,
        polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }));
      this.labelCount = cache.size;
    }
    return { mesh, segments };
  }

  strokes(points, look) {
    return strokes(points, look, this.mostWide);
  }

  /** What is known of a patch. */
  describe(patch) {
    const { patches, orders, jumps } = this.seams;
    const seams = [];
    for (let s = 0; s < this.seamCount; s++) {
      const [a, b] = [patches[2 * s], patches[2 * s + 1]];
      if (a !== patch && b !== patch) continue;
      const other = a === patch ? b : a;
      seams.push({
        seam: s, other, kind: this.kinds[this.patchKind[other]].name, claimed: ORDERS[orders[2 * s]],
        measured: orders[2 * s + 1] === 0 ? null : ORDERS[orders[2 * s + 1]],
        position: jumps[3 * s], normal: jumps[3 * s + 1], curvature: jumps[3 * s + 2],
      });
    }
    const first = this.firstVertex[patch];
    let [low, high] = [Infinity, -Infinity];
    for (let i = first; i < first + this.counts[patch]; i++) {
      const [a, b] = [this.curvature[2 * i], this.curvature[2 * i + 1]];
      if (a > high) high = a;
      if (b < low) low = b;
    }
    const degrees = this.head.degrees;
    return {
      patch, kind: this.kinds[this.patchKind[patch]].name, color: this.kinds[this.patchKind[patch]].color,
      degree: degrees.names[degrees.of ? degrees.of[patch] : 0] ?? "", triangles: this.triangleCounts[patch],
      curvature: [low, high], worst: this.patchWorst ? this.patchWorst[patch] : null, seams,
    };
  }
}

/** Place in a map of a jump: 1e-16 to 1 on a logarithmic scale. */
export const jumpPlace = (jump) => (Math.log10(Math.max(jump, 1e-16)) + 16) / 16;

/** Lines as wide as asked where there are few, one pixel wide where there are many; drawn a little closer to the eye. */
function strokes(points, { color, width, towards, opacity = 1 }, mostWide) {
  const nearer = (shader) => {
    // Along the line of sight the place in the picture stays.
    shader.uniforms.uNearer = { value: 1 - towards };
  };
  const transparent = opacity < 1;
  if (points.length / 6 <= mostWide) {
    const geometry = new LineSegmentsGeometry();
    geometry.setPositions(points);
    const material = new LineMaterial({ color, linewidth: width, transparent, opacity });
    material.vertexShader = material.vertexShader.replace(
      "vec4 end = modelViewMatrix * vec4( instanceEnd, 1.0 );",
      `$&\n start.xyz *= ${(1 - towards).toFixed(6)}; end.xyz *= ${(1 - towards).toFixed(6)};`,
    );
    const lines = new LineSegments2(geometry, material);
    lines.raycast = () => {};
    return lines;
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  const material = new LineBasicMaterial({ color, transparent: true, opacity: 0.6 * opacity });
  material.onBeforeCompile = (shader) => {
    nearer(shader);
    shader.vertexShader = shader.vertexShader
      .replace("void main() {", "uniform float uNearer;\nvoid main() {")
      .replace("#include <project_vertex>", `vec4 mvPosition = modelViewMatrix * vec4(transformed, 1.0);
        mvPosition.xyz *= uNearer; gl_Position = projectionMatrix * mvPosition;`);
  };
  const lines = new LineSegments(geometry, material);
  lines.raycast = () => {};
  return lines;
}

export { ORDERS, ORDER_COLORS };
