// Play: the layers one after the other, or the print as time goes by.

const LAYERS_TAKE = 8; // seconds for all layers
const PRINT_TAKES = 40; // seconds for the whole print

// Play while the state says so; from the start again where it is at the end.
export function player(state, structure, toolpath) {
  let before = 0;
  let place = 0; // where it is, with the fraction of a layer that the state does not hold

  const course = () =>
    state.values.target === "toolpath"
      ? { name: "time", end: toolpath.total, takes: PRINT_TAKES }
      : { name: "layer", end: structure.layers - 1, takes: LAYERS_TAKE };

  function frame(now) {
    if (!state.values.playing) return;
    const { name, end, takes } = course();
    const value = state.values[name];
    if (Math.abs(place - value) >= 1) place = value; // somebody moved the slider
    place = Math.min(place + (end * (now - before)) / 1000 / takes, end);
    before = now;
    const next = name === "layer" ? Math.floor(place) : place;
    state.set({ [name]: next, playing: place < end });
    requestAnimationFrame(frame);
  }

  state.watch(({ playing }, changed) => {
    if (!playing || !changed.has("playing")) return;
    const { name, end } = course();
    place = state.values[name] >= end ? 0 : state.values[name];
    state.set({ [name]: Math.floor(place) });
    before = performance.now();
    requestAnimationFrame(frame);
  });
}
