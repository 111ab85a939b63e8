// The cell under a point of the canvas: the first that the eye's ray meets in the shown layers.

import { cellAt } from "./cells.js";

// `layers`: [lowest, highest] that are shown; `cut(point)` says what the clipping plane took away.
// Gives { cell, layer }, or null where the ray meets none.
export function pick(structure, ray, [lowest, highest], cut) {
  const { z } = structure.arrays;
  if (Math.abs(ray.direction.z) < 1e-9) return null;
  const down = ray.direction.z < 0;
  for (let k = lowest; k <= highest; k++) {
    const layer = down ? lowest + highest - k : k;
    const way = (z[layer] - ray.origin.z) / ray.direction.z;
    if (way < 0) continue;
    const point = ray.at(way, ray.origin.clone());
    if (cut(point)) continue;
    const cell = cellAt(structure, layer, point.x, point.y);
    if (cell >= 0) return { cell, layer };
  }
  return null;
}
