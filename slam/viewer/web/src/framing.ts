import * as THREE from "three";
import type { PointCloud } from "./point_cloud";
import { positionOf, type Run } from "./run";
import type { Pose } from "./viewport";

/** What is around the path and belongs to it, units of the world. */
const SURROUNDINGS = 8;

/** The path of a run and what is around it; empty without one. */
export function boxOfPath(run: Run): THREE.Box3 {
  const box = new THREE.Box3();
  for (let i = 0; i < run.frames.index.length; ++i) {
    box.expandByPoint(new THREE.Vector3(...positionOf(run, i)));
  }
  return box.isEmpty() ? box : box.expandByScalar(SURROUNDINGS);
}

/** Box around the points of the root, which are spread over the whole cloud. */
export function boxOfCloud(cloud: PointCloud): THREE.Box3 {
  const root = cloud.loaded.get(0)!;
  const scale = root.node.side / 65536;
  const box = new THREE.Box3();
  const p = new THREE.Vector3();
  for (let i = 0; i < root.node.pointCount; ++i) {
    p.set(
      root.points.positions[4 * i],
      root.points.positions[4 * i + 1],
      root.points.positions[4 * i + 2],
    ).multiplyScalar(scale);
    box.expandByPoint(p.add(new THREE.Vector3(...root.node.min)));
  }
  return box.expandByScalar(cloud.header.side / cloud.header.cellsPerSide);
}

/** The box that the first view shows: the path, the cloud without one, or something around 0. */
export function boxToShow(run: Run, cloud: PointCloud | null): THREE.Box3 {
  const box = boxOfPath(run);
  if (!box.isEmpty()) return box;
  if (cloud) return boxOfCloud(cloud);
  return box.set(new THREE.Vector3(-5, -5, -2), new THREE.Vector3(5, 5, 2));
}

/** From where a box fills the view, seen obliquely. */
export function obliquePose(box: THREE.Box3, camera: THREE.PerspectiveCamera): Pose {
  const target = box.getCenter(new THREE.Vector3());
  const direction = new THREE.Vector3(-0.62, -0.55, 0.56).normalize();
  return { eye: target.clone().addScaledVector(direction, fittingDistance(box, camera)), target };
}

/** From where a box fills the view, seen from above. */
export function topPose(box: THREE.Box3, camera: THREE.PerspectiveCamera): Pose {
  const target = box.getCenter(new THREE.Vector3());
  const up = new THREE.Vector3(-1e-3, 0, 1);
  return { eye: target.clone().addScaledVector(up, fittingDistance(box, camera)), target };
}

function fittingDistance(box: THREE.Box3, camera: THREE.PerspectiveCamera): number {
  const size = box.getSize(new THREE.Vector3());
  const radius = 0.5 * Math.hypot(size.x, size.y);
  const vertical = Math.tan((camera.fov * Math.PI) / 360);
  return (1.05 * radius) / Math.min(vertical, vertical * camera.aspect);
}
