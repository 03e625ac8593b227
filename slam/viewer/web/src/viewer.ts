import * as THREE from "three";
import { ClipBox } from "./clip_box";
import { short } from "./format";
import { boxOfCloud, boxToShow, obliquePose, topPose } from "./framing";
import { Labels } from "./labels";
import { centerMessage, togglePanel, type Layout } from "./layout";
import { Measure, type MeasureMode } from "./measure";
import { addCloudSections, fillPanel, showSection } from "./panel";
import { ComparisonView } from "./comparison_view";
import { KeyframeTour } from "./keyframe_tour";
import { pickMark, pickPoint, type PickedPoint } from "./pick";
import { PointCloud } from "./point_cloud";
import { listenToPointer } from "./pointer";
import type { Run } from "./run";
import type { Source } from "./source";
import { canvasColors, followTheme } from "./theme";
import { makeToolbar, type Toolbar } from "./toolbar";
import { TrajectoryLayer } from "./trajectory_layer";
import { Viewport } from "./viewport";
import { viewportKeys } from "./viewport_keys";

const PICK_PIXELS = 8;
const MARK_PIXELS = 12;

export interface ViewerEvents {
  /** Points could not be loaded. */
  onFailure: (error: Error) => void;
  onHelp: () => void;
}

/** Shows a run: everything between the data and the page. */
export class Viewer {
  readonly viewport: Viewport;
  private readonly layer: TrajectoryLayer;
  private readonly labels: Labels;
  private readonly measure: Measure;
  private readonly tour: KeyframeTour;
  private readonly toolbar: Toolbar;
  private cloud: PointCloud | null = null;
  private clipBox: ClipBox | null = null;
  private readonly comparison: ComparisonView | null;

  constructor(
    private readonly run: Run,
    private readonly source: Source,
    private readonly page: Layout,
    private readonly events: ViewerEvents,
  ) {
    this.viewport = new Viewport(page.canvas);
    this.labels = new Labels(page.labels, this.viewport);
    this.layer = new TrajectoryLayer(run);
    this.measure = new Measure(run, this.labels, () => this.viewport.invalidate());
    this.tour = new KeyframeTour(run, source, page.stage, this.viewport, this.layer, () =>
      this.headingLength(),
    );
    this.viewport.overlay.add(this.layer.group, this.measure.group);
    this.toolbar = makeToolbar(page.toolbar, {
      onHome: () => this.viewport.flyTo(obliquePose(this.box(), this.viewport.camera)),
      onTop: () => this.viewport.flyTo(topPose(this.box(), this.viewport.camera)),
      onMode: (mode) => this.setMode(mode),
      onClear: () => this.measure.clear(),
      onClip: (isOn) => this.setClip(isOn),
      onHelp: events.onHelp,
    });
    page.toolbar.hidden = false;
    fillPanel(run, page, this.layer, () => this.viewport.invalidate());
    this.comparison = run.comparison
      ? new ComparisonView(run, run.comparison, page, this.layer, this.viewport)
      : null;
    this.viewport.onDrawn = () => this.drawn();
    this.viewport.onResize = (width, height) => this.resized(width, height);
    const box = this.box();
    this.viewport.setExtent(box.getSize(new THREE.Vector3()).length());
    this.viewport.setPose(obliquePose(this.box(), this.viewport.camera));
    this.resized(page.stage.clientWidth, page.stage.clientHeight);
    followTheme((colors) => {
      this.viewport.background.set(colors.background);
      this.layer.setColors(colors);
      this.comparison?.setColor(colors.other);
      this.measure.setColor(colors.measure);
      this.clipBox?.setColor(colors.box);
      this.viewport.invalidate();
    });
    listenToPointer(page.canvas, {
      onClick: (x, y) => this.clicked(x, y),
      onDoubleClick: (x, y) => this.doubleClicked(x, y),
      onHover: (x, y) => this.hovered(x, y),
    });
  }

  /** Loads the cloud, as far as the run has one. */
  async loadCloud(): Promise<void> {
    if (!this.run.hasCloud) {
      this.showEmpty();
      return;
    }
    const cloud = await PointCloud.open(
      (begin, end) => this.source.octree(begin, end),
      () => this.viewport.invalidate(),
      this.events.onFailure,
    );
    this.cloud = cloud;
    const { min, side } = cloud.header;
    const box = boxOfCloud(cloud);
    const whole = new THREE.Box3(
      new THREE.Vector3(...min),
      new THREE.Vector3(min[0] + side, min[1] + side, min[2] + side),
    );
    this.viewport.setExtent(
      whole.union(this.box()).getSize(new THREE.Vector3()).length() / Math.sqrt(3),
    );
    this.viewport.addCloud(cloud);
    this.comparison?.addCloud(this.source, cloud, this.events.onFailure);
    if (this.run.frames.index.length === 0)
      this.viewport.setPose(obliquePose(this.box(), this.viewport.camera));
    this.clipBox = new ClipBox(box, cloud, this.run.unit, () => this.clipChanged());
    this.clipBox.setColor(canvasColors().box);
    this.viewport.overlay.add(this.clipBox.lines.object);
    addCloudSections(this.run, this.page, cloud, this.clipBox, this.viewport);
    this.resized(this.page.stage.clientWidth, this.page.stage.clientHeight);
  }

