import * as THREE from "three";
import { Panorama } from "./panorama";
import { orientationOf, type Run } from "./run";
import type { Source } from "./source";
import type { TrajectoryLayer } from "./trajectory_layer";
import type { Viewport } from "./viewport";

/**
 * From where a keyframe is looked at while the user goes from one to the next, units of the world.
 */
const FOLLOW_DISTANCE = 25;

/** The selected keyframe: its panorama, its mark, and the camera that goes along. */
export class KeyframeTour {
  readonly panorama: Panorama;
  /** Positions of the keyframes. */
  readonly marks: THREE.Vector3[];
  private selected: number | null = null;

  /** `headingLength` gives the length of the arrow that shows where a panorama looks. */
  constructor(
    private readonly run: Run,
    source: Source,
    private readonly stage: HTMLElement,
    private readonly viewport: Viewport,
    private readonly layer: TrajectoryLayer,
    private readonly headingLength: () => number,
  ) {
    this.marks = run.keyframes.map((_, i) => layer.positionOf(i));
    this.panorama = new Panorama(run, source, {
      onStep: (by) => this.step(by),
      onClose: () => this.select(null),
      onTurn: (forward, frame) => this.turned(forward, frame),
      onGo: () => this.standAtSelected(),
    });
    stage.append(this.panorama.element);
  }

  /** Opens a keyframe, by its place among the keyframes; null closes the panorama. */
  select(keyframe: number | null): void {
    this.selected = keyframe;
    this.layer.select(keyframe, this.headingLength());
    document.body.classList.toggle("with-panorama", keyframe !== null);
    if (keyframe === null) this.panorama.hide();
    else void this.panorama.show(keyframe);
    this.makeRoom();
    this.viewport.invalidate();
  }

  /** Goes on to the next keyframe, or to the one before. */
  step(by: number): void {
    const count = this.run.keyframes.length;
    if (count === 0) return;
    const next = this.selected === null ? (by > 0 ? 0 : count - 1) : this.selected + by;
    this.select((next + count) % count);
    this.follow(this.marks[this.selected!]);
  }

  /** Moves the middle of the view out of the panorama's way. */
  makeRoom(): void {
    const { offsetWidth, offsetHeight } = this.panorama.element;
    const isBeside = this.stage.clientWidth > 2 * offsetWidth;
    const isOpen = this.panorama.isOpen;
    this.viewport.setShift(
      isOpen && isBeside ? offsetWidth / 2 : 0,
      isOpen && !isBeside ? offsetHeight / 2 : 0,
    );
  }

  /** Moves along with a keyframe, and nearer where the whole run is in view. */
  private follow(target: THREE.Vector3): void {
    const offset = this.viewport.camera.position.clone().sub(this.viewport.controls.target);
    offset.clampLength(0, FOLLOW_DISTANCE);
    this.viewport.flyTo({ eye: target.clone().add(offset), target: target.clone() });
  }

  private turned(forward: THREE.Vector3, frame: number): void {
    const place = this.run.frames.index.indexOf(frame);
    if (this.selected === null || place < 0) return;
    const orientation = new THREE.Quaternion(...orientationOf(this.run, place));
    const direction = forward.clone().applyQuaternion(orientation);
    this.layer.showHeading(direction, this.headingLength());
    this.viewport.invalidate();
  }

  private standAtSelected(): void {
    if (this.selected === null) return;
    const eye = this.marks[this.selected].clone();
    const forward = this.layer.forwardOf(this.selected);
    this.viewport.flyTo({
      eye: eye.clone().addScaledVector(forward, -0.02),
      target: eye.addScaledVector(forward, 2),
    });
  }
}
