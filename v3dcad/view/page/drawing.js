// What each target draws, and in which colours.

import { chosenEdges, neighbours, outline, UPRIGHT } from "./cells.js";
import { CellFills, sizes } from "./fills.js";
import { Part } from "./part.js";
import { slopes } from "./slopes.js";
import { segments, Strokes } from "./strokes.js";
import { after, Toolpath } from "./toolpath.js";
import { tree } from "./tree.js";

const ONE_LAYER = new Set(["layer", "cell", "neighbours", "neighbour", "tree", "sizes"]);
const IN_SPACE = new Set(["full", "overhang"]);
const NOTHING = new Float32Array();
const GHOST = 0.1; // how dense walls are around a cell that was chosen

// The lowest and the highest layer that are shown.
export function shownLayers({ target, layer }) {
  return [ONE_LAYER.has(target) ? layer : 0, layer];
}

const LEGENDS = {
  full: ["wall", "contour"],
  overhang: ["contour"],
  layer: ["wall", "contour"],
  sizes: [],
  cell: ["cell"],
  neighbours: ["cell", "neighbour"],
  neighbour: ["cell", "neighbour"],
  tree: ["tree"],
  cut: ["wall", "contour"],
  toolpath: ["bead", "perimeter", "travel", "seam"],
};

// The roles that are drawn, each in the colour of the same name; context speaks for itself.
export function roles({ target, cell, travels, seams }) {
  if (IN_SPACE.has(target) && cell >= 0) return ["cell"];
  const left = new Set([...(travels ? [] : ["travel"]), ...(seams ? [] : ["seam"])]);
  if (cell < 0) left.add("cell").add("neighbour");
  return LEGENDS[target].filter((role) => !left.has(role));
}

export class Drawing {
  #cell = -1; // whose walls `solid` holds
  #heights = []; // of these

  constructor(stage, structure, told) {
    const { arrays, rise, span } = structure;
    this.stage = stage;
    this.structure = structure;
    this.colours = { ...told.colours };
    this.fills = new CellFills(structure);
    this.part = new Part(arrays.part_vertices, arrays.part_triangles);
    this.toolpath = arrays.path ? new Toolpath(arrays, rise, stage.radius / 15) : null;

    const lean = (degrees) => (255 * Math.abs(degrees - UPRIGHT)) / (told.steepest || 1);
    const shares = Uint8Array.from(arrays.wall_leans, lean);
    const walls = segments(structure.walls, { shares, slopes: structure.slopes });
    const empty = () => segments(NOTHING);
    this.strips = new Strokes(walls, { strip: span });
    this.walls = new Strokes(walls, { width: 1.3, nearer: 2e-5 });
    this.contours = new Strokes(segments(structure.contours), { width: 1.3, nearer: 2e-5 });
    const struts = segments(structure.ends("struts"));
    this.struts = new Strokes(struts, { width: 2.2 });
    this.ridges = new Strokes(struts, { width: 1, opacity: 0.35, nearer: 1e-5 });
    this.cutWalls = new Strokes(segments(arrays.cut_walls), { width: 1.6 });
    this.cutContours = new Strokes(segments(arrays.cut_contours), { width: 1.6 });
    this.solid = new Strokes(empty(), { strip: span, nearer: 1e-5 });
    this.beside = new Strokes(empty(), { width: 2.4, nearer: 6e-5 });
    this.chosen = new Strokes(empty(), { width: 3, nearer: 1e-4 });
    const strokes = [
      this.strips, this.ridges, this.walls, this.contours, this.struts, this.cutWalls, this.cutContours,
      this.solid, this.beside, this.chosen, ...(this.toolpath?.strokes ?? []),
    ];
    stage.scene.add(...strokes.map((one) => one.mesh), this.fills.mesh, this.part.object);
    if (this.toolpath) stage.scene.add(this.toolpath.nozzle);
  }

  // The colours of a theme; a seam must be seen on the perimeter that it is in.
  dress({ skin, edge, mark }) {
    this.part.paint(skin, edge);
    this.colours.seam = mark;
  }

  update(values) {
    this.part.object.visible = values.part;
    this.#drawLayers(values);
    this.#drawChosen(values);
    this.#drawFills(values);
    const cut = values.target === "cut";
    this.cutWalls.show(cut).paint(this.colours.wall);
    this.cutContours.show(cut).paint(this.colours.contour);
    this.toolpath?.update(values, this.colours);
    this.stage.ask();
  }

