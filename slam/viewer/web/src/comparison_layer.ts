import * as THREE from "three";
import { colorAt } from "./color_maps";
import { errorOfFrames } from "./comparison";
import type { Comparison, Run } from "./run";
import { WideLines, type TrajectoryLayer } from "./trajectory_layer";

export const ERROR_MAP = "plasma";

/** The path with which a run is compared, and the colours of its own path by the error. */
export class ComparisonLayer {
  readonly path = new WideLines(3);
  /** world from that of the other cloud. */
  readonly worldFromOther: THREE.Matrix4;
  private readonly errors: (number | null)[];

  constructor(
    run: Run,
    private readonly comparison: Comparison,
    private readonly trajectory: TrajectoryLayer,
  ) {
    const { path, scale } = comparison;
    const segments: number[] = [];
    for (let i = 3; i < path.length; i += 3) segments.push(...path.slice(i - 3, i + 3));
    this.path.setSegments(segments);
    this.worldFromOther = new THREE.Matrix4().compose(
      new THREE.Vector3(...comparison.translation),
      new THREE.Quaternion(...comparison.rotation),
      new THREE.Vector3(scale, scale, scale),
    );
    this.errors = errorOfFrames(run, comparison);
  }

  /** Colours the path of the run by its error. */
  colorByError(isOn: boolean): void {
    const { max } = this.comparison;
    this.trajectory.colorPath(
      isOn &&
        ((frame) => {
          const error = this.errors[frame];
          return error === null ? null : colorAt(ERROR_MAP, max > 0 ? error / max : 0);
        }),
    );
  }

  /** Box of the other path; empty without one. */
  box(): THREE.Box3 {
    return new THREE.Box3().setFromArray(this.comparison.path);
  }
}
