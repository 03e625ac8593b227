import * as THREE from "three";
import type { CameraPoints, LiveCloud, LiveState } from "./live_source";
import { matrixOf, PosedPoints } from "./posed_points";
import type { CanvasColors } from "./theme";
import { WideLines } from "./trajectory_layer";

const POINT_PIXELS = 2.2;
const MARK_PIXELS = 7;
/** Least extent that is shown, units of the world. */
const MIN_EXTENT = 200;

/** Path, keyframes, graph, loops, landmarks and dense cloud of a run that goes on. */
export class LiveLayer {
  readonly group = new THREE.Group();
  private readonly path = new WideLines(3);
  private readonly loops = new WideLines(3);
  private readonly camera = new WideLines(3);
  private readonly links: THREE.LineSegments<THREE.BufferGeometry, THREE.LineBasicMaterial>;
  private readonly marks: THREE.Points<THREE.BufferGeometry, THREE.PointsMaterial>;
  private readonly landmarks = new PosedPoints(POINT_PIXELS);
  /** Points of depth maps by view; to be drawn with eye-dome lighting. */
  readonly cloud = new PosedPoints(POINT_PIXELS);
  private keyframes: number[][] = [];
  private poses = new Map<number, number[]>(); // of keyframes by id

  constructor() {
    const material = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.28 });
    this.links = new THREE.LineSegments(new THREE.BufferGeometry(), material);
    this.marks = new THREE.Points(
      new THREE.BufferGeometry(),
      new THREE.PointsMaterial({ size: MARK_PIXELS, sizeAttenuation: false }),
    );
    for (const object of [this.links, this.marks]) object.frustumCulled = false;
    this.camera.drawOnTop();
    this.group.add(
      this.landmarks.group,
      this.links,
      this.path.object,
      this.loops.object,
      this.marks,
      this.camera.object,
    );
  }

  /** The present state; with poses, everything moves with its keyframe. */
  setState(state: LiveState): void {
    if (state.keyframes) {
      this.keyframes = state.keyframes;
      this.poses = new Map(state.keyframes.map(([id, , ...pose]) => [id, pose]));
      this.landmarks.setPoses(this.poses);
      setPositions(
        this.marks,
        state.keyframes.flatMap((keyframe) => keyframe.slice(2, 5)),
      );
    }
    const ofFrame = new Map(this.keyframes.map(([, frame, ...pose]) => [frame, pose]));
    const inOrder = [...ofFrame.entries()].sort(([a], [b]) => a - b).map(([, pose]) => pose);
    if (state.pose) inOrder.push(state.pose);
    const path: number[] = [];
    for (let i = 1; i < inOrder.length; ++i) {
      path.push(...inOrder[i - 1].slice(0, 3), ...inOrder[i].slice(0, 3));
    }
    this.path.setSegments(path);
    const between = (a: number[] | undefined, b: number[] | undefined): number[] =>
      a && b ? [...a.slice(0, 3), ...b.slice(0, 3)] : [];
    this.loops.setSegments(
      state.loops.flatMap(([a, b]) => between(ofFrame.get(a), ofFrame.get(b))),
    );
    if (state.links) {
      setPositions(
        this.links,
        state.links.flatMap(([a, b]) => between(this.poses.get(a), this.poses.get(b))),
      );
    }
    this.camera.setSegments(state.pose ? cameraShape(matrixOf(state.pose)) : []);
  }

  /** Landmarks that have changed. */
  setLandmarks(groups: CameraPoints[]): void {
    for (const { id, position, color } of groups) {
      this.landmarks.set(id, position, color);
      const pose = this.poses.get(id);
      if (pose) this.landmarks.setPose(id, pose);
    }
  }

  addViews({ maxOfView, views }: LiveCloud): void {
    for (const { id, pose, position, color } of views) {
      this.cloud.set(id, position, color);
      this.cloud.setPose(id, pose!);
    }
    this.cloud.limit(maxOfView);
  }

  /** Forgets all points: another run may be served by now. */
  clear(): void {
    this.landmarks.clear();
    this.cloud.clear();
  }

  /** Least extent that holds the map and its surroundings, units of the world. */
  get extent(): number {
    const box = this.box();
    const size = box.isEmpty() ? 0 : box.getSize(new THREE.Vector3()).length();
    return Math.max(MIN_EXTENT, 2 * size); // Landmarks lie around the path.
  }

  get numKeyframes(): number {
    return this.keyframes.length;
  }

  /** Box of the path; empty before the first keyframe. */
  box(): THREE.Box3 {
    const box = new THREE.Box3();
    for (const keyframe of this.keyframes) {
      box.expandByPoint(new THREE.Vector3(keyframe[2], keyframe[3], keyframe[4]));
    }
    return box;
  }

  setColors(colors: CanvasColors): void {
    this.path.setColor(colors.path);
    this.loops.setColor(colors.loop);
    this.camera.setColor(colors.selected);
    this.links.material.color.set(colors.link);
    this.marks.material.color.set(colors.keyframe);
  }

  resize(width: number, height: number): void {
    for (const lines of [this.path, this.loops, this.camera]) lines.resize(width, height);
  }
}

function setPositions(object: THREE.Points | THREE.LineSegments, coordinates: number[]): void {
  object.geometry.dispose();
  object.geometry = new THREE.BufferGeometry();
  object.geometry.setAttribute("position", new THREE.Float32BufferAttribute(coordinates, 3));
}

/** A ring around the camera and where it looks, in units of the world. */
function cameraShape(worldFromCamera: THREE.Matrix4): number[] {
  const radius = 0.35;
  const corners = 24;
  const at = (x: number, y: number, z: number): number[] =>
    new THREE.Vector3(x, y, z).applyMatrix4(worldFromCamera).toArray();
  const lines = [...at(0, 0, 0), ...at(0, 0, 3 * radius)];
  for (let i = 0; i < corners; ++i) {
    for (const k of [i, i + 1]) {
      const angle = (2 * Math.PI * k) / corners;
      lines.push(...at(radius * Math.sin(angle), 0, radius * Math.cos(angle)));
    }
  }
  return lines;
}
