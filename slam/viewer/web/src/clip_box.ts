import * as THREE from "three";
import { h } from "./dom";
import { length } from "./format";
import type { PointCloud } from "./point_cloud";
import { WideLines } from "./trajectory_layer";

const STEPS = 400;
const AXES = ["x (forward)", "y (left)", "z (up)"];

/** A box outside which no points are shown, with two sliders for each axis. */
export class ClipBox {
  readonly element: HTMLElement;
  readonly lines = new WideLines(1.5);
  isOn = false;
  readonly box: THREE.Box3;
  private readonly sliders: [HTMLInputElement, HTMLInputElement][] = [];
  private readonly outputs: HTMLOutputElement[] = [];

  constructor(
    private readonly whole: THREE.Box3,
    private readonly cloud: PointCloud,
    private readonly unit: "m" | "units",
    private readonly onChange: () => void,
  ) {
    this.box = whole.clone();
    this.element = h("div", { class: "clip" });
    for (let axis = 0; axis < 3; ++axis) this.element.append(this.makeAxis(axis));
    this.element.append(
      h("button", { type: "button", class: "quiet", onclick: () => this.reset() }, "Whole cloud"),
    );
    this.update();
  }

  setOn(isOn: boolean): void {
    this.isOn = isOn;
    this.update();
  }

  reset(): void {
    for (const [low, high] of this.sliders) {
      low.value = "0";
      high.value = String(STEPS);
    }
    this.update();
  }

  setColor(color: string): void {
    this.lines.setColor(color);
  }

  private makeAxis(axis: number): HTMLElement {
    const slider = (name: string, value: number): HTMLInputElement =>
      h("input", {
        type: "range",
        min: 0,
        max: STEPS,
        value,
        "aria-label": `${name} limit of ${AXES[axis]}`,
        oninput: (event: Event) => this.moved(axis, event.target as HTMLInputElement),
      });
    const pair: [HTMLInputElement, HTMLInputElement] = [slider("lower", 0), slider("upper", STEPS)];
    this.sliders.push(pair);
    const output = h("output", {});
    this.outputs.push(output);
    return h(
      "fieldset",
      { class: "dual" },
      h("legend", {}, AXES[axis]),
      output,
      h("div", { class: "dual-track" }, ...pair),
    );
  }

  /** The two sliders of an axis do not pass each other. */
  private moved(axis: number, slider: HTMLInputElement): void {
    const [low, high] = this.sliders[axis];
    if (Number(low.value) > Number(high.value) - 2) {
      if (slider === low) low.value = String(Number(high.value) - 2);
      else high.value = String(Number(low.value) + 2);
    }
    this.update();
  }

  private update(): void {
    const size = this.whole.getSize(new THREE.Vector3());
    for (let axis = 0; axis < 3; ++axis) {
      const [low, high] = this.sliders[axis].map((slider) => Number(slider.value) / STEPS);
      const at = (fraction: number): number =>
        this.whole.min.getComponent(axis) + fraction * size.getComponent(axis);
      this.box.min.setComponent(axis, at(low));
      this.box.max.setComponent(axis, at(high));
      this.outputs[axis].textContent =
        `${length(at(low), this.unit)} to ${length(at(high), this.unit)}`;
    }
    const uniforms = this.cloud.material.uniforms;
    uniforms.isClipped.value = this.isOn;
    uniforms.clipMin.value.copy(this.box.min);
    uniforms.clipMax.value.copy(this.box.max);
    this.lines.setSegments(this.isOn ? edgesOf(this.box) : []);
    this.onChange();
  }
}

function edgesOf(box: THREE.Box3): number[] {
  const corner = (bits: number): number[] => [
    bits & 1 ? box.max.x : box.min.x,
    bits & 2 ? box.max.y : box.min.y,
    bits & 4 ? box.max.z : box.min.z,
  ];
  const edges: number[] = [];
  for (let bits = 0; bits < 8; ++bits) {
    for (const axis of [1, 2, 4]) {
      if ((bits & axis) === 0) edges.push(...corner(bits), ...corner(bits | axis));
    }
  }
  return edges;
}
