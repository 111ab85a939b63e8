// Cells of one layer as coloured areas: all of them by size, or the one that was chosen.

import * as THREE from "three";
import { areas, rings } from "./cells.js";
import { shared } from "./strokes.js";

const vertexShader = `
  in vec3 tint;
  out vec3 place, own;
  void main() {
    place = position;
    own = tint;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  }`;

const fragmentShader = `
  uniform vec4 plane;
  uniform float opacity;
  in vec3 place, own;
  out vec4 colour;
  void main() {
    if (dot(place, plane.xyz) > plane.w) discard;
    colour = vec4(own, opacity);
  }`;

export class CellFills {
  constructor(structure) {
    this.structure = structure;
    this.opacity = { value: 0.8 };
    const material = new THREE.ShaderMaterial({
      glslVersion: THREE.GLSL3,
      uniforms: { plane: shared.plane, opacity: this.opacity },
      vertexShader,
      fragmentShader,
      side: THREE.DoubleSide,
      transparent: true,
      depthWrite: false,
    });
    this.mesh = new THREE.Mesh(new THREE.BufferGeometry(), material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 1;
  }

  // Every cell of a layer in the colour that `colourOf` gives its site; null leaves it empty.
  fill(layer, colourOf, opacity) {
    const places = [];
    const tints = [];
    for (const [site, found] of rings(this.structure, layer)) {
      const colour = colourOf(site);
      if (!colour) continue;
      for (const [x, y] of triangles(found)) {
        places.push(x, y, this.structure.arrays.z[layer]);
        tints.push(...colour);
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(places, 3));
    geometry.setAttribute("tint", new THREE.Float32BufferAttribute(tints, 3));
    this.mesh.geometry.dispose();
    this.mesh.geometry = geometry;
    this.mesh.visible = places.length > 0;
    this.opacity.value = opacity;
  }
}

// The size of every cell of a layer, mm, by site: the side of a square of the same area.
export function sizes(structure, layer) {
  const found = [...areas(structure, layer)];
  return new Map(found.map(([site, area]) => [site, Math.sqrt(Math.max(area, 0))]));
}

// Corners of triangles that fill rings: outer ones run counter-clockwise, holes clockwise.
function triangles(rings) {
  const points = rings.map((ring) => ring.map(([x, y]) => new THREE.Vector2(x, y)));
  const outer = points.filter((ring) => THREE.ShapeUtils.area(ring) > 0);
  const holes = points.filter((ring) => THREE.ShapeUtils.area(ring) < 0);
  const found = [];
  for (const ring of outer) {
    const own = outer.length > 1 ? holes.filter(([point]) => holds(ring, point)) : holes;
    const corners = [ring, ...own].flat();
    for (const face of THREE.ShapeUtils.triangulateShape(ring, own)) {
      for (const corner of face) found.push([corners[corner].x, corners[corner].y]);
    }
  }
  return found;
}

function holds(ring, { x, y }) {
  let inside = false;
  ring.forEach((b, k) => {
    const a = ring.at(k - 1);
    if (a.y < y === b.y < y) return;
    if (a.x + ((y - a.y) / (b.y - a.y)) * (b.x - a.x) > x) inside = !inside;
  });
  return inside;
}
