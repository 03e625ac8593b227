import * as THREE from "three";
import { colorTable, cssGradient, type ColorMapName } from "./color_maps";
import { h } from "./dom";
import { length, short } from "./format";
import type { PointCloud } from "./point_cloud";
import { ColorBy } from "./point_material";
import { cameraHeight, type Run } from "./run";
import type { Viewport } from "./viewport";

/** Largest size of a point that has no finer ones around it. */
const VOXELS_OF_POINT = 2.6;
const LANDMARK_PIXELS = 3;

interface Coloring {
  name: string;
  by: ColorBy;
  map?: ColorMapName;
  caption?: string;
}

/** z of points of the root that a fraction of them does not exceed. */
function heightLimits(cloud: PointCloud): [number, number] {
  const root = cloud.loaded.get(0)!;
  const z: number[] = [];
  for (let i = 0; i < root.node.pointCount; ++i) z.push(root.points.positions[4 * i + 2]);
  z.sort((a, b) => a - b);
  const at = (fraction: number): number =>
    root.node.min[2] + (z[Math.floor(fraction * (z.length - 1))] * root.node.side) / 65536;
  return z.length > 0 ? [at(0.01), at(0.97)] : [0, 1];
}

/** How points are coloured, how many are shown, and how large they are. */
export class PointControls {
  readonly element: HTMLElement;
  private readonly legend = h("div", { class: "legend wide", hidden: true });
  private readonly caption = h("p", { class: "caption" });
  private readonly buttons: HTMLButtonElement[] = [];
  private readonly colorings: Coloring[];
  private readonly textures = new Map<ColorMapName, THREE.DataTexture>();

  constructor(
    private readonly run: Run,
    private readonly cloud: PointCloud,
    private readonly viewport: Viewport,
  ) {
    const isOnGround = cameraHeight(run) !== null && run.summary.levelled === true;
    this.colorings = [
      { name: "Image", by: ColorBy.Image },
      {
        name: "Height",
        by: ColorBy.Height,
        map: "viridis",
        caption: isOnGround
          ? "Height over the ground below the first frame."
          : "Height over the first camera, along the z axis of the run.",
      },
    ];
    if (cloud.header.hasConfidences) {
      this.colorings.push({
        name: "Confidence",
        by: ColorBy.Confidence,
        map: "cividis",
        caption:
          "1 is certain. A point of confidence c is expected 1/c − 1 voxels from the surface.",
      });
    }
    if (cloud.header.hasConfidences && run.voxelSize) {
      this.colorings.push({
        name: "Error",
        by: ColorBy.Error,
        map: "magma",
        caption: "Expected distance of a point from the surface.",
      });
    }
    const uniforms = cloud.material.uniforms;
    const voxel = run.voxelSize;
    uniforms.voxel.value = voxel ?? 0;
    // A point of the dense cloud stands for a voxel; a landmark is a point.
    if (voxel) uniforms.leafSpacing.value = VOXELS_OF_POINT * voxel;
    else uniforms.maxSize.value = LANDMARK_PIXELS * Math.min(devicePixelRatio, 2);
    uniforms.ground.value = isOnGround ? -cameraHeight(run)! : 0;
    this.element = h(
      "div",
      {},
      this.makeColorings(),
      this.legend,
      this.caption,
      ...this.makeSliders(),
    );
    this.choose(0);
  }

  /** Colours points by the n-th of the choices. */
  choose(number: number): void {
    const coloring = this.colorings[number];
    this.buttons.forEach((button, i) => button.setAttribute("aria-pressed", String(i === number)));
    const uniforms = this.cloud.material.uniforms;
    uniforms.colorBy.value = coloring.by;
    const limits = this.limitsOf(coloring.by);
    uniforms.colorRange.value.set(...limits);
    if (coloring.map) uniforms.colorMap.value = this.textureOf(coloring.map);
    this.caption.textContent = coloring.caption ?? "";
    this.caption.hidden = !coloring.caption;
    this.showLegend(coloring, limits);
    this.viewport.invalidate();
  }

  private limitsOf(by: ColorBy): [number, number] {
    if (by === ColorBy.Height) {
      const ground = this.cloud.material.uniforms.ground.value as number;
      const [low, high] = heightLimits(this.cloud);
      return [low - ground, high - ground];
    }
    if (by === ColorBy.Error) return [0, 4 * (this.run.voxelSize ?? 1)];
    return [0, 1];
  }

  private textureOf(name: ColorMapName): THREE.DataTexture {
    let texture = this.textures.get(name);
    if (!texture) {
      texture = new THREE.DataTexture(colorTable(name), 256, 1, THREE.RGBAFormat);
      texture.minFilter = texture.magFilter = THREE.LinearFilter;
      texture.needsUpdate = true;
      this.textures.set(name, texture);
    }
    return texture;
  }

  private showLegend(coloring: Coloring, limits: [number, number]): void {
    this.legend.hidden = !coloring.map;
    if (!coloring.map) return;
    const text = (value: number): string =>
      coloring.by === ColorBy.Confidence ? value.toFixed(1) : length(value, this.run.unit);
    const [low, high] = limits;
    this.legend.replaceChildren(
      h("i", { style: `background: ${cssGradient(coloring.map)}` }),
      h("span", {}, text(low)),
      h("span", {}, text((low + high) / 2)),
      h("span", {}, text(high)),
    );
  }

  private makeColorings(): HTMLElement {
    const group = h("div", { class: "segmented", role: "group", "aria-label": "Colour of points" });
    this.colorings.forEach((coloring, i) => {
      const button = h("button", { type: "button", onclick: () => this.choose(i) }, coloring.name);
      this.buttons.push(button);
      group.append(button);
    });
    return group;
  }

  private makeSliders(): HTMLElement[] {
    const slider = (
      name: string,
      min: number,
      max: number,
      value: number,
      step: number,
      show: (value: number) => string,
      apply: (value: number) => void,
    ): HTMLElement => {
      const output = h("output", {}, show(value));
      const input = h("input", {
        type: "range",
        min,
        max,
        step,
        value,
        oninput: (event: Event) => {
          const chosen = Number((event.target as HTMLInputElement).value);
          output.textContent = show(chosen);
          apply(chosen);
          this.viewport.invalidate();
        },
      });
      return h("label", { class: "slider" }, h("span", {}, name), output, input);
    };
    const total = this.cloud.header.pointCount;
    const most = Math.log10(Math.max(Math.min(total, 10_000_000), 20_000));
    const initial = Math.min(most, Math.log10(this.cloud.pointBudget));
    const uniforms = this.cloud.material.uniforms;
    const confidence = slider(
      "Least confidence",
      0,
      1,
      0,
      0.01,
      (v) => (v === 0 ? "all points" : v.toFixed(2)),
      (v) => (uniforms.leastConfidence.value = v),
    );
    return [
      ...(this.cloud.header.hasConfidences ? [confidence] : []),
      slider(
        "Points at once",
        4,
        most,
        initial,
        0.01,
        (v) => short(10 ** v),
        (v) => (this.cloud.pointBudget = 10 ** v),
      ),
      slider(
        "Point size",
        0.4,
        3,
        uniforms.pointScale.value,
        0.05,
        (v) => `${v.toFixed(2)} ×`,
        (v) => (uniforms.pointScale.value = v),
      ),
      slider(
        "Eye-dome lighting",
        0,
        2,
        this.viewport.eyeDome.strength,
        0.05,
        (v) => (v === 0 ? "off" : v.toFixed(2)),
        (v) => (this.viewport.eyeDome.strength = v),
      ),
    ];
  }
}
