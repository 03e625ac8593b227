import * as THREE from "three";
import { ClipBox } from "./clip_box";
import { short } from "./format";
import { boxOfCloud, boxToShow, obliquePose, topPose } from "./framing";
import { Labels } from "./labels";
import { centerMessage, togglePanel, type Layout } from "./layout";
import { Measure, type MeasureMode } from "./measure";
import { addCloudSections, fillPanel, showSection } from "./panel";
import { Panorama } from "./panorama";
import { pickMark, pickPoint, type PickedPoint } from "./pick";
import { PointCloud } from "./point_cloud";
import { listenToPointer } from "./pointer";
import { orientationOf, type Run } from "./run";
import type { Source } from "./source";
import { canvasColors, followTheme } from "./theme";
import { makeToolbar, type Toolbar } from "./toolbar";
import { TrajectoryLayer } from "./trajectory_layer";
import { Viewport } from "./viewport";
import { viewportKeys } from "./viewport_keys";

const PICK_PIXELS = 8;
const MARK_PIXELS = 12;
/**
 * From where a keyframe is looked at while the user goes from one to the next, units of the world.
 */
const FOLLOW_DISTANCE = 25;

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
  private readonly panorama: Panorama;
  private readonly toolbar: Toolbar;
  private cloud: PointCloud | null = null;
  private clipBox: ClipBox | null = null;
  private selected: number | null = null;
  private readonly marks: THREE.Vector3[];

  constructor(
    private readonly run: Run,
    private readonly source: Source,
    private readonly page: Layout,
    private readonly events: ViewerEvents,
  ) {
    this.viewport = new Viewport(page.canvas);
    this.labels = new Labels(page.labels, this.viewport);
    this.layer = new TrajectoryLayer(run);
    this.marks = run.keyframes.map((_, i) => this.layer.positionOf(i));
    this.measure = new Measure(run, this.labels, () => this.viewport.invalidate());
    this.panorama = new Panorama(run, source, {
      onStep: (by) => this.step(by),
      onClose: () => this.select(null),
      onTurn: (forward, frame) => this.turned(forward, frame),
      onGo: () => this.standAtSelected(),
    });
    page.stage.append(this.panorama.element);
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
    this.viewport.onDrawn = () => this.drawn();
    this.viewport.onResize = (width, height) => this.resized(width, height);
    const box = this.box();
    this.viewport.setExtent(box.getSize(new THREE.Vector3()).length());
    this.viewport.setPose(obliquePose(this.box(), this.viewport.camera));
    this.resized(page.stage.clientWidth, page.stage.clientHeight);
    followTheme((colors) => {
      this.viewport.background.set(colors.background);
      this.layer.setColors(colors);
      this.measure.setColor(colors.measure);
      this.clipBox?.setColor(colors.box);
      this.viewport.invalidate();
    });
    listenToPointer(page.canvas, {
      onClick: (x, y) => this.clicked(x, y),
      onDoubleClick: (x, y) => this.doubleClicked(x, y),
      onHover: (x, y) => this.hovered(x, y),
    });
    fillPanel(run, page, this.layer, () => this.viewport.invalidate());
  }

  /** Loads the cloud, as far as the run has one. */
  async loadCloud(): Promise<void> {
    if (!this.run.hasCloud) {
      this.showEmpty();
      return;
    }
    const cloud = await PointCloud.open(
      this.source,
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
    this.viewport.setCloud(cloud);
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
      "[": () => this.step(-1),
      "]": () => this.step(1),
      Escape: () => this.escape(),
    };
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    action?.();
    return action !== undefined;
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

  private step(by: number): void {
    const count = this.run.keyframes.length;
    if (count === 0) return;
    const next = this.selected === null ? (by > 0 ? 0 : count - 1) : this.selected + by;
    this.select((next + count) % count);
    this.follow(this.marks[this.selected!]);
  }

  /** Moves along with a keyframe, and nearer where the whole run is in view. */
  private follow(target: THREE.Vector3): void {
    const offset = this.viewport.camera.position.clone().sub(this.viewport.controls.target);
    offset.clampLength(0, FOLLOW_DISTANCE);
    this.viewport.flyTo({ eye: target.clone().add(offset), target: target.clone() });
  }

  /** Moves the middle of the view out of the panorama's way. */
  private makeRoom(): void {
    const { offsetWidth, offsetHeight } = this.panorama.element;
    const isBeside = this.page.stage.clientWidth > 2 * offsetWidth;
    const isOpen = this.panorama.isOpen;
    this.viewport.setShift(
      isOpen && isBeside ? offsetWidth / 2 : 0,
      isOpen && !isBeside ? offsetHeight / 2 : 0,
    );
  }

  private escape(): void {
    if (this.measure.mode) {
      this.measure.endLine();
      this.toolbar.toggleMode(this.measure.mode);
    } else if (this.panorama.isOpen) this.select(null);
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
      pickMark(this.viewport, this.marks, x, y, MARK_PIXELS) !== null;
    this.page.canvas.classList.toggle("pointing", isMark);
  }

  private clicked(x: number, y: number): void {
    if (this.measure.mode) {
      const picked = this.pick(x, y);
      if (picked) this.measure.add(picked.position);
      return;
    }
    if (!this.layer.keyframes.visible) return;
    const mark = pickMark(this.viewport, this.marks, x, y, MARK_PIXELS);
    if (mark !== null) this.select(mark);
  }

  private lookAt(target: THREE.Vector3): void {
    const offset = this.viewport.camera.position.clone().sub(target).multiplyScalar(0.5);
    this.viewport.flyTo({ eye: target.clone().add(offset), target });
  }

  private resized(width: number, height: number): void {
    this.layer.resize(width, height);
    this.measure.resize(width, height);
    this.clipBox?.lines.resize(width, height);
    this.makeRoom();
  }

  private drawn(): void {
    this.labels.update();
    const { canvas, counter, progress } = this.page;
    const shown = this.cloud?.shownPoints ?? 0;
    canvas.dataset.points = String(shown);
    canvas.dataset.loading = String(this.cloud?.isLoading ?? false);
    if (!this.cloud) return;
    progress.hidden = !this.cloud.isLoading;
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
