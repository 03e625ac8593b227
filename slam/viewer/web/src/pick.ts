import * as THREE from "three";
import type { LoadedNode, PointCloud } from "./point_cloud";
import type { Viewport } from "./viewport";

/** A point of the cloud under the cursor. */
export interface PickedPoint {
  position: THREE.Vector3;
}

interface Candidate extends PickedPoint {
  distance: number;
}

/** Looks through a node for the nearest point within an angle of the ray. */
function pickInNode(
  entry: LoadedNode,
  ray: THREE.Ray,
  tangent: number,
  clip: THREE.Box3 | null,
  leastConfidence: number,
): Candidate | null {
  const { node, points } = entry;
  const scale = node.side / 65536;
  const p = new THREE.Vector3();
  let best: Candidate | null = null;
  for (let i = 0; i < node.pointCount; ++i) {
    p.set(
      node.min[0] + scale * (points.positions[4 * i] + 0.5),
      node.min[1] + scale * (points.positions[4 * i + 1] + 0.5),
      node.min[2] + scale * (points.positions[4 * i + 2] + 0.5),
    );
    const along =
      (p.x - ray.origin.x) * ray.direction.x +
      (p.y - ray.origin.y) * ray.direction.y +
      (p.z - ray.origin.z) * ray.direction.z;
    if (along <= 0 || (best && along >= best.distance)) continue;
    const limit = along * tangent;
    if (ray.distanceSqToPoint(p) > limit * limit) continue;
    if (clip && !clip.containsPoint(p)) continue;
    if (points.colors[4 * i + 3] / 255 < leastConfidence) continue; // as in the shader
    best = { position: p.clone(), distance: along };
  }
  return best;
}

/** The nearest shown point at a place on the canvas, CSS pixels. */
export function pickPoint(
  viewport: Viewport,
  cloud: PointCloud,
  x: number,
  y: number,
  radius: number,
): PickedPoint | null {
  const { ray, radiansPerPixel } = viewport.ray(x, y);
  const leastConfidence = cloud.material.uniforms.leastConfidence.value as number;
  const box = new THREE.Box3();
  let best: Candidate | null = null;
  for (const tangent of [radius / 2, radius].map((pixels) => pixels * radiansPerPixel)) {
    for (const entry of cloud.shownNodes) {
      const { min, side } = entry.node;
      box.min.set(...min);
      box.max.set(min[0] + side, min[1] + side, min[2] + side);
      const distance = box.distanceToPoint(ray.origin);
      if (best && distance > best.distance) continue;
      box.expandByScalar((distance + 2 * side) * tangent);
      if (!ray.intersectsBox(box)) continue;
      const candidate = pickInNode(entry, ray, tangent, viewport.clip, leastConfidence);
      if (candidate && (!best || candidate.distance < best.distance)) best = candidate;
    }
    if (best) return best;
  }
  return null;
}

/** The mark nearest to a place on the canvas, by its number; null where none is within `radius`. */
export function pickMark(
  viewport: Viewport,
  positions: THREE.Vector3[],
  x: number,
  y: number,
  radius: number,
): number | null {
  let best: number | null = null;
  let bestDistance = radius;
  positions.forEach((position, i) => {
    const at = viewport.project(position);
    if (!at) return;
    const distance = Math.hypot(at.x - x, at.y - y);
    if (distance <= bestDistance) [best, bestDistance] = [i, distance];
  });
  return best;
}
