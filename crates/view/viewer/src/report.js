// The report as tables: one column per model.

/** A number with three digits that matter. */
export function number(x) {
  if (x == null || Number.isNaN(x)) return "—";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (!Number.isFinite(x)) return x > 0 ? "∞" : "−∞";
  if (size >= 1e5 || size < 1e-3) return x.toExponential(1).replace("-", "−").replace("e−", "e-").replace("e+", "e");
  return Number(x.toPrecision(3)).toString().replace("-", "−");
}

const count = (x) => (x == null ? "—" : x.toLocaleString("en"));
const share = (x) => (x == null ? "—" : `${number(100 * x)} %`);
const yes = (x) => (x == null ? "—" : x ? "yes" : "no");

/** Tables of everything the reports hold: title, rows of a name and one value per model, whether to show it at once. */
export function reportTables(heads) {
  const reports = heads.map((m) => m.report);
  const tables = [];
  const add = (title, open, rows) => {
    const kept = rows
      .map(([name, value]) => [name, ...reports.map((r, i) => value(r, heads[i]) ?? "—")])
      .filter(([, ...values]) => values.some((v) => v !== "—"));
    if (kept.length) tables.push({ title, open, rows: kept });
  };
  add("Certificate", true, [
    ["Claimed", (r) => r.certificate?.claimed],
    ["Measured", (r) => r.certificate && (r.certificate.measured ?? "gap")],
    ["Largest gap", (r) => r.certificate && number(r.certificate.position)],
    ["Largest angle of normals", (r) => r.certificate && `${number(r.certificate.normal)} rad`],
    ["Largest jump of curvature", (r) => r.certificate && number(r.certificate.curvature)],
    ["Regularity", (r) => r.certificate && number(r.certificate.regularity)],
    ["Largest curvature · diagonal", (r) => r.certificate && number(r.certificate.largest_curvature)],
    ["Seams", (r) => r.certificate && count(r.certificate.seams)],
    ["Open edges", (r) => r.certificate && count(r.certificate.open_edges)],
  ]);
  add("Deviation", true, ["mesh_to_surface", "surface_to_mesh"].flatMap((way) => {
    const name = way === "mesh_to_surface" ? "Mesh to surface" : "Surface to mesh";
    return ["rms", "mean", "max"].map((s) => [`${name}, ${s}`, (r) => r.deviation && share(r.deviation[way][s])]);
  }));
  const kinds = [...new Set(reports.flatMap((r) => Object.keys(r.surface?.patches ?? {})))];
  add("Surface", heads.length > 1, [
    ["Patches", (r, m) => count(m.patches)],
    ...kinds.map((k) => [`  ${k}`, (r) => count(r.surface?.patches?.[k])]),
    ["Degree", (r, m) => m.degrees.names.join("; ")],
    ["Patches, strips merged", (r) => r.surface?.patches_merged && count(r.surface.patches_merged)],
    ["Segments", (r) => r.surface?.charts && count(r.surface.charts)],
    ["Corners", (r) => r.surface?.corners && count(r.surface.corners)],
    ["Arcs", (r) => r.surface?.arcs && count(r.surface.arcs)],
    ["Width of blends", (r) => r.surface?.widths && r.surface.widths.map(share).join(" … ")],
  ]);
  add("Input", false, [
    ["Vertices", (r) => r.input && count(r.input.vertices)],
    ["Faces", (r) => r.input && count(r.input.faces)],
    ["Genus", (r) => r.input && count(r.input.genus)],
    ["Components", (r) => r.input && count(r.input.components)],
    ["Boundary loops", (r) => r.input && count(r.input.boundary_loops)],
    ["Diagonal", (r) => r.input && number(r.input.diagonal)],
  ]);
  add("Tessellation", false, [
    ["Triangles", (r) => r.tessellation && count(r.tessellation.triangles)],
    ["Vertices", (r) => r.tessellation && count(r.tessellation.vertices)],
    ["Closed", (r) => r.tessellation && yes(r.tessellation.closed)],
    ["Manifold", (r) => r.tessellation && yes(r.tessellation.manifold)],
    ["Oriented", (r) => r.tessellation && yes(r.tessellation.oriented)],
    ["Genus", (r) => r.tessellation && count(r.tessellation.genus)],
  ]);
  const stages = [...new Set(reports.flatMap((r) => Object.keys(r.seconds ?? {})))];
  add("Time", heads.length > 1, [
    ...stages.map((s) => [s, (r) => r.seconds?.[s] != null ? `${number(r.seconds[s])} s` : null]),
    ["Memory", (r) => r.peak_memory_bytes && `${number(r.peak_memory_bytes / 2 ** 20)} MB`],
    ["Threads", (r) => r.threads && count(r.threads)],
  ]);
  const settings = [...new Set(reports.flatMap((r) => Object.keys(r.settings ?? {})))];
  add("Settings", false, settings.map((s) => [s, (r) => {
    const v = r.settings?.[s];
    return v == null ? null : typeof v === "object" ? JSON.stringify(v) : String(v);
  }]));
  return tables;
}
