// Everything around the canvas: controls, legend, patch, certificate, report, keyboard.
import { css, gradient } from "./color.js";
import { ORDER_COLORS, ORDERS } from "./model.js";
import { number, reportTables } from "./report.js";

const SHADES = [
  ["patches", "Patches", "Colour by kind of patch"],
  ["plain", "Plain", "One colour, lit"],
  ["reflection", "Reflection", "Lines of light far away, mirrored: one order less smooth than the surface"],
  ["isophotes", "Isophotes", "Lines of equal angle between normal and light"],
  ["mean", "Mean H", "Mean curvature, positive where the surface bulges"],
  ["gaussian", "Gauss K", "Gaussian curvature: positive on caps, negative on saddles"],
  ["largest", "κ max", "Larger principal curvature"],
  ["smallest", "κ min", "Smaller principal curvature"],
  ["deviation", "Deviation", "Distance from the input mesh"],
];
const LAYERS = [
  ["surface", "Surface"], ["seams", "Seams"], ["lines", "Parameter lines"], ["nets", "Control nets"], ["mesh", "Input mesh"],
  ["segments", "Segments"], ["hull", "Simplicial hull"],
];
const KEYS = [
  ["1 – 9", "shading"], ["S  P  C", "seams, parameter lines, control nets"], ["M  G  T", "input mesh, segments, hull"],
  ["← → ↑ ↓", "turn"], ["Shift + arrows", "move"], ["+  −", "closer, farther"], ["[  ]", "fewer, more lines; smaller, larger range"],
  ["A  D  W  X", "move the light"], ["N  B", "next, previous patch"], ["F", "whole model"], ["L", "light or dark"],
  ["H", "hide the panel"], ["Esc", "no patch"],
];

/** An element with attributes, properties and children. */
function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value !== false && value != null) element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.flat().filter((c) => c != null && c !== false));
  return element;
}

