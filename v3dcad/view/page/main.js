// The page: reads what Python packed, and puts stage, drawing and controls together.

import { clip, isCut } from "./clipping.js";
import { Drawing, shownLayers } from "./drawing.js";
import { element, showCell } from "./facts.js";
import { bindings, listen } from "./keys.js";
import * as live from "./live.js";
import { unpack } from "./packed.js";
import { byId, panel } from "./panel.js";
import { pick } from "./pick.js";
import { player } from "./player.js";
import { Stage } from "./stage.js";
import { State } from "./state.js";
import { Structure } from "./structure.js";
import { dress, follow } from "./theme.js";

const STILL = 5; // pixels: a pointer that moved less has clicked

async function start() {
  const told = JSON.parse(byId("told").textContent);
  const arrays = await unpack(byId("data").textContent, told.table);
  byId("data").remove(); // nobody needs the text again
  const structure = new Structure(arrays, told.bounds, told.span);
  const [low, high] = told.bounds;
  const top = Math.max(high[2], arrays.z.at(-1) + told.span[1]); // of the uppermost walls
  const drawn = [low, [high[0], high[1], top]];
  const canvas = byId("canvas");
  const stage = new Stage(canvas, told.bounds);
  const drawing = new Drawing(stage, structure, told);
  const { toolpath } = drawing;
  const last = structure.layers - 1;
  const first = {
    target: "full", form: "walls", layer: last, cell: -1, neighbour: -1, time: 0, playing: false,
    part: true, clip: "off", at: 50, flip: false, travels: true, seams: true, theme: "system",
    ...told.first,
  };
  const state = new State({ ...first, ...(told.live ? live.kept() : {}) }, (values, patch) =>
    together(toolpath, values, patch),
  );

  const colours = () => {
    const found = dress(state.values.theme);
    drawing.dress(found);
    stage.background(found.background);
  };
  const moveLayer = (steps) =>
    state.set({ layer: Math.min(Math.max(state.values.layer + steps, 0), last) });
  const choose = (site) => {
    const cell = structure.arrays.volumes[site] > 0 ? site : -1;
    const second = state.values.target === "neighbour" && state.values.cell >= 0 && cell >= 0;
    state.set(second ? { neighbour: cell } : { cell, neighbour: -1 });
    tell(cell === site ? "" : `There is no cell ${site}: click one in the part.`);
  };
  const play = () => state.set({ playing: !state.values.playing });

  state.watch((values, changed) => {
    if (changed.has("theme")) colours();
    clip(values, drawn);
    drawing.update(values);
    showCell(byId("card"), structure, values, choose);
  });
  follow(() => {
    colours();
    drawing.update(state.values);
  });
  player(state, structure, toolpath);
  panel({ state, structure, told, drawing, play, choose });
  const rows = bindings({ state, stage, moveLayer, play });
  listen(rows);
  byId("keys").replaceChildren(
    ...rows.flatMap(([keys, text]) => [element("dt", keys), element("dd", text)]),
  );
  onClick(canvas, (x, y) => {
    const found = pick(structure, stage.ray(x, y), shownLayers(state.values), isCut);
    state.set({ cell: found ? found.cell : -1, neighbour: -1 });
    tell("");
  });
  if (told.live) live.follow(told.live, () => state.values, tell);
  byId("app").dataset.ready = "yes";
  // For tests and for the curious: what is shown, and how it is drawn.
  globalThis.v3dcad = { state, stage, drawing, structure, toolpath, told };
}

// In a toolpath, layer and moment go together: each follows the other.
function together(toolpath, values, patch) {
  const { target } = { ...values, ...patch };
  if (target !== "toolpath" || !toolpath) return {};
  if ("time" in patch) return { layer: toolpath.layerAt(patch.time) };
  if ("layer" in patch || "target" in patch) {
    return { time: toolpath.done(patch.layer ?? values.layer) };
  }
  return {};
}

// Call `clicked` with where on the canvas a click or tap was, x and y from −1 to 1.
function onClick(canvas, clicked) {
  let down = null;
  canvas.addEventListener("pointerdown", (event) => {
    down = event.isPrimary ? [event.clientX, event.clientY] : null;
  });
  canvas.addEventListener("pointerup", (event) => {
    if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > STILL) return;
    const box = canvas.getBoundingClientRect();
    const x = (2 * (event.clientX - box.left)) / box.width - 1;
    clicked(x, 1 - (2 * (event.clientY - box.top)) / box.height);
  });
}

function tell(text) {
  byId("message").textContent = text;
  byId("message").hidden = !text;
}

start().catch((error) => {
  tell(`This page cannot be drawn: ${error.message}. It needs a browser of 2023 or later with WebGL 2.`);
  throw error;
});
