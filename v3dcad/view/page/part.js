// The part as a translucent skin: clear where it faces the eye, denser where it turns away.

import * as THREE from "three";
import { segments, shared, Strokes } from "./strokes.js";

const vertexShader = `
  out vec3 place, seen;
  void main() {
    place = position;
    vec4 view = modelViewMatrix * vec4(position, 1.0);
    seen = view.xyz;
    gl_Position = projectionMatrix * view;
  }`;

const fragmentShader = `
  uniform vec3 skin;
  uniform vec4 plane;
  in vec3 place, seen;
  out vec4 colour;
  void main() {
    if (dot(place, plane.xyz) > plane.w) discard;
    vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
    float facing = abs(dot(normal, normalize(seen)));
    colour = vec4(skin, mix(0.34, 0.05, smoothstep(0.0, 0.9, facing)));
  }`;

const SHARP = 25; // degrees: edges between triangles that bend more are drawn
const MOST_TRIANGLES = 60000; // more take too long to look for edges

export class Part {
  constructor(vertices, triangles) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(vertices, 3));
    geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
    this.skin = { value: new THREE.Color() };
    const material = new THREE.ShaderMaterial({
      glslVersion: THREE.GLSL3,
      uniforms: { plane: shared.plane, skin: this.skin },
      vertexShader,
      fragmentShader,
      side: THREE.DoubleSide,
      transparent: true,
      depthWrite: false,
    });
    const skin = new THREE.Mesh(geometry, material);
    skin.renderOrder = 2;
    const few = triangles.length / 3 <= MOST_TRIANGLES;
    const sharp = few ? new THREE.EdgesGeometry(geometry, SHARP).attributes.position.array : [];
    this.edges = new Strokes(segments(new Float32Array(sharp)), { width: 1.2, opacity: 0.55 });
    this.object = new THREE.Group().add(skin, this.edges.mesh);
  }

  paint(skin, edge) {
    this.skin.value.set(skin);
    this.edges.paint(edge);
  }
}