export class Panel {
  constructor(root, head, models, stage) {
    Object.assign(this, { root, head, models, stage });
    const has = (name) => models.some((m) => m.head.sections[name]);
    this.available = {
      surface: true, seams: has("seam_edges"), lines: true, nets: has("nets"), mesh: has("mesh_position"), segments: has("mesh_labels"),
      hull: has("hull"),
    };
    this.hasDeviation = has("deviation");
    this.state = {
      shade: head.view.shade, bands: head.view.bands, rangeFactor: 1, lines: 8, seamsBy: "plain", picked: null,
      layers: { surface: true, seams: true, lines: false, nets: false, mesh: false, segments: false, hull: false },
    };
    if (this.state.shade === "deviation" && !this.hasDeviation) this.state.shade = "patches";
    if (this.state.shade === "reflection" || this.state.shade === "isophotes") this.state.layers.seams = false;
    this.build();
    this.theme(matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", (e) => this.theme(e.matches ? "dark" : "light"));
    this.applyShade(this.state.shade);
    for (const [name] of LAYERS) this.applyLayer(name, this.state.layers[name]);
    this.applyLight();
    this.listen();
  }

  // ---- building ----

  build() {
    const { head, models } = this;
    const stageElement = this.root.querySelector(".stage");
    this.legend = h("div", { class: "legend", "aria-live": "polite" });
    const holds = models.map((m) => verdict(m.head.report));
    const titles = h("div", { class: "titles" },
      h("h1", {}, head.title),
      models.length === 1 && h("p", {}, subtitle(models[0]), " ", badge(holds[0])),
    );
    stageElement.append(titles, this.legend);
    this.captions = [];
    if (models.length > 1) {
      this.captions = models.map((m, i) =>
        h("div", { class: "caption" }, h("strong", {}, m.head.name), " ", badge(holds[i]), h("span", {}, subtitle(m))),
      );
      stageElement.append(...this.captions);
      this.stage.onLayout = (panes) => panes.forEach((pane, i) => {
        Object.assign(this.captions[i].style, { left: `${pane.x}px`, top: `${pane.y + (pane.y === 0 ? 46 : 8)}px`,
          // The tools stand in the upper right corner.
          width: `${pane.width - (pane.x + pane.width > this.stage.canvas.clientWidth - 2 ? 54 : 0)}px` });
      });
      this.stage.resize();
    }
    this.tools = h("div", { class: "tools" },
      tool("panel", "☰", "Hide or show the panel (H)", () => this.toggle()),
      tool("theme", "◐", "Light or dark (L)", () => this.theme(this.root.dataset.theme === "dark" ? "light" : "dark")),
      tool("home", "⌂", "Whole model (F)", () => this.stage.reset()),
      tool("closer", "+", "Closer (+)", () => this.stage.zoom(0.8)),
      tool("farther", "−", "Farther (−)", () => this.stage.zoom(1.25)),
      tool("picture", "⤓", "Save what is shown as a picture", () => this.save()),
      tool("help", "?", "Keyboard", () => this.help.showModal()),
    );
    stageElement.append(this.tools);
    this.help = h("dialog", { class: "help", "aria-label": "Keyboard" },
      h("h2", {}, "Keyboard and touch"),
      h("dl", {}, KEYS.map(([key, what]) => [h("dt", {}, h("kbd", {}, key)), h("dd", {}, what)])),
      h("p", {}, "Drag to turn, wheel or pinch to come closer, right button or two fingers to move, click or tap a patch to ask about it."),
      h("form", { method: "dialog" }, h("button", { class: "primary" }, "Close")),
    );
    this.root.append(this.help);

    this.shadeButtons = new Map();
    const shades = h("div", { class: "grid", role: "radiogroup", "aria-label": "Shading" },
      SHADES.map(([name, text, what], i) => {
        const disabled = name === "deviation" && !this.hasDeviation;
        const button = h("button", {
          type: "button", role: "radio", "data-shade": name, disabled, title: disabled ? "There is no mesh to compare with" : `${what} (${i + 1})`,
          onclick: () => this.applyShade(name),
        }, text);
        this.shadeButtons.set(name, button);
        return button;
      }),
    );
    this.adjust = h("div", { class: "adjust" });
    this.layerBoxes = new Map();
    const layers = h("div", { class: "layers" },
      LAYERS.filter(([name]) => this.available[name]).map(([name, text]) => {
        const box = h("input", { type: "checkbox", "data-layer": name, onchange: (e) => this.applyLayer(name, e.target.checked) });
        this.layerBoxes.set(name, box);
        return h("label", { class: "check" }, box, h("span", {}, text));
      }),
    );
    this.seamsBy = h("select", { "data-control": "seams-by", onchange: (e) => this.applySeams(e.target.value) },
      [["plain", "one colour"], ["order", "measured order"], ["normal", "jump of the normal"], ["curvature", "jump of the curvature"]].map(
        ([value, text]) => h("option", { value }, text),
      ),
    );
    this.seamKey = h("div", { class: "seam-key" });
    const up = h("select", { "data-control": "up", onchange: (e) => this.stage.setUp(Number(e.target.value)) },
      ["X", "Y", "Z"].map((text, value) => h("option", { value, selected: value === head.view.up }, text)),
    );
    const lineCount = slider("lines", "Parameter lines", 2, 32, 1, this.state.lines, (v) => {
      this.state.lines = v;
      if (this.state.layers.lines) this.stage.set({ uLines: v });
    });
    this.patch = h("div", { class: "patch" });
    const panel = h("aside", { class: "panel", "aria-label": "Controls" },
      section("Shading", shades, this.adjust),
      section("Show", layers,
        this.available.seams && h("label", { class: "row" }, h("span", {}, "Seams by"), this.seamsBy), this.seamKey,
        lineCount, h("label", { class: "row" }, h("span", {}, "Upwards"), up)),
      section("Patch", this.patch),
      reportTables(models.map((m) => m.head)).map(({ title, rows, open }) => folded(title, open, table(models, rows))),
      notes(models),
      h("footer", {}, `Made by suture ${head.version}. Normals and curvatures are those of the patches, not of the triangles.`),
    );
    this.root.append(panel);
    this.showPatch();
  }

  // ---- what the controls do ----

  applyShade(name) {
    this.state.shade = name;
    for (const [key, button] of this.shadeButtons) button.setAttribute("aria-checked", String(key === name));
    this.stage.shade(name);
    this.adjust.replaceChildren(...this.adjustments(name));
    this.applyRange();
    this.stage.set({ uBands: this.state.bands });
    this.showLegend();
  }

  adjustments(name) {
    if (name === "reflection" || name === "isophotes") {
      const light = this.stage.light;
      const degrees = (x) => Math.round((x * 180) / Math.PI);
      const follows = h("input", { type: "checkbox", "data-control": "light-follows", onchange: (e) => {
        light.follows = e.target.checked;
        this.applyLight();
      } });
      follows.checked = light.follows;
      return [
        slider("bands", "Lines per half turn", 2, 96, 1, this.state.bands, (v) => this.applyBands(v)),
        slider("light-azimuth", "Light, sideways", -180, 180, 1, degrees(light.azimuth), (v) => {
          light.azimuth = (v * Math.PI) / 180;
          this.applyLight();
        }, "°"),
        slider("light-elevation", "Light, height", -90, 90, 1, degrees(light.elevation), (v) => {
          light.elevation = (v * Math.PI) / 180;
          this.applyLight();
        }, "°"),
        h("label", { class: "check" }, follows, h("span", {}, "Light follows the eye")),
      ];
    }
    if (RANGED.includes(name)) {
      const text = () => number(this.range());
      return [slider("range", name === "deviation" ? "Largest value shown" : "Range ±", -3, 3, 0.05, Math.log10(this.state.rangeFactor), (v) => {
        this.state.rangeFactor = 10 ** v;
        this.applyRange();
        this.showLegend();
        return text();
      }, "", text)];
    }
    return [];
  }

  applyBands(v) {
    this.state.bands = v;
    const input = this.adjust.querySelector('[data-control="bands"]');
    if (input) {
      input.value = v;
      input.parentElement.querySelector("output").textContent = v;
    }
    this.stage.set({ uBands: v });
  }

  applyLight() {
    this.stage.invalidate();
  }

  /** The largest value of the map: that of 95 % of the area over all models, times the factor of the slider. */
  range() {
    const { shade, rangeFactor } = this.state;
    if (!RANGED.includes(shade)) return 1;
    return Math.max(...this.models.map((m) => m.head.ranges[shade] ?? 0), 1e-12) * rangeFactor;
  }

  applyRange() {
    this.stage.set({ uRange: this.range() });
  }

  applyLayer(name, on) {
    if (!this.available[name]) return;
    this.state.layers[name] = on;
    const box = this.layerBoxes.get(name);
    box.checked = on;
    for (const m of this.models) {
      const part = { surface: m.surface, seams: m.seamLines, nets: m.nets, mesh: m.mesh, segments: m.segments, hull: m.hull }[name];
      if (part) part.visible = on;
    }
    if (name === "lines") this.stage.set({ uLines: on ? this.state.lines : 0 });
    // The two cover each other.
    if (name === "segments" && on === this.state.layers.surface) this.applyLayer("surface", !on);
    this.stage.invalidate();
  }

  applySeams(by) {
    this.state.seamsBy = by;
    this.seamsBy.value = by;
    const ink = this.root.dataset.theme === "dark" && !this.state.layers.surface ? 0xe6edf3 : 0x0b1220;
    for (const m of this.models) m.colorSeams(by, ink);
    this.seamKey.replaceChildren();
    if (by === "order") {
      const found = new Set(this.models.flatMap((m) => [...m.seams.orders].filter((_, i) => i % 2 === 1)));
      this.seamKey.append(...[...found].sort().map((o) => swatch(css(ORDER_COLORS[o]), o ? ORDERS[o] : "gap")));
    } else if (by !== "plain") {
      this.seamKey.append(bar("jump", ["1e-16", "1e-8", "1"], by === "normal" ? "radians" : "relative"));
    }
    if (by !== "plain") this.applyLayer("seams", true);
    this.stage.invalidate();
  }

  theme(name) {
    this.root.dataset.theme = name;
    document.documentElement.style.colorScheme = name;
    this.stage.background.set(getComputedStyle(this.root).getPropertyValue("--canvas").trim());
    this.applySeams(this.state.seamsBy);
    this.stage.invalidate();
  }

  toggle() {
    this.root.classList.toggle("bare");
  }

  save() {
    h("a", { href: this.stage.picture(), download: `${this.head.title.replace(/[^\w.-]+/g, "_")}.png` }).click();
  }

  // ---- legend and patch ----

  showLegend() {
    const { shade } = this.state;
    const list = [];
    if (shade === "patches") {
      const total = new Map();
      for (const m of this.models) for (const k of m.patchKind) total.set(k, (total.get(k) ?? 0) + 1);
      list.push(h("div", { class: "swatches" }, [...total].sort((a, b) => a[0] - b[0]).map(([k, n]) =>
        swatch(css(this.head.kinds[k].color), `${this.head.kinds[k].name}`, n.toLocaleString("en")))));
    } else if (RANGED.includes(shade)) {
      const r = this.range();
      const title = SHADES.find(([name]) => name === shade);
      const unit = { gaussian: "1 / diagonal²", deviation: "of the diagonal" }[shade] ?? "1 / diagonal";
      const ticks = shade === "deviation" ? ["0", percent(r / 2), percent(r)] : [number(-r), "0", number(r)];
      list.push(bar(shade === "deviation" ? "sequential" : "diverging", ticks, unit, title[1]));
    }
    this.legend.replaceChildren(...list);
    this.legend.hidden = list.length === 0;
  }

  pick(found) {
    const picked = found && found.patch >= 0 ? found : null;
    this.state.picked = picked;
    this.models.forEach((m, i) => {
      m.surface.material.uniforms.uSelected.value = picked?.model === i ? picked.patch : -1;
    });
    this.showPatch();
    this.stage.invalidate();
  }

  /** The patch `step` further on. */
  step(step) {
    const { model, patch } = this.state.picked ?? { model: 0, patch: step > 0 ? -1 : 0 };
    const n = this.models[model].patchKind.length;
    this.pick({ model, patch: (patch + step + n) % n });
  }

  showPatch() {
    const { picked } = this.state;
    const go = h("span", { class: "stepper" },
      h("button", { type: "button", "data-control": "previous-patch", title: "Previous patch (B)", onclick: () => this.step(-1) }, "‹"),
      h("button", { type: "button", "data-control": "next-patch", title: "Next patch (N)", onclick: () => this.step(1) }, "›"));
    if (!picked) {
      this.patch.replaceChildren(h("p", { class: "quiet" }, "Click or tap a patch, or step through them. ", go));
      return;
    }
    const d = this.models[picked.model].describe(picked.patch);
    const name = this.models.length > 1 ? `${this.models[picked.model].head.name}, patch` : "Patch";
    const rows = [
      ["Degree", d.degree], ["Triangles", d.triangles.toLocaleString("en")],
      ["Principal curvatures", `${number(d.curvature[0])} … ${number(d.curvature[1])}`],
      d.worst != null && ["Worst deviation", percent(d.worst)],
    ].filter(Boolean);
    this.patch.replaceChildren(
      h("div", { class: "picked" }, h("i", { style: `background:${css(d.color)}` }), h("strong", {}, `${name} ${d.patch}`), h("span", {}, d.kind), go),
      h("table", { class: "facts" }, rows.map(([k, v]) => h("tr", {}, h("th", { scope: "row" }, k), h("td", {}, v)))),
      d.seams.length ? h("div", { class: "scroll" }, h("table", { class: "seams" },
        h("thead", {}, h("tr", {}, ["Neighbour", "Order", "Gap", "Normal", "Curv."].map((t) => h("th", { scope: "col" }, t)))),
        h("tbody", {}, d.seams.map((s) => h("tr", { class: s.measured && ORDERS.indexOf(s.measured) >= ORDERS.indexOf(s.claimed) ? "" : "bad" },
          h("td", {}, h("button", { type: "button", class: "link", onclick: () => this.pick({ model: picked.model, patch: s.other }) }, `${s.other}`), ` ${s.kind}`),
          h("td", {}, s.measured ?? "gap"), h("td", {}, tiny(s.position)), h("td", {}, tiny(s.normal)), h("td", {}, tiny(s.curvature))))))) :
        h("p", { class: "quiet" }, "No seams."),
    );
  }

  // ---- hand and keyboard ----

  listen() {
    const canvas = this.stage.canvas;
    let down = null;
    canvas.addEventListener("pointerdown", (e) => {
      down = e.isPrimary && e.button === 0 ? { x: e.clientX, y: e.clientY, time: e.timeStamp } : null;
    });
    canvas.addEventListener("pointerup", (e) => {
      // A turn is not a click.
      if (down && Math.hypot(e.clientX - down.x, e.clientY - down.y) < 5 && e.timeStamp - down.time < 600) {
        this.pick(this.stage.pick(e.clientX, e.clientY));
      }
      down = null;
    });
    window.addEventListener("keydown", (e) => this.key(e));
  }

  key(e) {
    if (e.ctrlKey || e.metaKey || e.altKey || this.help.open) return;
    const field = e.target.closest?.("input, select, textarea");
    if (field && (e.key.startsWith("Arrow") || field.tagName === "SELECT")) return;
    const step = 0.12;
    const light = this.stage.light;
    const turnLight = (a, b) => {
      light.azimuth = Math.atan2(Math.sin(light.azimuth + a), Math.cos(light.azimuth + a));
      light.elevation = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, light.elevation + b));
      this.adjust.replaceChildren(...this.adjustments(this.state.shade));
      this.applyLight();
    };
    const layer = (name) => this.applyLayer(name, !this.state.layers[name]);
    const act = {
      ArrowLeft: () => (e.shiftKey ? this.stage.pan(-0.05, 0) : this.stage.orbit(-step, 0)),
      ArrowRight: () => (e.shiftKey ? this.stage.pan(0.05, 0) : this.stage.orbit(step, 0)),
      ArrowUp: () => (e.shiftKey ? this.stage.pan(0, 0.05) : this.stage.orbit(0, step)),
      ArrowDown: () => (e.shiftKey ? this.stage.pan(0, -0.05) : this.stage.orbit(0, -step)),
      "+": () => this.stage.zoom(0.85), "=": () => this.stage.zoom(0.85), "-": () => this.stage.zoom(1.18), "−": () => this.stage.zoom(1.18),
      s: () => layer("seams"), p: () => layer("lines"), c: () => layer("nets"), m: () => layer("mesh"), g: () => layer("segments"), t: () => layer("hull"),
      a: () => turnLight(-step, 0), d: () => turnLight(step, 0), w: () => turnLight(0, step), x: () => turnLight(0, -step),
      n: () => this.step(1), b: () => this.step(-1), f: () => this.stage.reset(), h: () => this.toggle(),
      l: () => this.theme(this.root.dataset.theme === "dark" ? "light" : "dark"), Escape: () => this.pick(null), "?": () => this.help.showModal(),
      "[": () => this.more(1 / 1.25), "]": () => this.more(1.25),
    };
    const shade = SHADES[Number(e.key) - 1];
    const action = shade ? () => this.shadeButtons.get(shade[0]).disabled || this.applyShade(shade[0]) : act[e.key.length === 1 ? e.key.toLowerCase() : e.key];
    if (action) {
      action();
      e.preventDefault();
    }
  }

  more(factor) {
    if (RANGED.includes(this.state.shade)) this.state.rangeFactor *= factor;
    else this.state.bands = Math.max(2, Math.min(96, Math.round(this.state.bands * factor + (factor > 1 ? 0.5 : -0.5))));
    this.applyShade(this.state.shade);
  }
}

