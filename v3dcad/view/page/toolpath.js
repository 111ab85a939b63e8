// The nozzle's way up to a moment: beads, travels, the points where perimeters begin.

import * as THREE from "three";
import { segments, Strokes } from "./strokes.js";

const [UNSEEN, TRAVEL, PERIMETER, SEAM] = [0, 1, 3, 4]; // what motion.py calls a way
const GREATEST = 65535; // what the far end of the box is, in fractions
const TICKS = 1000; // in a second

export class Toolpath {
  // `rise`: mm from one shown layer to the next; `size`: of the nozzle that is drawn, mm.
  constructor(arrays, rise, size) {
    const { path, path_box: box, path_roles: roles, path_ticks: ticks, path_from: from } = arrays;
    this.points = placed(path, box);
    this.from = from;
    this.seconds = summed(ticks);
    this.total = this.seconds.at(-1);
    const ways = [...roles.keys()].filter((k) => roles[k] !== UNSEEN);
    this.beads = ways.filter((k) => roles[k] > TRAVEL);
    this.travels = ways.filter((k) => roles[k] === TRAVEL && moves(this.points, k));
    this.seams = ways.filter((k) => roles[k] === SEAM);
    const shares = Uint8Array.from(this.beads, (k) => (roles[k] >= PERIMETER ? 255 : 0));
    const beads = segments(gathered(this.points, this.beads), { shares });
    const travels = segments(gathered(this.points, this.travels));
    const seams = segments(upright(this.points, this.seams, rise));
    this.sides = new Strokes(beads, { strip: [-rise, 0] });
    this.tops = new Strokes(beads, { width: 2, nearer: 2e-5 }); // of the layer being printed
    this.ways = new Strokes(travels, { width: 1, opacity: 0.6, nearer: 2e-5 });
    this.marks = new Strokes(seams, { width: 6, nearer: 6e-5 });
    this.strokes = [this.sides, this.tops, this.ways, this.marks];
    this.nozzle = nozzle(size);
  }

  update({ target, time, travels, seams }, colours) {
    const shown = target === "toolpath";
    const reached = Math.max(after(this.seconds, time), 1) - 1; // the last point that was reached
    const at = this.points.subarray(3 * reached, 3 * reached + 3);
    const beads = after(this.beads, reached);
    const layer = this.layerAt(time);
    const below = Math.min(after(this.beads, this.from[layer]), beads);
    const paint = [colours.bead, colours.bead, colours.perimeter];
    this.sides.show(shown).rows(0, beads).paint(...paint);
    this.tops.show(shown).rows(below, beads).paint(...paint);
    this.ways.show(shown && travels).rows(0, after(this.travels, reached)).paint(colours.travel);
    this.marks.show(shown && seams).rows(0, after(this.seams, reached)).paint(colours.seam);
    this.nozzle.visible = shown && time < this.total;
    this.nozzle.position.set(...at);
    this.nozzle.material.color.set(colours.travel);
  }

  // When a layer is done, seconds.
  done(layer) {
    return this.seconds[this.from[layer + 1] - 1];
  }

  // The layer that is printed at a moment.
  layerAt(time) {
    const point = Math.min(after(this.seconds, time), this.seconds.length) - 1;
    return Math.min(Math.max(after(this.from, point) - 1, 0), this.from.length - 2);
  }
}

// A cone whose tip is where the nozzle is.
function nozzle(size) {
  const cone = new THREE.ConeGeometry(size * 0.4, size, 24);
  cone.rotateX(-Math.PI / 2).translate(0, 0, size / 2);
  return new THREE.Mesh(cone, new THREE.MeshBasicMaterial());
}

// How many of ascending numbers are at most `limit`.
export function after(numbers, limit) {
  let [low, high] = [0, numbers.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (numbers[middle] <= limit) low = middle + 1;
    else high = middle;
  }
  return low;
}

function summed(ticks) {
  const found = new Float64Array(ticks.length);
  let sum = 0;
  for (let k = 0; k < ticks.length; k++) found[k] = (sum += ticks[k]) / TICKS;
  return found;
}

function placed(path, box) {
  const found = new Float32Array(path.length);
  for (let k = 0; k < path.length; k++) {
    const axis = k % 3;
    found[k] = box[axis] + ((box[3 + axis] - box[axis]) * path[k]) / GREATEST;
  }
  return found;
}

function moves(points, k) {
  return [0, 1, 2].some((axis) => points[3 * k + axis] !== points[3 * k - 3 + axis]);
}

// The ways to points `steps`, as x, y, z of both ends.
function gathered(points, steps) {
  const found = new Float32Array(steps.length * 6);
  steps.forEach((k, row) => found.set(points.subarray(3 * k - 3, 3 * k + 3), 6 * row));
  return found;
}

// A short upright mark where each way begins.
function upright(points, steps, height) {
  const found = new Float32Array(steps.length * 6);
  steps.forEach((k, row) => {
    const [x, y, z] = points.subarray(3 * k - 3, 3 * k);
    found.set([x, y, z, x, y, z + height], 6 * row);
  });
  return found;
}
