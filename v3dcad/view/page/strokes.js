// Many segments in one draw call: each is a rectangle, either a line some pixels wide, or a strip as
// high as a layer, which slopes as the wall does that it is a piece of. Segments lie in order of
// height, so that those of some layers can be drawn.

import * as THREE from "three";
import { STANDING } from "./slopes.js";

// What all strokes share; `stage.js` keeps it up to date.
export const shared = {
  pixels: { value: new THREE.Vector2(1, 1) }, // the canvas
  plane: { value: new THREE.Vector4(0, 0, 0, 1) }, // x · normal > w is cut away
  background: { value: new THREE.Color() },
  depths: { value: new THREE.Vector2(0, 1) }, // where the haze begins and ends, mm from the eye
  every: { value: 1 }, // only each so many segments are drawn, while the eye moves and frames are slow
};

const LINE = `
  vec4 from = projectionMatrix * modelViewMatrix * vec4(start, 1.0);
  vec4 to = projectionMatrix * modelViewMatrix * vec4(stop, 1.0);
  if (from.w < 0.01 || to.w < 0.01) { gl_Position = NOWHERE; return; }
  vec2 along = (to.xy / to.w - from.xy / from.w) * pixels;
  along = along / max(length(along), 1e-6);
  vec4 end = corner.x < 0.5 ? from : to;
  vec2 aside = vec2(-along.y, along.x) * corner.y + along * (corner.x * 2.0 - 1.0) * 0.4;
  place = corner.x < 0.5 ? start : stop;
  gl_Position = end + vec4(aside * width / pixels * end.w, -nearer * end.w, 0.0);
  light = 1.0;`;

const STRIP = `
  float rise = corner.y > 0.0 ? span.y : span.x;
  vec2 along = normalize(stop.xy - start.xy + vec2(1e-9, 0.0));
  vec3 slope = tan(radians(floor(mod(slopes / vec3(1.0, 256.0, 65536.0), 256.0)) - 90.0));
  vec3 upward = vec3(vec2(-along.y, along.x) * slope.x, 1.0);
  vec2 reach = vec2(0.0, distance(start.xy, stop.xy)) + slope.yz * rise;
  reach = reach.x < reach.y ? reach : vec2((reach.x + reach.y) / 2.0); // it has shrunk to nothing
  place = start + vec3(along * (corner.x < 0.5 ? reach.x : reach.y), 0.0) + upward * rise;
  vec4 seen = modelViewMatrix * vec4(place, 1.0);
  vec3 normal = normalize(mat3(modelViewMatrix) * cross(vec3(along, 0.0), upward));
  light = 0.45 + 0.55 * abs(dot(normal, normalize(seen.xyz)));
  gl_Position = projectionMatrix * seen;
  gl_Position.z -= nearer * gl_Position.w;`;

const vertexShader = (body) => `
  uniform highp sampler2D ends;
  uniform vec2 pixels, depths, span;
  uniform float width, nearer;
  uniform int every;
  out vec3 place;
  out float light, way, haze;
  const vec4 NOWHERE = vec4(2.0, 2.0, 2.0, 1.0);
  const vec2 CORNERS[6] = vec2[](
    vec2(0, -1), vec2(1, -1), vec2(1, 1), vec2(0, -1), vec2(1, 1), vec2(0, 1));
  void main() {
    vec2 corner = CORNERS[gl_VertexID % 6];
    int at = gl_VertexID / 6 * every * 2, wide = textureSize(ends, 0).x;
    vec4 first = texelFetch(ends, ivec2(at % wide, at / wide), 0);
    vec4 second = texelFetch(ends, ivec2(at % wide + 1, at / wide), 0);
    vec3 start = first.xyz, stop = second.xyz;
    float slopes = second.w;
    way = first.w;
    ${body}
    haze = smoothstep(depths.x, depths.y, gl_Position.w);
  }`;

