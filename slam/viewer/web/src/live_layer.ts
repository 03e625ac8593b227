import * as THREE from "three";
import type { LivePoints, LiveState } from "./live_source";
import type { CanvasColors } from "./theme";
import { WideLines } from "./trajectory_layer";

const POINT_PIXELS = 2.2;
const MARK_PIXELS = 7;

/** Three numbers of a pose: where it is. */
function placeOf(pose: number[]): THREE.Vector3 {
  return new THREE.Vector3(pose[0], pose[1], pose[2]);
}

function matrixOf(pose: number[]): THREE.Matrix4 {
  const rotation = new THREE.Quaternion(pose[3], pose[4], pose[5], pose[6]);
  return new THREE.Matrix4().compose(placeOf(pose), rotation, new THREE.Vector3(1, 1, 1));
}

/** Path, keyframes, graph, loops and landmarks of a run that goes on. */
export class LiveLayer {
  readonly group = new THREE.Group();
  private readonly path = new WideLines(3);
  private readonly loops = new WideLines(3);
  private readonly camera = new WideLines(3);
  private readonly links: THREE.LineSegments<THREE.BufferGeometry, THREE.LineBasicMaterial>;
  private readonly marks: THREE.Points<THREE.BufferGeometry, THREE.PointsMaterial>;
  private readonly landmarks = new THREE.Group();
  private readonly pointMaterial = new THREE.PointsMaterial({
    size: POINT_PIXELS,
    sizeAttenuation: false,
    vertexColors: true,
  });
  private readonly objects = new Map<number, THREE.Points>(); // landmarks by keyframe

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
      this.landmarks,
      this.links,
      this.path.object,
      this.loops.object,
      this.marks,
      this.camera.object,
    );
  }

  /** Poses have changed: everything moves with its keyframe. */
  setState(state: LiveState): void {
    const poses = new Map(state.keyframes.map(([id, , ...pose]) => [id, pose]));
    const ofFrame = new Map(state.keyframes.map(([, frame, ...pose]) => [frame, pose]));
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
    setPositions(
      this.links,
      state.links.flatMap(([a, b]) => between(poses.get(a), poses.get(b))),
    );
    setPositions(
      this.marks,
      state.keyframes.flatMap((keyframe) => keyframe.slice(2, 5)),
    );
    this.camera.setSegments(state.pose ? cameraShape(matrixOf(state.pose)) : []);
    for (const [id, object] of this.objects) {
      const pose = poses.get(id);
      object.visible = pose !== undefined;
      if (pose) object.matrix.copy(matrixOf(pose));
      object.matrixWorldNeedsUpdate = true;
    }
  }

  setLandmarks(points: LivePoints): void {
    const numbers = new Map<number, number[]>();
    points.keyframe.forEach((id, i) => {
      const list = numbers.get(id);
      if (list) list.push(i);
      else numbers.set(id, [i]);
    });
    for (const object of this.objects.values()) object.geometry.dispose();
    this.objects.clear();
    this.landmarks.clear();
    for (const [id, list] of numbers) {
      const position = list.flatMap((i) => [...points.position.subarray(3 * i, 3 * i + 3)]);
      const color = Uint8Array.from(
        list.flatMap((i) => [...points.color.subarray(3 * i, 3 * i + 3)]),
      );
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.Float32BufferAttribute(position, 3));
      geometry.setAttribute("color", new THREE.BufferAttribute(color, 3, true));
      const object = new THREE.Points(geometry, this.pointMaterial);
      object.matrixAutoUpdate = false;
      object.frustumCulled = false;
      this.objects.set(id, object);
      this.landmarks.add(object);
    }
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
