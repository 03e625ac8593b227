import * as THREE from "three";

const IDENTITY_SCALE = new THREE.Vector3(1, 1, 1);

/** x y z qx qy qz qw as a matrix. */
export function matrixOf(pose: ArrayLike<number>): THREE.Matrix4 {
  const place = new THREE.Vector3(pose[0], pose[1], pose[2]);
  const rotation = new THREE.Quaternion(pose[3], pose[4], pose[5], pose[6]);
  return new THREE.Matrix4().compose(place, rotation, IDENTITY_SCALE);
}

/** Points in the coordinates of keyframes or views, with which they move. */
export class PosedPoints {
  readonly group = new THREE.Group();
  private readonly objects = new Map<number, THREE.Points>();
  private readonly material: THREE.PointsMaterial;

  constructor(pixels: number) {
    this.material = new THREE.PointsMaterial({
      size: pixels,
      sizeAttenuation: false,
      vertexColors: true,
    });
  }

  /** Number of points. */
  get count(): number {
    let count = 0;
    for (const { geometry } of this.objects.values()) {
      count += Math.min(geometry.getAttribute("position").count, geometry.drawRange.count);
    }
    return count;
  }

  /** Replaces the points of a camera; they are hidden until its pose is known. */
  set(id: number, position: Float32Array, color: Uint8Array): void {
    const before = this.objects.get(id);
    before?.geometry.dispose();
    if (before) this.group.remove(before);
    this.objects.delete(id);
    if (position.length === 0) return;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(color, 3, true));
    const object = new THREE.Points(geometry, this.material);
    object.matrixAutoUpdate = false;
    object.frustumCulled = false;
    object.visible = false;
    this.objects.set(id, object);
    this.group.add(object);
  }

  setPose(id: number, pose: ArrayLike<number>): void {
    const object = this.objects.get(id);
    if (!object) return;
    object.visible = true;
    object.matrix.copy(matrixOf(pose));
    object.matrixWorldNeedsUpdate = true;
  }

  /** Moves all points to poses by their cameras; those without one are hidden. */
  setPoses(poses: Map<number, ArrayLike<number>>): void {
    for (const [id, object] of this.objects) {
      const pose = poses.get(id);
      if (pose) this.setPose(id, pose);
      else object.visible = false;
    }
  }

  /** Draws no more than the first points of each camera. */
  limit(perCamera: number): void {
    for (const { geometry } of this.objects.values()) geometry.setDrawRange(0, perCamera);
  }

  clear(): void {
    for (const id of [...this.objects.keys()]) this.set(id, new Float32Array(), new Uint8Array());
  }
}
