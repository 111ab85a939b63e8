// The layers as they were unpacked: see segments.py for what each array holds.

import { wallSlopes } from "./slopes.js";

const GREATEST = 65535; // what the far end of the part is, in fractions

export class Structure {
  // `bounds`: the part's least and greatest x, y, z; `span`: from where to where a layer's walls
  // reach, mm above its section.
  constructor(arrays, bounds, span) {
    this.arrays = arrays;
    this.bounds = bounds;
    this.span = span;
    this.rise = span[1] - span[0]; // from one layer to the next
    this.layers = arrays.z.length;
    this.places = scaled(arrays.vertices, bounds);
    this.walls = this.ends("walls");
    this.contours = this.ends("contours");
    this.slopes = wallSlopes(this);
  }

  // The rows of a group of arrays that belong to a layer: [first, end).
  rows(group, layer) {
    const from = this.arrays[`${group}_from`];
    return [from[layer], from[layer + 1]];
  }

  // Walls, contours or struts as x, y, z of both ends, all layers in order.
  ends(group) {
    const pairs = this.arrays[group];
    const above = group === "struts" ? 1 : 0;
    const found = new Float32Array(pairs.length * 3);
    let at = 0;
    for (let layer = 0; layer < this.layers; layer++) {
      const [first, end] = this.rows(group, layer);
      for (let row = first; row < end; row++) {
        at = this.#put(found, at, layer, pairs[2 * row]);
        at = this.#put(found, at, layer + above, pairs[2 * row + 1]);
      }
    }
    return found;
  }

  #put(found, at, layer, vertex) {
    const place = 2 * (this.arrays.vertices_from[layer] + vertex);
    found[at] = this.places[place];
    found[at + 1] = this.places[place + 1];
    found[at + 2] = this.arrays.z[layer];
    return at + 3;
  }
}

// Fractions of a box, x and y in turn, as millimetres.
function scaled(fractions, [low, high]) {
  const found = new Float32Array(fractions.length);
  for (let k = 0; k < found.length; k++) {
    const axis = k % 2;
    found[k] = low[axis] + ((high[axis] - low[axis]) * fractions[k]) / GREATEST;
  }
  return found;
}