const RANGED = ["mean", "gaussian", "largest", "smallest", "deviation"];

const percent = (x) => `${number(100 * x)} %`;
const tiny = (x) => (x === 0 ? "0" : Number.isFinite(x) ? x.toExponential(0) : "∞");

function tool(name, sign, title, onclick) {
  return h("button", { type: "button", "data-tool": name, title, "aria-label": title, onclick }, sign);
}

function section(title, ...children) {
  return h("section", {}, h("h2", {}, title), ...children);
}

function folded(title, open, content) {
  return h("details", { open }, h("summary", {}, title), content);
}

function slider(name, text, min, max, step, value, change, unit = "", show = null) {
  const output = h("output", {}, show ? show() : `${value}${unit}`);
  const input = h("input", { type: "range", min, max, step, value, "data-control": name, "aria-label": text, oninput: (e) => {
    const v = Number(e.target.value);
    output.textContent = change(v) ?? `${v}${unit}`;
  } });
  return h("label", { class: "slider" }, h("span", {}, text), output, input);
}

function swatch(color, text, count) {
  return h("span", { class: "swatch" }, h("i", { style: `background:${color}` }), text, count != null && h("em", {}, count));
}

function bar(map, ticks, unit, title) {
  return h("div", { class: "bar" },
    title && h("div", { class: "bar-title" }, h("strong", {}, title), " ", unit),
    h("div", { class: "ramp", style: `background:${gradient(map, "to right")}` }),
    h("div", { class: "ticks" }, ticks.map((t) => h("span", {}, t))),
    !title && h("div", { class: "unit" }, unit));
}

