import { ComparisonLayer } from "./comparison_layer";
import { comparisonSection } from "./comparison_panel";
import type { Layout } from "./layout";
import { OtherCloud } from "./other_cloud";
import type { PointCloud } from "./point_cloud";
import type { Comparison, Run } from "./run";
import type { Source } from "./source";
import type { TrajectoryLayer } from "./trajectory_layer";
import type { Viewport } from "./viewport";

/** A run against another path: what the panel has of it, and what the view shows. */
export class ComparisonView {
  private readonly layer: ComparisonLayer;
  private other: OtherCloud | null = null;
  private color = "#ffffff";

  constructor(
    run: Run,
    comparison: Comparison,
    page: Layout,
    trajectory: TrajectoryLayer,
    private readonly viewport: Viewport,
  ) {
    this.layer = new ComparisonLayer(run, comparison, trajectory);
    viewport.overlay.add(this.layer.path.object);
    const part = comparisonSection(run, comparison, {
      onPath: (isShown) => {
        this.layer.path.object.visible = isShown;
        viewport.invalidate();
      },
      onCloud: (isShown) => void this.other?.show(isShown),
      onColor: (isByError) => {
        this.layer.colorByError(isByError);
        viewport.invalidate();
      },
    });
    page.panelBody.prepend(part);
  }

  /** Makes it possible to show the other cloud, as the one of the run is shown. */
  addCloud(source: Source, main: PointCloud, onFailure: (error: Error) => void): void {
    this.other = new OtherCloud(
      (begin, end) => source.otherOctree(begin, end),
      this.layer.worldFromOther,
      main,
      this.viewport,
      onFailure,
    );
    this.other.setColor(this.color);
  }

  /** Points of the other cloud that are shown. */
  get shownPoints(): number {
    return this.other?.shownPoints ?? 0;
  }

  get isLoading(): boolean {
    return this.other?.isLoading ?? false;
  }

  retry(): void {
    this.other?.cloud?.retry();
  }

  setColor(color: string): void {
    this.color = color;
    this.layer.path.setColor(color);
    this.other?.setColor(color);
  }

  resize(width: number, height: number): void {
    this.layer.path.resize(width, height);
  }
}
