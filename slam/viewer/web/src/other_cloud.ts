import * as THREE from "three";
import { PointCloud, type OctreeSource } from "./point_cloud";
import type { Viewport } from "./viewport";

/** How much of the colour of the other path is mixed into its cloud. */
const OVERLAY = 0.45;
/** What the user chooses for the cloud of the run holds for the other one as well. */
const COMMON = [
  "pointScale",
  "minSize",
  "maxSize",
  "leafSpacing",
  "leastConfidence",
  "ground",
  "voxel",
  "colorBy",
  "colorRange",
  "colorMap",
  "isClipped",
  "clipMin",
  "clipMax",
];

/** The cloud of a run with which another is compared. It is loaded when it is first shown. */
export class OtherCloud {
  cloud: PointCloud | null = null;
  private opening: Promise<void> | null = null;
  private isShown = false;
  private readonly overlay = new THREE.Vector4(1, 1, 1, OVERLAY);

  constructor(
    private readonly source: OctreeSource,
    private readonly worldFromOther: THREE.Matrix4,
    private readonly main: PointCloud,
    private readonly viewport: Viewport,
    private readonly onFailure: (error: Error) => void,
  ) {}

  get isLoading(): boolean {
    return this.isShown && (this.cloud?.isLoading ?? true);
  }

  get shownPoints(): number {
    return this.isShown ? (this.cloud?.shownPoints ?? 0) : 0;
  }

  async show(isShown: boolean): Promise<void> {
    this.isShown = isShown;
    try {
      if (isShown) await (this.opening ??= this.open());
    } catch (error) {
      this.opening = null; // Switching it on again tries again.
      this.isShown = false;
      this.onFailure(error as Error);
    }
    if (this.cloud) this.cloud.group.visible = this.isShown;
    this.viewport.invalidate();
  }

  setColor(color: string): void {
    const { r, g, b } = new THREE.Color(color);
    this.overlay.set(r, g, b, OVERLAY);
  }

  private async open(): Promise<void> {
    this.viewport.invalidate();
    const cloud = await PointCloud.open(
      this.source,
      () => this.viewport.invalidate(),
      this.onFailure,
    );
    cloud.setTransform(this.worldFromOther);
    const { uniforms } = cloud.material;
    for (const name of COMMON) uniforms[name] = this.main.material.uniforms[name];
    uniforms.overlay.value = this.overlay;
    this.cloud = cloud;
    this.viewport.addCloud(cloud);
  }
}
