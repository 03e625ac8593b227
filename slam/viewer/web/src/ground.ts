import type * as THREE from "three";
import { cameraHeight, positionOf, type Run } from "./run";

/** The ground under a place. */
export interface GroundBelow {
  /** Its z in the world. */
  z: number;
  /** Index of the frame over whose ground it is measured. */
  frame: number;
}

/**
 * The ground below a place, as far as the run knows it: under the keyframe that is nearest
 * horizontally, lower by the height of the camera. None in a run that is not levelled or has no
 * scale.
 */
export function groundBelow(run: Run, place: THREE.Vector3): GroundBelow | null {
  const height = cameraHeight(run);
  if (height === null || run.summary.levelled !== true || run.keyframes.length === 0) return null;
  let nearest = -1;
  let nearestDistance = Infinity;
  let z = 0;
  for (const frame of run.keyframes) {
    const p = positionOf(run, frame);
    const distance = Math.hypot(p[0] - place.x, p[1] - place.y);
    if (distance < nearestDistance) [nearest, nearestDistance, z] = [frame, distance, p[2]];
  }
  return { z: z - height, frame: run.frames.index[nearest] };
}