const fragmentShader = `
  uniform vec3 colours[3];
  uniform vec3 background;
  uniform vec4 plane;
  uniform float opacity;
  in vec3 place;
  in float light, way, haze;
  out vec4 colour;
  void main() {
    if (dot(place, plane.xyz) > plane.w) discard;
    vec3 own = way < 0.5 ? mix(colours[0], colours[1], way * 2.0)
                         : mix(colours[1], colours[2], way * 2.0 - 1.0);
    colour = vec4(mix(own * light, background, haze * 0.6), opacity);
  }`;

const WIDEST = 1024; // segments in a row of a texture

// `ends`: x, y, z of start and stop, one after the other; `shares`: 0 … 255, the way through the
// three colours; `slopes`: of strips, as slopes.js packs them.
// They lie in a texture, two texels each: cards and software draw loose triangles that look their
// corners up there faster than instances of a rectangle.
export function segments(ends, { shares, slopes } = {}) {
  const count = ends.length / 6;
  const wide = Math.min(Math.max(count, 1), WIDEST);
  const data = new Float32Array(8 * wide * Math.max(Math.ceil(count / wide), 1));
  for (let k = 0; k < count; k++) {
    data.set(ends.subarray(6 * k, 6 * k + 3), 8 * k);
    data.set(ends.subarray(6 * k + 3, 6 * k + 6), 8 * k + 4);
    data[8 * k + 3] = (shares?.[k] ?? 0) / 255;
    data[8 * k + 7] = slopes?.[k] ?? STANDING;
  }
  const high = data.length / 8 / wide;
  const texture = new THREE.DataTexture(data, 2 * wide, high, THREE.RGBAFormat, THREE.FloatType);
  texture.needsUpdate = true;
  return { texture, count };
}

export class Strokes {
  #shown = true;
  #rows = [0, 0];

  // Lines of a width in pixels; or strips, if `strip` says from where to where above (or below) the
  // segments they reach, mm.
  constructor(found, { strip = null, width = 1, opacity = 1, nearer = 0 } = {}) {
    this.uniforms = {
      ...shared,
      ends: { value: null },
      colours: { value: [new THREE.Color(), new THREE.Color(), new THREE.Color()] },
      width: { value: width },
      span: { value: new THREE.Vector2(...(strip ?? [0, 0])) },
      opacity: { value: opacity },
      nearer: { value: nearer },
    };
    const material = new THREE.ShaderMaterial({
      glslVersion: THREE.GLSL3,
      uniforms: this.uniforms,
      vertexShader: vertexShader(strip ? STRIP : LINE),
      fragmentShader,
      side: THREE.DoubleSide,
      forceSinglePass: true,
    });
    this.mesh = new THREE.Mesh(new THREE.BufferGeometry(), material);
    this.mesh.frustumCulled = false; // its places are known to the graphics card only
    this.mesh.onBeforeRender = () => {
      const [first, end] = this.#rows.map((row) => Math.ceil(row / shared.every.value));
      this.mesh.geometry.setDrawRange(6 * first, 6 * (end - first));
    };
    this.replace(found).fade(opacity);
  }

  // How dense it is: 1 hides what lies behind.
  fade(opacity) {
    this.uniforms.opacity.value = opacity;
    this.mesh.material.transparent = opacity < 1;
    this.mesh.material.depthWrite = opacity === 1;
    return this;
  }

  // One colour, or three: of the least, the middle and the greatest share.
  paint(...colours) {
    this.uniforms.colours.value.forEach((own, k) => own.set(colours[k] ?? colours[0]));
    return this;
  }

  // Draw only some of the segments, from `first` to before `end`; the others cost nothing.
  rows(first, end) {
    this.#rows = [first, end];
    return this.show(this.#shown);
  }

  show(shown) {
    this.#shown = shown;
    this.mesh.visible = shown && this.#rows[1] > this.#rows[0]; // else it needs no draw call
    return this;
  }

  // Draw other segments from now on, all of them.
  replace({ texture, count }) {
    this.uniforms.ends.value?.dispose();
    this.uniforms.ends.value = texture;
    return this.rows(0, count);
  }
}
