// Entry: decodes the page's data, builds stage and panel, reports when the first frame is there.
import { load } from "./data.js";
import { Model } from "./model.js";
import { Stage } from "./stage.js";
import { Panel } from "./panel.js";

async function start() {
  const root = document.getElementById("suture");
  const message = root.querySelector(".loading");
  try {
    const { head, body } = await load(document.getElementById("suture-data").textContent);
    // The text is not needed any more, and there is much of it.
    document.getElementById("suture-data").remove();
    const models = head.models.map((m) => new Model(m, body, head.kinds));
    const canvas = root.querySelector("canvas");
    const stage = new Stage(canvas, models, head.view);
    const panel = new Panel(root, head, models, stage);
    const ready = new Promise((done) => {
      stage.onFrame = () => {
        stage.onFrame = null;
        // Waits for the picture itself, not only for the commands that draw it.
        const gl = stage.renderer.getContext();
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
        message.remove();
        done({ milliseconds: performance.now() });
      };
    });
    window.suture = { head, models, stage, panel, ready };
    stage.invalidate();
    await ready;
    document.documentElement.dataset.ready = "true";
  } catch (error) {
    message.textContent = `This page cannot be shown: ${error.message}. It needs WebGL 2 and DecompressionStream (any browser since 2023).`;
    message.classList.add("failed");
    console.error(error);
  }
}

start();
