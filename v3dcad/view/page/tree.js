// The minimum spanning tree of a layer's sites.

// Its branches as x, y, z of both ends.
export function tree(structure, layer) {
  const { trees, cell_places: places, z } = structure.arrays;
  const [cells] = structure.rows("cells", layer);
  const [first, end] = structure.rows("trees", layer);
  const found = [];
  for (let k = 2 * first; k < 2 * end; k++) {
    const place = 2 * (cells + trees[k]);
    found.push(places[place], places[place + 1], z[layer]);
  }
  return new Float32Array(found);
}