  /** The server answers again. */
  reconnected(): void {
    this.cloud?.retry();
    this.comparison?.retry();
  }

  /** Handles a key; true if it had a meaning. */
  key(event: KeyboardEvent): boolean {
    const actions: Record<string, () => void> = {
      ...viewportKeys(this.viewport),
      h: () => this.viewport.flyTo(obliquePose(this.box(), this.viewport.camera)),
      t: () => this.viewport.flyTo(topPose(this.box(), this.viewport.camera)),
      m: () => this.toolbar.toggleMode("distance"),
      g: () => this.toolbar.toggleMode("height"),
      c: () => this.toolbar.toggleClip(),
      p: () => togglePanel(),
      "[": () => this.tour.step(-1),
      "]": () => this.tour.step(1),
      Escape: () => this.escape(),
    };
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    action?.();
    return action !== undefined;
  }

  private escape(): void {
    if (this.measure.mode) {
      this.measure.endLine();
      this.toolbar.toggleMode(this.measure.mode);
    } else if (this.tour.panorama.isOpen) this.tour.select(null);
  }

  private setMode(mode: MeasureMode | null): void {
    this.measure.setMode(mode);
    this.page.canvas.classList.toggle("measuring", mode !== null);
  }

  private setClip(isOn: boolean): void {
    this.clipBox?.setOn(isOn);
    if (isOn) showSection(this.page, "clip-section");
  }

  private clipChanged(): void {
    this.viewport.clip = this.clipBox?.isOn ? this.clipBox.box : null;
    this.viewport.invalidate();
  }

  private headingLength(): number {
    return Math.max(0.03 * this.box().getSize(new THREE.Vector3()).length(), 0.5);
  }

  private box(): THREE.Box3 {
    return boxToShow(this.run, this.cloud);
  }

  private pick(x: number, y: number): PickedPoint | null {
    return this.cloud ? pickPoint(this.viewport, this.cloud, x, y, PICK_PIXELS) : null;
  }

  private doubleClicked(x: number, y: number): void {
    if (this.measure.mode) {
      this.measure.endLine();
      return;
    }
    const picked = this.pick(x, y);
    if (picked) this.lookAt(picked.position);
  }

  private hovered(x: number, y: number): void {
    if (this.measure.mode) {
      this.measure.hover(this.pick(x, y)?.position ?? null);
      return;
    }
    const isMark =
      this.layer.keyframes.visible &&
      pickMark(this.viewport, this.tour.marks, x, y, MARK_PIXELS) !== null;
    this.page.canvas.classList.toggle("pointing", isMark);
  }

  private clicked(x: number, y: number): void {
    if (this.measure.mode) {
      const picked = this.pick(x, y);
      if (picked) this.measure.add(picked.position);
      return;
    }
    if (!this.layer.keyframes.visible) return;
    const mark = pickMark(this.viewport, this.tour.marks, x, y, MARK_PIXELS);
    if (mark !== null) this.tour.select(mark);
  }

  private lookAt(target: THREE.Vector3): void {
    const offset = this.viewport.camera.position.clone().sub(target).multiplyScalar(0.5);
    this.viewport.flyTo({ eye: target.clone().add(offset), target });
  }

  private resized(width: number, height: number): void {
    this.layer.resize(width, height);
    this.measure.resize(width, height);
    this.clipBox?.lines.resize(width, height);
    this.comparison?.resize(width, height);
    this.tour.makeRoom();
  }

  private drawn(): void {
    this.labels.update();
    const { canvas, counter, progress } = this.page;
    const shown = this.cloud?.shownPoints ?? 0;
    const isLoading = (this.cloud?.isLoading ?? false) || (this.comparison?.isLoading ?? false);
    canvas.dataset.points = String(shown);
    canvas.dataset.otherPoints = String(this.comparison?.shownPoints ?? 0);
    canvas.dataset.loading = String(isLoading);
    if (!this.cloud) return;
    progress.hidden = !isLoading;
    const total = this.cloud.header.pointCount;
    counter.textContent = `${short(shown)} of ${short(total)} points`;
  }

  private showEmpty(): void {
    this.page.stage.classList.add("without-cloud");
    this.page.center.replaceChildren(
      this.run.frames.index.length > 0
        ? centerMessage("No points", "This run has a path but no cloud.")
        : centerMessage(
            "Nothing to show",
            "No frame of this run has a pose. The camera has to move and to see some texture.",
          ),
    );
    this.page.progress.hidden = true;
    this.viewport.invalidate();
  }
}
