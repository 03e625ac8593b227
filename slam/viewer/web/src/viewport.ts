import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { EyeDome } from "./eye_dome";
import type { PointCloud } from "./point_cloud";

const FIELD_OF_VIEW = 60; // degrees, vertical
const FLIGHT_MS = 450;

/** A place and what is looked at from there. */
export interface Pose {
  eye: THREE.Vector3;
  target: THREE.Vector3;
}

/** The 3D view: camera, controls, and drawing when something has changed. */
export class Viewport {
  readonly camera = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.05, 5000);
  readonly controls: OrbitControls;
  /** Lines and marks, which are drawn over the points without eye-dome lighting. */
  readonly overlay = new THREE.Scene();
  readonly eyeDome = new EyeDome();
  readonly background = new THREE.Color();
  /** The cloud of the run, and of one with which it is compared. */
  private readonly clouds: PointCloud[] = [];
  clip: THREE.Box3 | null = null;
  /** Called after every drawing. */
  onDrawn: () => void = () => {};
  /** Called when the size of the canvas has changed. */
  onResize: (width: number, height: number) => void = () => {};
  readonly renderer: THREE.WebGLRenderer;
  /** What is drawn with eye-dome lighting. */
  readonly points = new THREE.Scene();
  private isQueued = false;
  private flight: { from: Pose; to: Pose; begin: number } | null = null;
  private extent = 10;

  constructor(readonly canvas: HTMLCanvasElement) {
    THREE.ColorManagement.enabled = false;
    this.renderer = new THREE.WebGLRenderer({
      canvas,
      antialias: true,
      powerPreference: "high-performance",
    });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    this.renderer.autoClear = false;
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.zoomToCursor = true;
    this.controls.enableDamping = false;
    this.controls.maxPolarAngle = 0.98 * Math.PI;
    this.controls.addEventListener("change", () => this.invalidate());
    this.controls.addEventListener("start", () => (this.flight = null));
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement!);
    this.resize();
  }

  addCloud(cloud: PointCloud): void {
    this.clouds.push(cloud);
    this.points.add(cloud.group);
    this.invalidate();
  }

  /** Largest length of what is shown; near and far planes follow from it. */
  setExtent(extent: number): void {
    this.extent = extent;
    this.controls.maxDistance = 4 * extent;
    this.controls.minDistance = 1e-3 * extent;
  }

  /** Draws with the next frame of the screen. */
  invalidate(): void {
    if (this.isQueued) return;
    this.isQueued = true;
    requestAnimationFrame(() => {
      this.isQueued = false;
      this.draw();
    });
  }

  /** Moves the camera, gently unless the user wants no motion. */
  flyTo(to: Pose): void {
    const isStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (isStill) {
      this.setPose(to);
      return;
    }
    const from = { eye: this.camera.position.clone(), target: this.controls.target.clone() };
    this.flight = { from, to, begin: performance.now() };
    this.invalidate();
  }

  setPose(pose: Pose): void {
    this.flight = null;
    this.camera.position.copy(pose.eye);
    this.controls.target.copy(pose.target);
    this.controls.update();
    this.invalidate();
  }

  /** Turns around the target, angles in radians. */
  orbit(azimuth: number, polar: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const spherical = new THREE.Spherical().setFromVector3(
      new THREE.Vector3(offset.x, offset.z, -offset.y),
    );
    spherical.theta += azimuth;
    spherical.phi = Math.min(Math.max(spherical.phi + polar, 0.02), 0.98 * Math.PI);
    const turned = new THREE.Vector3().setFromSpherical(spherical);
    offset.set(turned.x, -turned.z, turned.y);
    this.setPose({ eye: this.controls.target.clone().add(offset), target: this.controls.target });
  }

  /** Moves sideways and forwards along the ground by fractions of the distance to the target. */
  pan(right: number, forward: number): void {
    const offset = this.controls.target.clone().sub(this.camera.position);
    const distance = offset.length();
    const ahead = new THREE.Vector3(offset.x, offset.y, 0);
    if (ahead.lengthSq() < 1e-12)
      ahead.set(0, 1, 0).applyQuaternion(this.camera.quaternion).setZ(0);
    ahead.normalize();
    const move = new THREE.Vector3(ahead.y, -ahead.x, 0)
      .multiplyScalar(right * distance)
      .addScaledVector(ahead, forward * distance);
    this.setPose({
      eye: this.camera.position.clone().add(move),
      target: this.controls.target.clone().add(move),
    });
  }

  zoom(factor: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target).multiplyScalar(factor);
    this.setPose({ eye: this.controls.target.clone().add(offset), target: this.controls.target });
  }

  /** Place on the canvas in CSS pixels; null behind the camera. */
  project(point: THREE.Vector3): { x: number; y: number } | null {
    const p = point.clone().applyMatrix4(this.camera.matrixWorldInverse);
    if (p.z > -this.camera.near) return null;
    p.applyMatrix4(this.camera.projectionMatrix);
    const { clientWidth, clientHeight } = this.canvas;
    return { x: (0.5 + 0.5 * p.x) * clientWidth, y: (0.5 - 0.5 * p.y) * clientHeight };
  }

  /** The ray through a place on the canvas, CSS pixels, and the angle of a pixel. */
  ray(x: number, y: number): { ray: THREE.Ray; radiansPerPixel: number } {
    const { clientWidth, clientHeight } = this.canvas;
    const at = new THREE.Vector3((2 * x) / clientWidth - 1, 1 - (2 * y) / clientHeight, 0.5);
    at.unproject(this.camera).sub(this.camera.position).normalize();
    const radiansPerPixel = (2 * Math.tan((FIELD_OF_VIEW * Math.PI) / 360)) / clientHeight;
    return { ray: new THREE.Ray(this.camera.position.clone(), at), radiansPerPixel };
  }

  /** Moves the middle of the view left and up, CSS pixels. */
  setShift(left: number, up: number): void {
    const { clientWidth, clientHeight } = this.canvas;
    if (left === 0 && up === 0) this.camera.clearViewOffset();
    else this.camera.setViewOffset(clientWidth, clientHeight, left, up, clientWidth, clientHeight);
    this.invalidate();
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas.parentElement!;
    const ratio = Math.min(devicePixelRatio, 2);
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.eyeDome.resize(Math.max(1, clientWidth * ratio), Math.max(1, clientHeight * ratio));
    this.camera.aspect = clientWidth / Math.max(1, clientHeight);
    this.camera.updateProjectionMatrix();
    this.onResize(clientWidth, clientHeight);
    this.draw();
  }

  private advanceFlight(): void {
    if (!this.flight) return;
    const { from, to, begin } = this.flight;
    const t = Math.min((performance.now() - begin) / FLIGHT_MS, 1);
    const eased = t * t * (3 - 2 * t);
    this.camera.position.lerpVectors(from.eye, to.eye, eased);
    this.controls.target.lerpVectors(from.target, to.target, eased);
    this.controls.update();
    if (t >= 1) this.flight = null;
    else this.invalidate();
  }

  private draw(): void {
    this.advanceFlight();
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.camera.near = Math.max(1e-4 * this.extent, 0.005 * distance);
    this.camera.far = 3 * this.extent + 2 * distance;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    for (const cloud of this.clouds) {
      cloud.pointBudget = this.clouds[0].pointBudget;
      if (cloud.group.visible) cloud.update(this.camera, this.canvas.height, this.clip);
    }
    this.eyeDome.render(this.renderer, this.points, this.camera, this.background);
    this.renderer.render(this.overlay, this.camera);
    this.onDrawn();
  }
}
