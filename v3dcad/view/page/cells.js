// The cells of one layer: which one holds a point, its area, its neighbours, its outline.

export const UPRIGHT = 90; // the number that stands for what does not lean: degrees are added to it

// The site whose cell holds the point (x, y), or −1 where the layer has none there. The first edge
// that a ray in the direction of x crosses knows the cells on its two sides.
export function cellAt(structure, layer, x, y) {
  let nearest = Infinity;
  let found = -1;
  for (const edge of edges(structure, layer)) {
    const [ax, ay, bx, by] = edge.ends;
    if (ay < y === by < y) continue;
    const crossing = ax + ((y - ay) / (by - ay)) * (bx - ax);
    if (crossing < x || crossing >= nearest) continue;
    nearest = crossing;
    found = by > ay ? edge.left : edge.right; // a ray to the right comes from the left of what rises
  }
  return found;
}

// Every edge of a layer: its corners and where they are, the sites left and right of it (none is −1), and
// how far a wall leans to the left, degrees.
export function* edges(structure, layer) {
  const { arrays, places } = structure;
  const base = arrays.vertices_from[layer];
  for (const [group, sites] of [["walls", 2], ["contours", 1]]) {
    const pairs = arrays[group];
    const owners = sites === 2 ? arrays.wall_sites : arrays.contour_sites;
    const [first, end] = structure.rows(group, layer);
    for (let row = first; row < end; row++) {
      const a = 2 * (base + pairs[2 * row]);
      const b = 2 * (base + pairs[2 * row + 1]);
      yield {
        corners: [pairs[2 * row], pairs[2 * row + 1]],
        ends: [places[a], places[a + 1], places[b], places[b + 1]],
        left: sites === 2 ? owners[2 * row + 1] : owners[row],
        right: sites === 2 ? owners[2 * row] : -1,
        lean: sites === 2 ? arrays.wall_leans[row] - UPRIGHT : null,
      };
    }
  }
}

// The area of every cell of a layer, mm², by site: Green's theorem over the edges.
export function areas(structure, layer) {
  const found = new Map();
  const add = (site, area) => found.set(site, (found.get(site) ?? 0) + area);
  const [ox, oy] = structure.bounds[0];
  for (const { ends, left, right } of edges(structure, layer)) {
    const [ax, ay, bx, by] = ends;
    const swept = ((ax - ox) * (by - oy) - (bx - ox) * (ay - oy)) / 2;
    add(left, swept);
    if (right >= 0) add(right, -swept);
  }
  return found;
}

// The sites that share a wall with a site on a layer, ascending.
export function neighbours(structure, layer, site) {
  const found = new Set();
  for (const { left, right } of edges(structure, layer)) {
    if (left === right || right < 0) continue;
    if (left === site) found.add(right);
    if (right === site) found.add(left);
  }
  return [...found].sort((a, b) => a - b);
}

// The edges of a layer that `chosen` chooses by their left and right site.
export function chosenEdges(structure, layer, chosen) {
  return [...edges(structure, layer)].filter(({ left, right }) => chosen(left, right));
}

// The edges of layers that are chosen so, as x, y, z of both ends.
export function outline(structure, layers, chosen) {
  const found = [];
  for (const layer of layers) {
    const z = structure.arrays.z[layer];
    for (const { ends } of chosenEdges(structure, layer, chosen)) {
      found.push(ends[0], ends[1], z, ends[2], ends[3], z);
    }
  }
  return new Float32Array(found);
}

// The rings of every cell of a layer, by site: each a list of [x, y], the cell on its left.
export function rings(structure, layer) {
  const following = new Map(); // by site: from each corner to the next ones
  const step = (site, from, to) => {
    if (!following.has(site)) following.set(site, new Map());
    const ways = following.get(site);
    const key = from.join();
    if (!ways.has(key)) ways.set(key, []);
    ways.get(key).push(to);
  };
  for (const { ends, left, right } of edges(structure, layer)) {
    const [a, b] = [ends.slice(0, 2), ends.slice(2)];
    step(left, a, b);
    if (right >= 0) step(right, b, a);
  }
  const found = new Map();
  for (const [site, ways] of following) found.set(site, walked(ways));
  return found;
}

function walked(ways) {
  const found = [];
  for (const nexts of ways.values()) {
    while (nexts.length) {
      const ring = [];
      let next = nexts.pop();
      while (next) {
        ring.push(next);
        next = ways.get(next.join())?.pop();
      }
      found.push(ring);
    }
  }
  return found;
}

// Where the site of a cell of a layer stands: [x, y], mm.
export function sitePlace(structure, layer, site) {
  const { cells, cell_places: places } = structure.arrays;
  const [first, end] = structure.rows("cells", layer);
  const row = cells.subarray(first, end).indexOf(site);
  return row < 0 ? null : [places[2 * (first + row)], places[2 * (first + row) + 1]];
}
