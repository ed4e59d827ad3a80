// Opens pages in Chromium, drives every control and looks at the pixels. `cargo xtask browser` makes the pages and calls this with
// their folder; pictures of every page go there too.
import { existsSync, readdirSync, statSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const folder = resolve(process.argv[2] ?? ".");
const executablePath = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(
  (path) => path && existsSync(path),
);
if (!executablePath) {
  console.error("there is no Chromium: install it (Debian: apt-get install chromium) or name it in CHROMIUM");
  process.exit(2);
}
/** Limits of the page with 100,000 triangles: bytes, milliseconds to the first picture. */
const MOST_BYTES = 15e6;
const MOST_MILLISECONDS = Number(process.env.FIRST_FRAME_MS ?? 3000);

let failures = 0;
let checks = 0;
function check(what, good, detail = "") {
  checks++;
  if (!good) {
    failures++;
    console.log(`  FAILED  ${what} ${detail}`);
  }
}

const args = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"];
// Chromium refuses its sandbox to the superuser.
if (process.getuid?.() === 0) args.push("--no-sandbox");
const browser = await chromium.launch({ executablePath, args });

/** Runs in the page: what the canvas shows, and how much of it differs from what it showed before. */
function helpers() {
  window.look = () => {
    const { stage } = window.suture;
    stage.sharpen();
    stage.render();
    const gl = stage.renderer.getContext();
    const [w, h] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    const pixels = new Uint8Array(4 * w * h);
    gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    const before = window.seen?.length === pixels.length ? window.seen : null;
    window.seen = pixels;
    let [changed, drawn] = [0, 0];
    for (let i = 0; i < pixels.length; i += 4) {
      const far = (a, j) => Math.abs(a[i] - pixels[j]) + Math.abs(a[i + 1] - pixels[j + 1]) + Math.abs(a[i + 2] - pixels[j + 2]) > 24;
      if (before && far(before, i)) changed++;
      if (far(pixels, 0)) drawn++;
    }
    return { changed: before ? changed / (w * h) : 1, drawn: drawn / (w * h), w, h };
  };
  /** Luminance at a point of the page, from the last look. */
  window.shade = (x, y) => {
    const { stage } = window.suture;
    const box = stage.canvas.getBoundingClientRect();
    const gl = stage.renderer.getContext();
    const ratio = gl.drawingBufferWidth / box.width;
    const [px, py] = [Math.round((x - box.left) * ratio), gl.drawingBufferHeight - 1 - Math.round((y - box.top) * ratio)];
    const i = 4 * (py * gl.drawingBufferWidth + px);
    return 0.2126 * window.seen[i] + 0.7152 * window.seen[i + 1] + 0.0722 * window.seen[i + 2];
  };
}

async function open(name, { size = { width: 920, height: 560 }, touch = false, scheme = "light" } = {}) {
  const context = await browser.newContext({ viewport: size, hasTouch: touch, colorScheme: scheme, acceptDownloads: true });
  const page = await context.newPage();
  const errors = [];
  page.on("console", (m) => m.type() === "error" && errors.push(m.text()));
  page.on("pageerror", (e) => errors.push(e.message));
  page.on("request", (r) => /^(file|data|blob):/.test(r.url()) || errors.push(`asked the network for ${r.url()}`));
  await page.goto(pathToFileURL(join(folder, name)).href);
  await page.waitForFunction(() => document.documentElement.dataset.ready === "true", null, { timeout: 120_000 });
  await page.evaluate(helpers);
  const marks = await page.evaluate(() => window.suture.ready);
  return { page, errors, marks, close: () => context.close() };
}

/** Whether what a control does can be seen: more than `least` of the pixels change. */
async function visible(page, what, act, least = 0.001) {
  await page.evaluate(() => window.look());
  await act();
  const { changed } = await page.evaluate(() => window.look());
  check(what, changed > least, `${(100 * changed).toFixed(3)} % of the pixels changed`);
}

const slide = (page, name, value) =>
  page.locator(`[data-control="${name}"]`).evaluate((input, v) => {
    input.value = v;
    input.dispatchEvent(new Event("input", { bubbles: true }));
  }, String(value));

/** Every control of one page. */
async function drive(name) {
  console.log(name);
  const { page, errors, close } = await open(name);
  const state = () => page.evaluate(() => ({ ...window.suture.panel.state, picked: window.suture.panel.state.picked?.patch ?? null }));
  const first = await page.evaluate(() => window.look());
  check("the surface is drawn", first.drawn > 0.02, `${first.drawn}`);

  const shades = await page.locator("[data-shade]:enabled").evaluateAll((all) => all.map((b) => b.dataset.shade));
  check("shades", shades.length >= 8, shades.join());
  // Facets have no curvature: there, maps look alike.
  const curved = await page.evaluate(() => window.suture.models.some((m) => m.head.ranges.largest > 1e-9));
  for (const shade of shades) {
    const act = () => page.locator(`[data-shade="${shade}"]`).click();
    if (shade === "patches" || !curved) await act();
    else await visible(page, `shade ${shade}`, act, 0.0005);
    check(`${shade} is chosen`, (await state()).shade === shade);
    const legend = await page.locator(".legend").isVisible();
    check(`legend of ${shade}`, legend === !["plain", "reflection", "isophotes"].includes(shade));
    if (["mean", "gaussian", "largest", "smallest", "deviation"].includes(shade) && curved) {
      await visible(page, `range of ${shade}`, () => slide(page, "range", -0.7), 0.0002);
      await slide(page, "range", 0);
    }
  }

  // Light and lines.
  for (const shade of ["reflection", "isophotes"]) {
    await page.locator(`[data-shade="${shade}"]`).click();
    const seams = page.locator('[data-layer="seams"]');
    if (await seams.count()) await seams.uncheck();
    await visible(page, `${shade}: number of lines`, () => slide(page, "bands", 13), 0.01);
    await visible(page, `${shade}: light sideways`, () => slide(page, "light-azimuth", 70).then(() => slide(page, "light-elevation", 30)), 0.01);
    await visible(page, `${shade}: light up`, () => slide(page, "light-elevation", -50), 0.01);
    await visible(page, `${shade}: light stays with the object`, () => page.locator('[data-control="light-follows"]').uncheck(), 0.005);
    await page.locator('[data-control="light-follows"]').check();
    await slide(page, "bands", 24);
    if (await seams.count()) await seams.check();
  }
  await page.locator('[data-shade="patches"]').click();

  // Layers.
  for (const layer of await page.locator("[data-layer]").evaluateAll((all) => all.map((b) => b.dataset.layer))) {
    const box = page.locator(`[data-layer="${layer}"]`);
    // Parameter lines that lie closer than pixels are not drawn.
    if (layer === "lines") await page.evaluate(() => window.suture.stage.zoom(0.15));
    await visible(page, `layer ${layer}`, () => box.click(), 0.0005);
    await visible(page, `layer ${layer} back`, () => box.click(), 0.0005);
    if (layer === "lines") await page.evaluate(() => window.suture.stage.reset());
  }
  await page.evaluate(() => ["lines", "nets", "mesh", "segments", "hull"].forEach((l) => window.suture.panel.applyLayer(l, false)));
  await page.evaluate(() => window.suture.panel.applyLayer("surface", true));
  await page.locator('[data-layer="lines"]').check();
  await page.evaluate(() => window.suture.stage.zoom(0.15));
  await visible(page, "number of parameter lines", () => slide(page, "lines", 3), 0.0003);
  await page.locator('[data-layer="lines"]').uncheck();
  await page.locator('[data-tool="home"]').click();
  const by = page.locator('[data-control="seams-by"]');
  if (await by.count()) {
    for (const value of ["order", "normal", "curvature", "plain"]) {
      await by.selectOption(value);
      check(`seams by ${value}`, (await state()).seamsBy === value);
      check(`key of ${value}`, ((await page.locator(".seam-key").textContent()) !== "") === (value !== "plain"));
    }
    await visible(page, "seams by order", () => by.selectOption("order"), 0.0003);
    await by.selectOption("plain");
  }
  await visible(page, "axis", () => page.locator('[data-control="up"]').selectOption("0"), 0.01);
  await page.locator('[data-control="up"]').selectOption(String(await page.evaluate(() => window.suture.head.view.up)));

  // Patches.
  const target = await page.evaluate(() => {
    const { stage, models } = window.suture;
    const pane = stage.panes()[0];
    const box = stage.canvas.getBoundingClientRect();
    for (let i = 0; i < 2000; i++) {
      const [u, v] = [0.1 + 0.8 * ((i * 0.7548776662) % 1), 0.1 + 0.8 * ((i * 0.5698402911) % 1)];
      const [x, y] = [box.left + pane.x + u * pane.width, box.top + pane.y + v * pane.height];
      const found = stage.pick(x, y);
      if (found?.patch >= 0 && document.elementFromPoint(x, y) === stage.canvas) return { x, y, patch: found.patch, patches: models[0].head.patches };
    }
    return null;
  });
  check("a patch can be found", target !== null);
  if (target) {
    await page.mouse.click(target.x, target.y);
    check("a click picks the patch", (await state()).picked === target.patch);
    const text = await page.locator(".patch").textContent();
    check("kind, degree and curvature of the patch", /Degree/.test(text) && /Principal curvatures/.test(text), text);
    const neighbours = page.locator(".patch .link");
    if (await neighbours.count()) {
      check("jumps of its seams", (await page.locator(".patch .seams td").count()) >= 5);
      const other = Number(await neighbours.first().textContent());
      await neighbours.first().click();
      check("a neighbour is a step away", (await state()).picked === other);
    }
    if (target.patches > 1) {
      const from = (await state()).picked;
      await page.locator('[data-control="next-patch"]').click();
      check("next patch", (await state()).picked === (from + 1) % target.patches);
      await page.locator('[data-control="previous-patch"]').click();
      check("previous patch", (await state()).picked === from);
    }
    await page.keyboard.press("Escape");
    check("Escape lets go", (await state()).picked === null);
  }

  // Hand: turn, move, wheel.
  const box = await page.locator("canvas").boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const drag = async (button) => {
    await page.mouse.move(x, y);
    await page.mouse.down({ button });
    await page.mouse.move(x + 90, y + 40, { steps: 4 });
    await page.mouse.up({ button });
    await page.waitForTimeout(400);
  };
  await visible(page, "drag turns", () => drag("left"), 0.005);
  check("a drag picks nothing", (await state()).picked === null);
  await visible(page, "right drag moves", () => drag("right"), 0.005);
  await visible(page, "wheel", async () => {
    await page.mouse.move(x, y);
    await page.mouse.wheel(0, -300);
    await page.waitForTimeout(400);
  }, 0.005);

  // Tools.
  await visible(page, "home", () => page.locator('[data-tool="home"]').click(), 0.005);
  await visible(page, "closer", () => page.locator('[data-tool="closer"]').click(), 0.003);
  await visible(page, "farther", () => page.locator('[data-tool="farther"]').click(), 0.003);
  const dark = await page.locator("#suture").getAttribute("data-theme");
  await visible(page, "theme", () => page.locator('[data-tool="theme"]').click(), 0.05);
  check("the theme is the other one", (await page.locator("#suture").getAttribute("data-theme")) !== dark);
  await page.locator('[data-tool="theme"]').click();
  const download = page.waitForEvent("download");
  await page.locator('[data-tool="picture"]').click();
  check("the picture has a name", /\.png$/.test((await download).suggestedFilename()));
  await page.locator('[data-tool="help"]').click();
  check("help opens", await page.locator("dialog.help").isVisible());
  await page.locator("dialog.help button").click();
  check("help closes", !(await page.locator("dialog.help").isVisible()));
  await page.locator('[data-tool="panel"]').click();
  check("the panel hides", !(await page.locator(".panel").isVisible()));
  await page.locator('[data-tool="panel"]').click();

  // Keyboard: every key has an effect.
  await page.locator("canvas").focus();
  for (const key of ["ArrowLeft", "ArrowUp", "Shift+ArrowRight", "Shift+ArrowDown", "+", "-", "f"]) {
    await visible(page, `key ${key}`, () => page.keyboard.press(key), key === "f" ? 0 : 0.0005);
  }
  await page.keyboard.press("3");
  check("key 3", (await state()).shade === "reflection");
  await visible(page, "key ]", () => page.keyboard.press("]"), 0.001);
  for (const key of ["a", "w", "d", "x"]) await visible(page, `key ${key}`, () => page.keyboard.press(key), 0.0005);
  await page.keyboard.press("1");
  for (const [key, layer] of [["s", "seams"], ["p", "lines"], ["c", "nets"], ["m", "mesh"], ["g", "segments"], ["t", "hull"]]) {
    if (!(await page.locator(`[data-layer="${layer}"]`).count())) continue;
    const was = (await state()).layers[layer];
    await page.keyboard.press(key);
    check(`key ${key}`, (await state()).layers[layer] === !was);
    await page.keyboard.press(key);
  }
  await page.keyboard.press("n");
  check("key n", (await state()).picked !== null);
  await page.keyboard.press("Escape");
  await page.keyboard.press("l");
  await page.keyboard.press("l");

  // Tables.
  const report = await page.locator(".panel details").evaluateAll((all) => all.map((d) => ((d.open = true), d.textContent)).join("\n"));
  check("the certificate is a table", /Measured/.test(report) && /Largest jump of curvature/.test(report), report.slice(0, 200));
  check("the tessellation is a table", /Triangles/.test(report) || name.startsWith("compare"), "");
  check("no holes in the tables", !/undefined|NaN|\[object/.test(report));
  await page.screenshot({ path: join(folder, name.replace(".html", ".png")) });
  check("the console is free of errors", errors.length === 0, errors.join("; "));
  await close();
}

/**
 * Share of places at which the picture jumps between two points 5 pixels apart: on either side of a seam, and 12 pixels beside it
 * within one patch.
 */
async function broken(name) {
  const { page, errors, close } = await open(name);
  const shares = await page.evaluate(() => {
    const { stage, panel, models } = window.suture;
    panel.applyShade("reflection");
    panel.applyBands(4);
    panel.applyLayer("seams", false);
    window.look();
    const model = models[0];
    const position = model.surface.geometry.getAttribute("position");
    const ends = model.section("seam_edges");
    const seams = model.edgeSeam;
    const canvas = stage.canvas.getBoundingClientRect();
    const vector = model.surface.position.clone();
    const project = (v) => {
      const p = vector.fromBufferAttribute(position, v).applyMatrix4(model.surface.matrixWorld).project(stage.camera);
      return [canvas.left + (0.5 + 0.5 * p.x) * canvas.width, canvas.top + (0.5 - 0.5 * p.y) * canvas.height];
    };
    const counts = [[0, 0], [0, 0]];
    const step = Math.max(1, Math.floor(seams.length / 700));
    for (let e = 0; e < seams.length; e += step) {
      const [a, b] = [project(ends[2 * e]), project(ends[2 * e + 1])];
      const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
      if (length < 2) continue;
      const middle = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
      const normal = [(a[1] - b[1]) / length, (b[0] - a[0]) / length];
      const own = [0, 1].map((k) => model.seams.patches[2 * seams[e] + k]).sort((p, q) => p - q);
      // Only places where both pairs are seen: at the silhouette, where lines lie close, a pair of one patch is rare.
      const pairs = [0, 12].map((away, row) => {
        const points = [-2.5, 2.5].map((d) => [middle[0] + normal[0] * (d + away), middle[1] + normal[1] * (d + away)]);
        const patches = points.map(([x, y]) => stage.pick(x, y)?.patch ?? -1).sort((p, q) => p - q);
        const seen = row === 0 ? patches[0] === own[0] && patches[1] === own[1] : patches[0] === patches[1] && own.includes(patches[0]);
        return seen ? points.map(([x, y]) => window.shade(x, y)) : null;
      });
      if (!pairs[0] || !pairs[1]) continue;
      pairs.forEach(([p, q], row) => {
        counts[row][0]++;
        if (Math.abs(p - q) > 70) counts[row][1]++;
      });
    }
    return counts.map(([n, jumps]) => ({ n, share: jumps / Math.max(n, 1) }));
  });
  check(`${name}: console`, errors.length === 0, errors.join("; "));
  await close();
  return shares;
}

async function touch(name) {
  const { page, errors, close } = await open(name, { size: { width: 400, height: 800 }, touch: true, scheme: "dark" });
  console.log(`${name} on a small dark touch screen`);
  check("the dark theme follows the system", (await page.locator("#suture").getAttribute("data-theme")) === "dark");
  const client = await page.context().newCDPSession(page);
  const box = await page.locator("canvas").boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const send = (type, points) => client.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([px, py], id) => ({ x: px, y: py, id })) });
  await visible(page, "one finger turns", async () => {
    await send("touchStart", [[x, y]]);
    for (let i = 1; i <= 5; i++) await send("touchMove", [[x + 14 * i, y]]);
    await send("touchEnd", []);
    await page.waitForTimeout(400);
  }, 0.005);
  await visible(page, "two fingers come closer", async () => {
    await send("touchStart", [[x - 30, y], [x + 30, y]]);
    for (let i = 1; i <= 5; i++) await send("touchMove", [[x - 30 - 9 * i, y], [x + 30 + 9 * i, y]]);
    await send("touchEnd", []);
    await page.waitForTimeout(400);
  }, 0.005);
  await page.locator('[data-tool="home"]').click();
  await page.touchscreen.tap(x, y);
  await page.waitForTimeout(100);
  const scrolls = await page.locator(".panel").evaluate((p) => p.scrollHeight > p.clientHeight && p.getBoundingClientRect().width <= 400);
  check("the panel lies below and scrolls", scrolls);
  await page.screenshot({ path: join(folder, name.replace(".html", "-small.png")) });
  check("the console is free of errors", errors.length === 0, errors.join("; "));
  await close();
}

