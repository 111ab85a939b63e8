// How edges go on above and below their section: how far a wall leans, and how far its two ends move
// along it. So strips meet those of the layers around them, and end at the part's sides, however
// these slope. Speeds are mm to the side for each mm of height.

import { edges, UPRIGHT } from "./cells.js";

const FASTEST = 65; // degrees from the vertical: an end that moves faster soon meets something else
const FLAT = 1e-3; // the least determinant: where walls are nearly parallel, it could be anything

// Of what stands upright, with ends that do, too.
export const STANDING = packed(0, 0, 0);

// Degrees of the lean to the left, and of each end along the edge, as one whole number that a float
// holds.
function packed(lean, start, stop) {
  return lean + UPRIGHT + 256 * (start + UPRIGHT) + 65536 * (stop + UPRIGHT);
}

// The slopes of all walls, packed, in the order of their rows.
export function wallSlopes(structure) {
  const found = new Float32Array(structure.arrays.wall_leans.length);
  for (let layer = 0; layer < structure.layers; layer++) {
    const all = [...edges(structure, layer)];
    const walls = all.filter(({ right }) => right >= 0);
    const ends = new Set(walls.flatMap(({ corners }) => corners));
    const sides = all.filter(({ right, corners }) => right < 0 && corners.some((k) => ends.has(k)));
    const [first] = structure.rows("walls", layer);
    found.set(slopes(structure, layer, [...walls, ...sides]).slice(0, walls.length), first);
  }
  return found;
}

// The slopes of edges of a layer, packed. A corner stays on all of them that meet in it.
export function slopes(structure, layer, chosen) {
  const moving = chosen.map((edge) => motion(structure, layer, edge));
  const speeds = cornerSpeeds(moving);
  return moving.map(({ corners, along: [ux, uy], leftward }) => {
    const ends = corners.map((corner) => {
      const [x, y] = speeds.get(corner);
      return x * ux + y * uy;
    });
    return packed(degrees(leftward), ...ends.map((speed) => limited(degrees(speed))));
  });
}

// An edge's corners and direction, and how fast it moves to its left: a wall by its lean, a contour as
// the part's side does.
function motion(structure, layer, { corners, ends: [ax, ay, bx, by], lean }) {
  const length = Math.hypot(bx - ax, by - ay) || 1;
  const along = [(bx - ax) / length, (by - ay) / length];
  const left = [-along[1], along[0]];
  const leftward =
    lean === null
      ? sideSpeed(structure, layer, [(ax + bx) / 2, (ay + by) / 2], left)
      : Math.tan((lean * Math.PI) / 180);
  return { corners, along, leftward };
}

// How fast corners move, [x, y]; where the edges that meet there do not say it exactly, least squares do.
function cornerSpeeds(moving) {
  const sums = new Map();
  for (const { corners, along: [ux, uy], leftward } of moving) {
    for (const corner of corners) {
      if (!sums.has(corner)) sums.set(corner, [0, 0, 0, 0, 0]);
      const sum = sums.get(corner);
      sum[0] += uy * uy;
      sum[1] -= uy * ux;
      sum[2] += ux * ux;
      sum[3] -= uy * leftward;
      sum[4] += ux * leftward;
    }
  }
  const found = new Map();
  for (const [corner, [xx, xy, yy, right, forth]] of sums) {
    const size = Math.max(xx * yy - xy * xy, FLAT);
    found.set(corner, [(yy * right - xy * forth) / size, (xx * forth - xy * right) / size]);
  }
  return found;
}

// How fast the part's side moves in a direction, at a point of a layer's contour, as far as the layers
// above and below tell.
function sideSpeed(structure, layer, place, direction) {
  const { z } = structure.arrays;
  const [above, below] = [layer + 1, layer - 1].map((other) => {
    if (other < 0 || other >= structure.layers) return NaN;
    return crossing(structure, other, place, direction) / (z[other] - z[layer]);
  });
  return slower(above, below);
}

// How far from a point a line through it meets a layer's contours, at the nearest place, mm.
function crossing(structure, layer, [x, y], [ux, uy]) {
  const { contours } = structure;
  const [first, end] = structure.rows("contours", layer);
  let nearest = NaN;
  for (let at = 6 * first; at < 6 * end; at += 6) {
    const [ax, ay] = [contours[at] - x, contours[at + 1] - y];
    const [bx, by] = [contours[at + 3] - x, contours[at + 4] - y];
    const [one, other] = [ux * ay - uy * ax, ux * by - uy * bx]; // to the left of the line
    if (one < 0 === other < 0) continue;
    const share = one / (one - other);
    const way = ux * (ax + share * (bx - ax)) + uy * (ay + share * (by - ay));
    if (!(Math.abs(way) >= Math.abs(nearest))) nearest = way;
  }
  return nearest;
}

// The slower of two speeds; of what goes to two sides, none. What is not known has no say. (The
// "minmod" limiter: nothing reaches farther than both layers around it allow.)
function slower(one, other) {
  if (Number.isNaN(one) || Number.isNaN(other)) return one || other || 0;
  if (one * other <= 0) return 0;
  return Math.abs(one) < Math.abs(other) ? one : other;
}

function degrees(speed) {
  return Math.round((Math.atan(speed) * 180) / Math.PI);
}

function limited(degrees) {
  return Math.min(Math.max(degrees, -FASTEST), FASTEST);
}
