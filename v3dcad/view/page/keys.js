// The keyboard: what each key does, and the list of them for the help.

const TURN = 8; // degrees at each press
const NEARER = 0.88; // of the distance at each press

// Rows of keys, what they do as text, and what they do.
export function bindings({ state, stage, moveLayer, play }) {
  const flip = (name) => () => state.set({ [name]: !state.values[name] });
  return [
    ["↑ ↓", "layer up, down", { ArrowUp: () => moveLayer(1), ArrowDown: () => moveLayer(-1) }],
    ["Page", "ten layers", { PageUp: () => moveLayer(10), PageDown: () => moveLayer(-10) }],
    ["Home End", "first, last layer", {
      Home: () => moveLayer(-Infinity),
      End: () => moveLayer(Infinity),
    }],
    ["Space", "play, pause", { " ": play }],
    ["← →", "turn", { ArrowLeft: () => stage.turn(-TURN, 0), ArrowRight: () => stage.turn(TURN, 0) }],
    ["W S", "tilt", { w: () => stage.turn(0, TURN), s: () => stage.turn(0, -TURN) }],
    ["+ −", "nearer, farther", {
      "+": () => stage.zoom(NEARER),
      "=": () => stage.zoom(NEARER),
      "-": () => stage.zoom(1 / NEARER),
    }],
    ["R", "the whole part again", { r: () => stage.home() }],
    ["P", "the part's skin", { p: flip("part") }],
    ["C", "clipping plane", {
      c: () => state.set({ clip: state.values.clip === "off" ? "y" : "off" }),
    }],
    ["Esc", "no cell chosen", { Escape: () => state.set({ cell: -1, neighbour: -1 }) }],
  ];
}

// Listen to the keys, but for those that a control takes for itself.
export function listen(rows) {
  const actions = Object.assign({}, ...rows.map(([, , keys]) => keys));
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const control = event.target.closest("input, select, button, summary");
    if (control && event.key !== "Escape") return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (!actions[key]) return;
    event.preventDefault();
    actions[key]();
  });
}
