// Entry: decodes the page's data, builds stage and panel, reports when the first frame is there.
import { load } from "./data.js";
import { Model } from "./model.js";
import { makeRenderer, Stage } from "./stage.js";
import { Panel } from "./panel.js";

async function start() {
  const root = document.getElementById("suture");
  const message = root.querySelector(".loading");
  try {
    const marks = {};
    const mark = (name) => (marks[name] = Math.round(performance.now()));
    mark("start");
    const { head, body } = await load(document.getElementById("suture-data").textContent);
    mark("unpacked");
    // The text is not needed any more, and there is much of it.
    document.getElementById("suture-data").remove();
    const canvas = root.querySelector("canvas");
    const { renderer, software } = makeRenderer(canvas);
    mark("renderer");
    const models = head.models.map((m) => new Model(m, body, head.kinds, software));
    mark("models");
    const stage = new Stage(canvas, renderer, models, head.view);
    const panel = new Panel(root, head, models, stage);
    mark("panel");
    const ready = new Promise((done) => {
      stage.onFrame = () => {
        stage.onFrame = null;
        mark("commands");
        message.remove();
        // Waits for the picture itself, not only for the commands that draw it.
        const gl = stage.renderer.getContext();
        const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
        gl.flush();
        const wait = () => {
          if (!gl.isContextLost() && gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) return setTimeout(wait, 4);
          mark("picture");
          done(marks);
          stage.sharpen();
        };
        wait();
      };
    });
    window.suture = { head, models, stage, panel, ready, marks };
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
