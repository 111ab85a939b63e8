// The controls: each writes the state, and is set by it.

import { roles } from "./drawing.js";
import { element } from "./facts.js";
import { sizes } from "./fills.js";
import { THEMES } from "./theme.js";

export const byId = (id) => document.getElementById(id);

// Bind a control to the value of the same name; `read` and `write` say how it holds it.
function bind(state, name, property, type = String) {
  const control = byId(name);
  control.addEventListener("input", () => {
    const value = type(control[property]);
    if (!Number.isNaN(value)) state.set({ [name]: value });
  });
  state.watch((values, changed) => {
    if (changed.has(name) && type(control[property]) !== values[name]) {
      control[property] = values[name];
    }
  });
}

export function panel({ state, structure, told, drawing, play, choose }) {
  const { toolpath } = drawing;
  heading(told);
  const offered = told.targets.filter(([name]) => name !== "toolpath" || toolpath);
  byId("target").replaceChildren(...offered.map(([name]) => element("option", name)));
  byId("layer").max = structure.layers - 1;
  byId("time").max = toolpath?.total ?? 0;
  for (const name of ["target", "form", "clip"]) bind(state, name, "value");
  for (const name of ["layer", "time", "at"]) bind(state, name, "value", Number);
  for (const name of ["part", "flip", "travels", "seams"]) bind(state, name, "checked", Boolean);
  byId("play").addEventListener("click", play);
  byId("close").addEventListener("click", () => state.set({ cell: -1, neighbour: -1 }));
  byId("theme").addEventListener("click", () => {
    const next = THEMES[(THEMES.indexOf(state.values.theme) + 1) % THEMES.length];
    state.set({ theme: next });
  });
  byId("cell").addEventListener("change", (event) => {
    const { value } = event.target;
    choose(value === "" ? -1 : Number(value));
  });
  state.watch((values) => {
    show(values, structure, told, toolpath);
    legend(values, structure, told, drawing.colours);
  });
}

function heading(told) {
  byId("title").textContent = told.title;
  const rows = told.facts.flatMap(([name, text]) => [element("dt", name), element("dd", text)]);
  byId("facts").replaceChildren(...rows);
  byId("note").textContent = told.note;
  byId("note").hidden = !told.note;
}

// What depends on the state but is no value of it.
function show(values, structure, told, toolpath) {
  const { target, layer, cell, playing, theme, clip } = values;
  const moving = target === "toolpath";
  const index = structure.arrays.index[layer];
  const height = Number(structure.arrays.z[layer].toFixed(3));
  byId("layer-text").textContent = `Layer ${index} of 0 … ${told.last}, ${height} mm`;
  byId("time-text").textContent = toolpath ? clock(values.time, toolpath.total) : "";
  byId("layer").setAttribute("aria-valuetext", `layer ${index}, ${height} mm above the bed`);
  byId("time").setAttribute("aria-valuetext", byId("time-text").textContent);
  byId("play").textContent = playing ? "❚❚" : "▶";
  byId("play").setAttribute("aria-label", playing ? "Pause" : "Play");
  byId("theme").textContent = `Colours: ${theme === "system" ? "as the system" : theme}`;
  byId("cell").value = cell < 0 ? "" : cell;
  byId("shows").textContent = told.targets.find(([name]) => name === target)[1];
  for (const [id, shown] of [
    ["form-row", target === "full"],
    ["time-row", moving],
    ["path-row", moving],
    ["clip-at", clip !== "off"],
  ]) byId(id).hidden = !shown;
}

function legend(values, structure, told, colours) {
  const strut = values.target === "full" && values.form === "struts";
  const entries = roles(values).map((role) => [
    role === "wall" && strut ? "strut" : role,
    colours[role],
  ]);
  byId("legend").replaceChildren(
    ...entries.map(([text, colour]) => {
      const item = element("li", text);
      item.style.setProperty("--swatch", colour);
      return item;
    }),
  );
  const scale = scaleOf(values, structure, told);
  byId("scale").hidden = !scale;
  if (!scale) return;
  byId("scale-name").textContent = scale.name;
  byId("scale-bar").style.background = `linear-gradient(to right, ${told.colours.ramp.join(", ")})`;
  byId("scale-low").textContent = scale.low;
  byId("scale-high").textContent = scale.high;
}

// What the three colours of the ramp stand for, where a target has them.
function scaleOf({ target, layer }, structure, told) {
  if (target === "overhang") {
    return { name: "Tilt from the vertical", low: "0°", high: `${told.steepest}°` };
  }
  if (target === "sizes") {
    const found = [...sizes(structure, layer).values()];
    const [low, high] = [Math.min(...found), Math.max(...found)];
    return { name: "Cell size", low: `${low.toFixed(1)} mm`, high: `${high.toFixed(1)} mm` };
  }
  return null;
}

function clock(seconds, total) {
  const text = (value) => {
    const minutes = Math.floor(value / 60);
    const [h, m, s] = [Math.floor(minutes / 60), minutes % 60, Math.floor(value % 60)];
    return [h, m, s].map((part) => String(part).padStart(2, "0")).join(":");
  };
  return `${text(seconds)} of ${text(total)}`;
}
