// The canvas: one view per model beside each other, one camera for all of them.
import {
  AmbientLight, Color, DirectionalLight, Group, MathUtils, PerspectiveCamera, Quaternion, Raycaster, Scene, Vector2, Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { mapTexture, MODES } from "./shader.js";

const FIELD_OF_VIEW = 30;
/** Width of the column of tools, in pixels. */
const TOOLS = 54;
/** Milliseconds from picture to picture beyond which turning is slow. */
const SLOW = 110;

/** Unit vector of an orbit angle, `y` upwards. */
const direction = (azimuth, elevation) =>
  new Vector3(Math.sin(azimuth) * Math.cos(elevation), Math.sin(elevation), Math.cos(azimuth) * Math.cos(elevation));

/** The renderer, and whether it computes without graphics hardware. */
export function makeRenderer(canvas) {
  const renderer = new WebGLRenderer({ canvas, antialias: true });
  const gl = renderer.getContext();
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
  return { renderer, software: /swiftshader|llvmpipe|software|basic render/i.test(name) };
}

export class Stage {
  constructor(canvas, renderer, models, options) {
    this.canvas = canvas;
    this.models = models;
    this.renderer = renderer;
    this.renderer.setScissorTest(true);
    this.renderer.autoClear = false;
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 100);
    this.maps = { diverging: mapTexture("diverging"), sequential: mapTexture("sequential") };
    this.background = new Color(0xffffff);
    this.scenes = models.map((model) => {
      const scene = new Scene();
      const root = new Group();
      root.add(model.group);
      scene.add(root, new AmbientLight(0xffffff, 1.3));
      const lamp = new DirectionalLight(0xffffff, 1.9);
      scene.add(lamp);
      return { scene, root, lamp };
    });
    this.light = { azimuth: 0, elevation: Math.PI / 2, follows: true };
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.rotateSpeed = 0.9;
    this.controls.zoomSpeed = 1.1;
    this.controls.addEventListener("change", () => this.invalidate());
    this.controls.addEventListener("start", () => Object.assign(this, { turning: true, pace: 0 }));
    this.controls.addEventListener("end", () => {
      this.turning = false;
      setTimeout(() => this.turning || this.sharpen(), 200);
    });
    this.frames = 0;
    this.pending = false;
    // Pixels of the canvas per pixel of the screen along an axis: the first picture is coarse and there sooner.
    this.fineness = 0.5;
    this.resize();
    this.setUp(options.up, options.azimuth, options.elevation);
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
  }

  /** Turns the models so that `axis` (0 to 2) points upwards, and looks from the given angles. */
  setUp(axis, azimuth, elevation) {
    const ups = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];
    const fronts = [ups[1], ups[2], ups[0]];
    // The axis after `up` comes towards the eye at azimuth 0.
    const [up, front] = [ups[axis], fronts[axis]];
    const toUp = new Quaternion().setFromUnitVectors(up, new Vector3(0, 1, 0));
    const turned = front.clone().applyQuaternion(toUp);
    const turn = new Quaternion().setFromUnitVectors(turned, new Vector3(0, 0, 1));
    for (const { root } of this.scenes) root.quaternion.copy(turn).multiply(toUp);
    this.axis = axis;
    for (const { root } of this.scenes) root.updateMatrixWorld(true);
    this.home = { azimuth: azimuth ?? this.bestAzimuth(elevation ?? 0.45), elevation: elevation ?? 0.45 };
    this.reset();
  }

  /** Of eight directions the one that sees the largest area. */
  bestAzimuth(elevation) {
    const { geometry } = this.models[0].surface;
    const [position, index] = [geometry.getAttribute("position").array, geometry.index.array];
    const turn = this.scenes[0].root.quaternion;
    const step = 3 * Math.max(1, Math.floor(index.length / 3 / 20_000));
    const areas = [];
    const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
    for (let t = 0; t < index.length; t += step) {
      [a, b, c].forEach((v, k) => v.fromArray(position, 3 * index[t + k]));
      areas.push(b.sub(a).cross(c.sub(a)).applyQuaternion(turn).clone());
    }
    let best = [0.585, -1];
    for (let i = 0; i < 8; i++) {
      const azimuth = (0.125 + 0.125 * i) * 2 * Math.PI - 0.2;
      const back = direction(azimuth, elevation);
      const area = areas.reduce((sum, n) => sum + Math.max(0, n.dot(back)), 0);
      // A closed surface has the same area from behind: the first one stays.
      if (area > best[1] * 1.02) best = [azimuth, area];
    }
    return best[0];
  }

  /** The whole model, from where it was first seen. */
  reset() {
    const radius = Math.max(...this.models.map((m) => m.surface.geometry.boundingSphere.radius), 1e-6);
    const back = direction(this.home.azimuth, this.home.elevation);
    const right = new Vector3(0, 1, 0).cross(back).normalize();
    const up = back.clone().cross(right);
    // Room for the heading above and the legend below.
    const [above, below] = [64, 100];
    const tan = Math.tan(MathUtils.degToRad(FIELD_OF_VIEW / 2));
    this.stacked = this.arrange(right, up, above + below);
    this.onLayout?.(this.panes());
    const pane = this.panes()[0];
    const room = Math.max(0.5, 1 - (above + below) / pane.height);
    const tans = [0.9 * tan * (pane.width / pane.height), room * tan];
    // A vertex (x, y, z) is in the picture of an eye at (X, Y, Z) if |x − X| ≤ tan (Z − z), and alike for y.
    const reach = [[-Infinity, -Infinity], [-Infinity, -Infinity]];
    const p = new Vector3();
    this.models.forEach((model, i) => {
      const position = model.surface.geometry.getAttribute("position");
      const step = Math.max(1, Math.floor(position.count / 20_000));
      for (let v = 0; v < position.count; v += step) {
        p.fromBufferAttribute(position, v).applyQuaternion(this.scenes[i].root.quaternion);
        const depth = p.dot(back);
        [p.dot(right), p.dot(up)].forEach((c, axis) => {
          reach[axis][0] = Math.max(reach[axis][0], c + tans[axis] * depth);
          reach[axis][1] = Math.max(reach[axis][1], -c + tans[axis] * depth);
        });
      }
    });
    const [x, y] = reach.map(([plus, minus]) => 0.5 * (plus - minus));
    const distance = Math.max(...[0, 1].map((axis) => (0.5 * (reach[axis][0] + reach[axis][1])) / tans[axis]));
    const lower = ((below - above) / pane.height) * tan * distance;
    this.controls.target.copy(right).multiplyScalar(x).addScaledVector(up, y - lower);
    this.camera.position.copy(this.controls.target).addScaledVector(back, distance);
    this.controls.minDistance = 0.02 * radius;
    this.controls.maxDistance = 12 * radius;
    this.radius = radius;
    this.controls.update();
    this.invalidate();
  }

  /** Whether views above each other show the models larger than views beside each other. */
  arrange(right, up, margin) {
    const n = this.models.length;
    const { position } = this.models[0].surface.geometry.attributes;
    const box = [[Infinity, -Infinity], [Infinity, -Infinity]];
    const p = new Vector3();
    for (let v = 0; v < position.count; v += Math.max(1, Math.floor(position.count / 5000))) {
      p.fromBufferAttribute(position, v).applyQuaternion(this.scenes[0].root.quaternion);
      [p.dot(right), p.dot(up)].forEach((c, k) => (box[k] = [Math.min(box[k][0], c), Math.max(box[k][1], c)]));
    }
    const [wide, high] = box.map(([low, top]) => top - low + 1e-9);
    const [width, height] = [this.canvas.clientWidth || 1, this.canvas.clientHeight || 1];
    const scale = (w, h) => Math.min((0.9 * w) / wide, Math.max(h - margin, 0.5 * h) / high);
    return n > 1 && scale(width, height / n) > scale((width - TOOLS) / n, height);
  }

  /** Turns the camera around the target by angles in radians. */
  orbit(azimuth, elevation) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const length = offset.length();
    const theta = Math.atan2(offset.x, offset.z) + azimuth;
    const phi = MathUtils.clamp(Math.asin(offset.y / length) + elevation, -1.55, 1.55);
    offset.set(Math.sin(theta) * Math.cos(phi), Math.sin(phi), Math.cos(theta) * Math.cos(phi)).multiplyScalar(length);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.invalidate();
  }

  zoom(factor) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const length = MathUtils.clamp(offset.length() * factor, this.controls.minDistance, this.controls.maxDistance);
    this.camera.position.copy(this.controls.target).add(offset.setLength(length));
    this.controls.update();
    this.invalidate();
  }

  /** Moves the target in the plane of the picture, in shares of its height. */
  pan(right, up) {
    const distance = this.camera.position.distanceTo(this.controls.target);
    const scale = 2 * distance * Math.tan(MathUtils.degToRad(FIELD_OF_VIEW / 2));
    const x = new Vector3().setFromMatrixColumn(this.camera.matrix, 0).multiplyScalar(right * scale);
    const y = new Vector3().setFromMatrixColumn(this.camera.matrix, 1).multiplyScalar(up * scale);
    this.camera.position.add(x).add(y);
    this.controls.target.add(x).add(y);
    this.controls.update();
    this.invalidate();
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2) * this.fineness);
    this.renderer.setSize(Math.max(1, clientWidth), Math.max(1, clientHeight), false);
    this.onLayout?.(this.panes());
    this.invalidate();
  }

  /** All pixels again. */
  sharpen() {
    if (this.fineness === 1) return;
    this.fineness = 1;
    this.resize();
    this.render();
  }

  /** Fewer pixels while a hand turns the model and the machine cannot keep up. */
  keepUp() {
    const now = performance.now();
    if (this.turning && this.fineness === 1) {
      this.pace = 0.6 * this.pace + 0.4 * Math.min(now - this.last, 500);
      if (this.pace > SLOW) {
        this.fineness = 0.5;
        this.resize();
      }
    }
    this.last = now;
  }

  /** The rectangles of the views in pixels of the page, from the upper left corner. */
  panes() {
    const [width, height] = [this.canvas.clientWidth || 1, this.canvas.clientHeight || 1];
    const n = this.models.length;
    if (this.stacked) return this.models.map((_, i) => ({ x: 0, y: (i * height) / n, width, height: height / n }));
    // Beside each other they leave the tools their corner.
    const room = n > 1 ? Math.max(width - TOOLS, 0.5 * width) : width;
    return this.models.map((_, i) => ({ x: (i * room) / n, y: 0, width: room / n, height }));
  }

  invalidate() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      // Damping goes on after the hand has let go.
      this.controls.update();
      this.keepUp();
      this.render();
    });
  }

  render() {
    const { renderer, camera } = this;
    const height = this.canvas.clientHeight;
    const distance = camera.position.distanceTo(this.controls.target);
    camera.near = Math.max(distance - 4 * this.radius, 0.004 * distance);
    camera.far = distance + 6 * this.radius;
    renderer.setClearColor(this.background);
    renderer.setViewport(0, 0, this.canvas.clientWidth, height);
    renderer.setScissor(0, 0, this.canvas.clientWidth, height);
    renderer.clear();
    this.panes().forEach((pane, i) => {
      const bottom = height - pane.y - pane.height;
      renderer.setViewport(pane.x, bottom, pane.width, pane.height);
      renderer.setScissor(pane.x, bottom, pane.width, pane.height);
      camera.aspect = pane.width / pane.height;
      camera.updateProjectionMatrix();
      camera.updateMatrixWorld();
      renderer.clear();
      const { scene, lamp } = this.scenes[i];
      lamp.position.copy(camera.position).add(new Vector3(-0.6, 0.9, 0.2).applyQuaternion(camera.quaternion));
      const uniforms = this.models[i].surface.material.uniforms;
      uniforms.uLight.value.copy(this.lightInView());
      uniforms.uUp.value.set(0, 1, 0).transformDirection(camera.matrixWorldInverse);
      renderer.render(scene, camera);
    });
    this.frames++;
    this.onFrame?.();
  }

  /** Unit vector of the light in coordinates of the eye. */
  lightInView() {
    const { azimuth, elevation, follows } = this.light;
    const l = direction(azimuth, elevation);
    return follows ? l : l.transformDirection(this.camera.matrixWorldInverse);
  }

  /** Sets uniforms of all surfaces. */
  set(values) {
    for (const model of this.models) {
      const uniforms = model.surface.material.uniforms;
      for (const [name, value] of Object.entries(values)) uniforms[name].value = value;
    }
    this.invalidate();
  }

  shade(mode) {
    this.set({ uMode: MODES[mode], uMap: this.maps[mode === "deviation" ? "sequential" : "diverging"] });
  }

  /** Model, patch and place under a point of the page; null where there is none. */
  pick(clientX, clientY) {
    const box = this.canvas.getBoundingClientRect();
    const [x, y] = [clientX - box.left, clientY - box.top];
    const number = this.panes().findIndex((p) => x >= p.x && x < p.x + p.width && y >= p.y && y < p.y + p.height);
    if (number < 0) return null;
    const pane = this.panes()[number];
    this.camera.aspect = pane.width / pane.height;
    this.camera.updateProjectionMatrix();
    // The camera may have moved since the last picture.
    this.camera.updateMatrixWorld();
    const at = new Vector2((2 * (x - pane.x)) / pane.width - 1, 1 - (2 * (y - pane.y)) / pane.height);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.camera);
    const model = this.models[number];
    const hit = ray.intersectObject(model.surface, false)[0];
    if (!hit) return { model: number, patch: -1 };
    const { a, b, c } = hit.face;
    return { model: number, patch: model.patchOf(hit.faceIndex), vertices: [a, b, c], point: hit.point };
  }

  /** A picture of what is shown, as the URL of a PNG file. */
  picture() {
    this.sharpen();
    this.render();
    return this.canvas.toDataURL("image/png");
  }
}