  // Walls as strips or lines, contours, struts: up to the layer, or of the layer alone.
  #drawLayers({ target, layer, form, cell }) {
    const { structure, colours } = this;
    const alone = ONE_LAYER.has(target);
    const strips = target === "overhang" || (target === "full" && form === "walls");
    const lines = alone || (target === "full" && form === "layers");
    const struts = target === "full" && form === "struts";
    const quiet = target !== "layer" && (alone || cell >= 0);
    const upTo = (group, last) => [0, last < 0 ? 0 : structure.rows(group, last)[1]];
    const own = (group) => // over strips and struts only the uppermost lines
      lines && !alone ? upTo(group, layer) : structure.rows(group, layer);

    this.strips.show(strips).rows(...upTo("walls", layer));
    this.strips.paint(...(target === "overhang" ? colours.ramp : [colours.wall]));
    this.strips.fade(cell >= 0 ? GHOST : 1);
    this.walls.show(strips || lines).rows(...own("walls"));
    this.walls.paint(quiet ? colours.context : colours.wall);
    this.contours.show(strips || lines || struts).rows(...own("contours"));
    this.contours.paint(quiet ? colours.context : colours.contour);
    this.struts.show(struts).rows(...upTo("struts", layer - 1));
    this.struts.paint(colours.wall);
    this.ridges.show(strips && cell < 0).rows(...upTo("struts", layer - 1)).paint("#000000");
  }

  // The cell that was chosen, in space or on the layer; its neighbours; the spanning tree.
  #drawChosen({ target, layer, cell, neighbour }) {
    const { structure, colours } = this;
    const around = (site) => (left, right) => left === site || right === site;
    if (cell !== this.#cell) {
      const all = cell < 0 ? [] : Array.from({ length: structure.layers }, (_, k) => k);
      const ends = outline(structure, all, around(cell));
      const own = (layer) => slopes(structure, layer, chosenEdges(structure, layer, around(cell)));
      this.solid.replace(segments(ends, { slopes: all.flatMap(own) }));
      this.#heights = Array.from({ length: ends.length / 6 }, (_, k) => ends[6 * k + 2]);
      this.#cell = cell;
    }
    const end = after(this.#heights, structure.arrays.z[layer]);
    this.solid.show(IN_SPACE.has(target)).rows(0, end).paint(colours.cell);

    const chosen = cell < 0 ? NOTHING : outline(structure, [layer], around(cell));
    const beside = new Set(target === "neighbour" ? [neighbour] : []);
    if (target === "neighbours") neighbours(structure, layer, cell).forEach((one) => beside.add(one));
    const near = (left, right) => beside.has(left) || beside.has(right);
    const branches = target === "tree" ? tree(structure, layer) : chosen;
    this.chosen.replace(segments(branches)).show(target !== "toolpath" && target !== "cut");
    this.chosen.paint(target === "tree" ? colours.tree : colours.cell);
    this.beside.replace(segments(beside.size ? outline(structure, [layer], near) : NOTHING));
    this.beside.paint(colours.neighbour);
  }

  // Areas: all cells by their size, or the chosen one and those beside it.
  #drawFills({ target, layer, cell, neighbour }) {
    const { structure, colours } = this;
    if (target === "sizes") {
      const found = sizes(structure, layer);
      const scale = colourScale(found.values(), colours.ramp);
      this.fills.fill(layer, (site) => scale(found.get(site)), 0.85);
    } else if (ONE_LAYER.has(target) && cell >= 0) {
      const beside = target === "neighbours" ? neighbours(structure, layer, cell) : [neighbour];
      const near = new Set(target.startsWith("neighbour") ? beside : []);
      const colour = (site) =>
        site === cell ? rgb(colours.cell) : near.has(site) ? rgb(colours.neighbour) : null;
      this.fills.fill(layer, colour, 0.25);
    } else {
      this.fills.mesh.visible = false;
    }
  }
}

// A function from values to colours [r, g, b]: the least, the middle and the greatest of `values`
// have the three colours of the ramp, others mix between.
function colourScale(values, ramp) {
  const all = [...values];
  const low = Math.min(...all);
  const high = Math.max(...all);
  const stops = ramp.map(rgb);
  return (value) => {
    const way = (2 * (value - low)) / (high - low || 1);
    const first = Math.min(Math.floor(way), 1);
    return stops[first].map((part, k) => part + (stops[first + 1][k] - part) * (way - first));
  };
}

function rgb(colour) {
  return [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16) / 255);
}
