// Canvas, camera and light. A frame is drawn when something changed, and only then.

import * as THREE from "three";
import { OrbitControls } from "orbit";
import { shared } from "./strokes.js";

THREE.ColorManagement.enabled = false; // colours are shown as they are written

const FIELD = 32; // degrees of view, from bottom to top
const SLOW = 100; // ms: if frames take longer while the eye moves, fewer segments are drawn
const FEWEST = 16; // of so many segments one is always drawn
const REST = 200; // ms after a motion until all are drawn again
const FROM = [0.55, -1, 0.62]; // where the eye stands at first: in front, to the right, above

export class Stage {
  #asked = false;
  #before = [];
  #moving = false;
  #coarse = 1; // of how many segments one is drawn in motion
  #rest = null;

  constructor(canvas, [low, high]) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    this.scene = new THREE.Scene();
    this.box = new THREE.Box3(new THREE.Vector3(...low), new THREE.Vector3(...high));
    this.middle = this.box.getCenter(new THREE.Vector3());
    this.radius = this.box.getSize(new THREE.Vector3()).length() / 2;
    this.camera = new THREE.PerspectiveCamera(FIELD, 1, this.radius / 50, this.radius * 50);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.controls.zoomToCursor = true;
    this.controls.minDistance = this.radius / 20;
    this.controls.maxDistance = this.radius * 12;
    this.controls.addEventListener("change", () => this.ask());
    this.controls.addEventListener("start", () => this.move());
    this.controls.addEventListener("end", () => this.rest());
    this.#letScroll();
    new ResizeObserver(() => this.#resize(canvas)).observe(canvas.parentElement);
    this.#resize(canvas);
    this.look(FROM);
  }

  // Look at the whole part from a direction.
  look(direction) {
    const narrow = Math.min(this.camera.aspect, 1);
    const distance = (this.radius * 1.02) / Math.sin((FIELD / 2) * (Math.PI / 180)) / narrow;
    const eye = new THREE.Vector3(...direction).normalize().multiplyScalar(distance);
    this.controls.target.copy(this.middle);
    this.camera.position.copy(this.middle).add(eye);
    this.controls.update();
    this.ask();
  }

  home() {
    this.look(FROM);
  }

  // Turn about the upright axis and tilt, degrees.
  turn(round, up) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const angles = new THREE.Spherical().setFromVector3(
      new THREE.Vector3(offset.x, offset.z, -offset.y),
    );
    angles.theta += (round * Math.PI) / 180;
    angles.phi = Math.min(Math.max(angles.phi - (up * Math.PI) / 180, 0.01), Math.PI - 0.01);
    const turned = new THREE.Vector3().setFromSpherical(angles);
    this.camera.position.set(turned.x, -turned.z, turned.y).add(this.controls.target);
    this.controls.update();
    this.ask();
  }

  // Come nearer (below 1) or go away.
  zoom(factor) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    this.camera.position.copy(this.controls.target).addScaledVector(offset, factor);
    this.controls.update();
    this.ask();
  }

  // The eye begins to move: where frames were slow, only some segments are drawn until it rests.
  move() {
    clearTimeout(this.#rest);
    this.#moving = true;
    shared.every.value = this.#coarse;
  }

  // The motion has ended; soon all segments are drawn again, if it does not begin anew.
  rest() {
    this.#rest = setTimeout(() => {
      this.#moving = false;
      shared.every.value = 1;
      this.ask();
    }, REST);
  }

  // A frame of the motion took so long, ms.
  paced(taken) {
    if (!this.#moving || taken <= SLOW) return;
    this.#coarse = Math.min(2 * this.#coarse, FEWEST);
    shared.every.value = this.#coarse;
  }

  // Have `prepare` called before each frame.
  before(prepare) {
    this.#before.push(prepare);
  }

  // Ask for a frame; many askers get one.
  ask() {
    if (this.#asked) return;
    this.#asked = true;
    requestAnimationFrame((now) => {
      this.#asked = false;
      this.controls.update();
      this.draw();
      if (this.#moving) requestAnimationFrame((then) => this.paced(then - now));
    });
  }

  draw() {
    const away = this.camera.position.distanceTo(this.middle);
    shared.depths.value.set(away - this.radius * 0.5, away + this.radius * 1.3);
    for (const prepare of this.#before) prepare();
    this.renderer.render(this.scene, this.camera);
  }

  background(colour) {
    shared.background.value.set(colour);
    this.renderer.setClearColor(colour);
    this.ask();
  }

  // The ray through a point of the canvas, x and y from −1 to 1.
  ray(x, y) {
    const caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2(x, y), this.camera);
    return caster.ray;
  }

  // In a frame, as in a notebook, the wheel zooms once the frame was clicked into; till then it scrolls
  // what is around.
  #letScroll() {
    if (window === window.top) return;
    this.controls.enableZoom = document.hasFocus();
    addEventListener("focus", () => (this.controls.enableZoom = true));
    addEventListener("blur", () => (this.controls.enableZoom = false));
  }

  #resize(canvas) {
    const { clientWidth, clientHeight } = canvas.parentElement;
    const ratio = Math.min(devicePixelRatio, 2);
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / Math.max(clientHeight, 1);
    this.camera.updateProjectionMatrix();
    shared.pixels.value.set(clientWidth, clientHeight);
    this.draw();
  }
}
