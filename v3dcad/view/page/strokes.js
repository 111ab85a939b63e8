// Many segments in one draw call: each is a rectangle, either a line some pixels wide, or a strip as
// high as a layer, which leans as the wall does that it is a piece of. Segments lie in order of
// height, so that the first so many can be drawn.

import * as THREE from "three";

// What all strokes share; `stage.js` keeps it up to date.
export const shared = {
  pixels: { value: new THREE.Vector2(1, 1) }, // the canvas
  plane: { value: new THREE.Vector4(0, 0, 0, 1) }, // x · normal > w is cut away
  background: { value: new THREE.Color() },
  depths: { value: new THREE.Vector2(0, 1) }, // where the haze begins and ends, mm from the eye
};

const LINE = `
  vec4 from = projectionMatrix * modelViewMatrix * vec4(start, 1.0);
  vec4 to = projectionMatrix * modelViewMatrix * vec4(stop, 1.0);
  if (from.w < 0.01 || to.w < 0.01) { gl_Position = NOWHERE; return; }
  vec2 along = (to.xy / to.w - from.xy / from.w) * pixels;
  along = along / max(length(along), 1e-6);
  vec4 end = position.x < 0.5 ? from : to;
  vec2 aside = vec2(-along.y, along.x) * position.y + along * (position.x * 2.0 - 1.0) * 0.4;
  place = position.x < 0.5 ? start : stop;
  gl_Position = end + vec4(aside * width / pixels * end.w, -nearer * end.w, 0.0);
  light = 1.0;`;

const STRIP = `
  vec2 along = normalize(stop.xy - start.xy + vec2(1e-9, 0.0));
  vec3 upward = vec3(vec2(-along.y, along.x) * tan(radians(lean)), 1.0);
  place = position.x < 0.5 ? start : stop;
  place += upward * (position.y > 0.0 ? span.y : span.x);
  vec4 seen = modelViewMatrix * vec4(place, 1.0);
  vec3 normal = normalize(mat3(modelViewMatrix) * cross(vec3(along, 0.0), upward));
  light = 0.45 + 0.55 * abs(dot(normal, normalize(seen.xyz)));
  gl_Position = projectionMatrix * seen;
  gl_Position.z -= nearer * gl_Position.w;`;

const vertexShader = (body) => `
  in vec3 start, stop;
  in float share, lean;
  uniform vec2 pixels, heights, depths, span;
  uniform float width, nearer;
  out vec3 place;
  out float light, way, haze;
  const vec4 NOWHERE = vec4(2.0, 2.0, 2.0, 1.0);
  void main() {
    if (start.z < heights.x || stop.z > heights.y) { gl_Position = NOWHERE; return; }
    ${body}
    way = share;
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

// `ends`: x, y, z of start and stop, one after the other; `shares`: 0 … 255, the way through the
// three colours; `leans`: degrees from the vertical, to the left of the way from start to stop.
export function segments(ends, { shares, leans } = {}) {
  const geometry = new THREE.InstancedBufferGeometry();
  const corners = [0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0];
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(corners, 3));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  const pairs = new THREE.InstancedInterleavedBuffer(ends, 6);
  geometry.setAttribute("start", new THREE.InterleavedBufferAttribute(pairs, 3, 0));
  geometry.setAttribute("stop", new THREE.InterleavedBufferAttribute(pairs, 3, 3));
  const count = ends.length / 6;
  const own = (array, normalized) => new THREE.InstancedBufferAttribute(array, 1, normalized);
  geometry.setAttribute("share", own(shares ?? new Uint8Array(count), true));
  geometry.setAttribute("lean", own(leans ?? new Int8Array(count), false));
  geometry.instanceCount = count;
  return geometry;
}

export class Strokes {
  // Lines of a width in pixels; or strips, if `strip` says from where to where above (or below) the
  // segments they reach, mm.
  constructor(geometry, { strip = null, width = 1, opacity = 1, nearer = 0 } = {}) {
    this.uniforms = {
      ...shared,
      colours: { value: [new THREE.Color(), new THREE.Color(), new THREE.Color()] },
      heights: { value: new THREE.Vector2(-Infinity, Infinity) },
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
    this.mesh = new THREE.Mesh(geometry, material);
    this.mesh.frustumCulled = false; // its places are known to the graphics card only
    this.fade(opacity);
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

  // Draw only what lies between two heights, mm.
  between(low, high) {
    this.uniforms.heights.value.set(low, high);
    return this;
  }

  // Draw only the first so many; what comes later costs nothing.
  first(count) {
    this.mesh.geometry.instanceCount = count;
    return this;
  }

  show(shown) {
    this.mesh.visible = shown;
    return this;
  }

  // Draw other segments from now on.
  replace(geometry) {
    this.mesh.geometry.dispose();
    this.mesh.geometry = geometry;
    return this;
  }
}
