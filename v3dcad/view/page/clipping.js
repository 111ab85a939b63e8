// The clipping plane: upright or level, anywhere in the part, either side of it taken away.

import { shared } from "./strokes.js";

const AXES = { x: 0, y: 1, z: 2 };

// Put the plane where the state wants it. `at` is the per cent of the part that is kept.
export function clip({ clip: axis, at, flip }, [low, high]) {
  const plane = shared.plane.value;
  if (axis === "off") {
    plane.set(0, 0, 0, 1);
    return;
  }
  const k = AXES[axis];
  const sign = axis === "y" ? -1 : 1; // of y, what is nearer to the eye goes first
  const turn = flip ? -sign : sign;
  const margin = (high[k] - low[k]) * 1e-3; // all of it stays at 100 %
  const from = turn > 0 ? low[k] - margin : high[k] + margin;
  const place = from + (turn * (high[k] - low[k] + 2 * margin) * at) / 100;
  plane.set(0, 0, 0, turn * place).setComponent(k, turn);
}

// Whether the plane takes a point away.
export function isCut({ x, y, z }) {
  const plane = shared.plane.value;
  return x * plane.x + y * plane.y + z * plane.z > plane.w;
}