const pages = readdirSync(folder).filter((f) => f.endsWith(".html")).sort();
if (pages.length === 0) {
  console.error(`no pages in ${folder}`);
  process.exit(2);
}
const special = ["large.html", "folded.html"];
for (const name of pages.filter((p) => !special.includes(p))) await drive(name);
if (pages.includes("sphere.html")) await touch("sphere.html");

if (pages.includes("sphere.html") && pages.includes("folded.html")) {
  const [smooth, folded] = [await broken("sphere.html"), await broken("folded.html")];
  const text = (s) => s.map(({ n, share }) => `${(100 * share).toFixed(1)} % of ${n}`).join(" at seams, ") + " beside them";
  console.log(`reflection lines jump: C² sphere ${text(smooth)}; facets ${text(folded)}`);
  check("enough places are seen", smooth[0].n > 40 && smooth[1].n > 40 && folded[0].n > 40);
  check("reflection lines of a C² sphere run through its seams", smooth[0].share < smooth[1].share + 0.06);
  check("reflection lines of facets break at every edge", folded[0].share > folded[1].share + 0.15);
}

if (pages.includes("large.html")) {
  const bytes = statSync(join(folder, "large.html")).size;
  const times = [];
  let triangles = 0;
  for (let i = 0; i < 3; i++) {
    const { page, marks, close } = await open("large.html", { size: { width: 1280, height: 800 } });
    triangles = await page.evaluate(() => window.suture.models[0].triangles);
    times.push(marks.picture);
    await close();
  }
  console.log(`${triangles} triangles: ${(bytes / 1e6).toFixed(2)} MB, first picture after ${times.join(", ")} ms`);
  check("100,000 triangles", triangles >= 100_000, `${triangles}`);
  check(`at most ${MOST_BYTES / 1e6} MB for 100,000 triangles`, bytes <= MOST_BYTES * (triangles / 100_000), `${bytes}`);
  check(`first picture within ${MOST_MILLISECONDS} ms`, Math.min(...times) <= MOST_MILLISECONDS, times.join());
}

await browser.close();
console.log(failures ? `${failures} of ${checks} checks failed` : `${checks} checks are good`);
process.exit(failures ? 1 : 0);