function table(models, rows) {
  const many = models.length > 1;
  return h("table", { class: "report" },
    many && h("thead", {}, h("tr", {}, h("th", {}), models.map((m) => h("th", { scope: "col" }, m.head.name)))),
    h("tbody", {}, rows.map(([name, ...values]) => h("tr", {}, h("th", { scope: "row" }, name), values.map((v) => h("td", {}, v))))));
}

function notes(models) {
  const list = models.flatMap((m) => (m.head.report.warnings ?? []).map((w) => (models.length > 1 ? `${m.head.name}: ${w}` : w)));
  return list.length ? folded(`Notes (${list.length})`, false, h("ul", { class: "notes" }, list.map((w) => h("li", {}, w)))) : null;
}

/** Whether the certificate holds its claim. */
function verdict(report) {
  const c = report.certificate;
  if (!c) return null;
  return { holds: ORDERS.indexOf(c.measured ?? "—") >= ORDERS.indexOf(c.claimed), claimed: c.claimed, measured: c.measured };
}

const raised = (order) => order.replace("0", "⁰").replace("1", "¹").replace("2", "²");

function badge(v) {
  if (!v) return null;
  const text = v.holds ? `${raised(v.measured)} measured` : `${raised(v.claimed)} claimed, ${v.measured ? raised(v.measured) : "a gap"} measured`;
  return h("span", { class: `badge ${v.holds ? "good" : "bad"}` }, text);
}

function subtitle(model) {
  const patches = model.patchKind.length;
  const parts = [`${patches.toLocaleString("en")} patch${patches === 1 ? "" : "es"}`, `${model.triangles.toLocaleString("en")} triangles`];
  const d = model.head.report.deviation;
  if (d) parts.push(d.mesh_to_surface.max < 1e-12 ? "through all vertices" : `rms ${percent(d.mesh_to_surface.rms)}`);
  return parts.join(" · ");
}


