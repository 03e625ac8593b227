import * as THREE from "three";
import { stageChart } from "./charts";
import { announce, h } from "./dom";
import { grouped, length, short } from "./format";
import { obliquePose } from "./framing";
import { centerMessage, section, type Layout } from "./layout";
import { LiveLayer } from "./live_layer";
import {
  control,
  liveCloud,
  liveImage,
  liveMask,
  livePoints,
  liveState,
  type LiveState,
} from "./live_source";
import { LiveStrip } from "./live_strip";
import { followTheme } from "./theme";
import { Viewport } from "./viewport";
import { viewportKeys } from "./viewport_keys";

const POLL_MS = 130;
/** Between two requests, for the page to draw. */
const MIN_WAIT_MS = 20;
/** How far behind the camera the view follows it, units of the world. */
const BEHIND = 22;
const ABOVE = 14;

const STATES: Record<LiveState["state"], string> = {
  initializing: "looking for a first motion",
  tracking: "tracking",
  lost: "lost",
  finishing: "finishing the map",
};

/** What the run does, in a few words. */
function statusOf(state: LiveState): string {
  const { progress } = state;
  if (state.state !== "finishing" || !progress) return STATES[state.state];
  return `${progress.what}: ${progress.done} of ${progress.count} ${progress.ofWhat}`;
}

/** What is around the path and belongs to it, units of the world. */
const SURROUNDINGS = 8;

/** The page of a run that goes on. */
export class LiveViewer {
  private readonly viewport: Viewport;
  private readonly layer = new LiveLayer();
  private readonly strip = new LiveStrip(() => this.makeRoom());
  private readonly facts = h("dl", { class: "tiles" });
  private readonly times = h("div");
  private readonly follow = h("input", { type: "checkbox", checked: true });
  private readonly pause = h(
    "button",
    { type: "button", onclick: () => this.togglePause() },
    "Pause",
  );
  private readonly buttons: HTMLButtonElement[];
  private revision = 0; // of poses and landmarks
  private numViews = 0; // of the dense cloud
  private hasMask = false;
  private last: LiveState | null = null;
  private isPaused = false;
  private hasEnded = false;

  constructor(private readonly page: Layout) {
    this.viewport = new Viewport(page.canvas);
    this.viewport.overlay.add(this.layer.group);
    this.viewport.points.add(this.layer.cloud.group);
    this.viewport.onResize = (width, height) => {
      this.layer.resize(width, height);
      this.makeRoom();
    };
    page.canvas.setAttribute(
      "aria-label",
      "3D view of the run. Arrow keys turn, W A S D move, plus and minus zoom.",
    );
    this.layer.resize(page.stage.clientWidth, page.stage.clientHeight);
    this.viewport.setExtent(this.layer.extent);
    this.viewport.setPose({
      eye: new THREE.Vector3(-BEHIND, 0, ABOVE),
      target: new THREE.Vector3(),
    });
    this.viewport.controls.addEventListener("start", () => (this.follow.checked = false));
    followTheme((colors) => {
      this.viewport.background.set(colors.background);
      this.layer.setColors(colors);
      this.viewport.invalidate();
    });
    const action = (name: "step" | "finish", text: string): HTMLButtonElement =>
      h("button", { type: "button", onclick: () => void this.ask(name) }, text);
    this.buttons = [this.pause, action("step", "One frame"), action("finish", "Finish early")];
    this.fillPage();
    void this.poll();
  }

  /** Handles a key; true if it had a meaning. */
  key(event: KeyboardEvent): boolean {
    const action = viewportKeys(this.viewport)[
      event.key.length === 1 ? event.key.toLowerCase() : event.key
    ];
    if (!action) return false;
    this.follow.checked = false;
    action();
    return true;
  }

  private fillPage(): void {
    const { page } = this;
    document.title = "Live · orb360";
    page.title.textContent = "live";
    page.progress.hidden = true;
    page.center.replaceChildren(
      centerMessage("Waiting for the first frame", "The run has just begun."),
    );
    page.stage.append(this.strip.element);
    page.panelBody.append(
      section(
        "Run",
        true,
        h("div", { class: "live-buttons" }, ...this.buttons),
        this.facts,
        h("label", { class: "check" }, this.follow, h("span", {}, "Follow the camera")),
      ),
      section("Time of a frame", true, this.times),
    );
  }

  private async ask(action: "pause" | "resume" | "step" | "finish"): Promise<void> {
    try {
      await control(action);
      this.say(null);
      announce(action);
    } catch (error) {
      this.say((error as Error).message);
    }
  }

  private togglePause(): void {
    void this.ask(this.isPaused ? "resume" : "pause");
  }

  private say(text: string | null): void {
    this.page.banner.hidden = text === null;
    this.page.banner.textContent = text ?? "";
  }

  private async poll(): Promise<void> {
    const begin = performance.now();
    try {
      await this.update(await liveState(this.revision));
      // What an action has brought stays until the next.
      if (this.hasEnded) this.say(null);
      document.body.dataset.connection = "connected";
      this.hasEnded = false;
    } catch {
      if (!this.hasEnded) {
        this.hasEnded = true;
        document.body.dataset.connection = "lost";
        this.say("The run has ended, or does not answer. `orb360 view` shows the finished run.");
        this.page.chip.textContent = "ended";
        for (const button of this.buttons) button.disabled = true;
      }
    }
    // What the next answer shows was copied soon after this one was asked for.
    const interval = this.hasEnded ? 5 * POLL_MS : POLL_MS;
    const wait = Math.max(MIN_WAIT_MS, interval - (performance.now() - begin));
    setTimeout(() => void this.poll(), wait);
  }

  private async update(state: LiveState): Promise<void> {
    const begin = performance.now();
    const { dataset } = this.page.canvas;
    for (const button of this.buttons) button.disabled = state.state === "finishing";
    this.isPaused = state.isPaused;
    this.pause.textContent = state.isPaused ? "Go on" : "Pause";
    if (state.size[0] === 0) return; // no frame yet
    if (state.state !== this.last?.state) announce(STATES[state.state]);
    if (state.revision < this.revision) this.forget();
    if (state.state === "finishing" && this.last?.state !== "finishing") this.finishing();
    const isNew =
      state.frame !== this.last?.frame ||
      state.revision !== this.revision ||
      state.views !== this.numViews ||
      (state.pose === null) !== (this.last.pose === null);
    this.last = state;
    this.page.center.replaceChildren();
    const isTracking = state.state !== "finishing";
    if (state.isMasked && !this.hasMask) {
      this.hasMask = true;
      await this.strip.setMask(await liveMask());
    }
    if (isTracking && state.frame !== this.strip.frame) {
      await this.strip.show(await liveImage());
      dataset.latency = (state.age + performance.now() - begin).toFixed(0);
    }
    if (isNew) this.layer.setState(state);
    if (state.revision > this.revision) {
      const { revision, groups } = await livePoints(this.revision);
      this.layer.setLandmarks(groups);
      // The poses are those of the state, which may be older than the landmarks.
      this.revision = Math.min(revision, state.revision);
    }
    if (state.views > this.numViews) {
      const part = await liveCloud(this.numViews);
      this.layer.addViews(part);
      this.numViews = part.numViews;
    }
    if (isTracking && this.follow.checked && state.pose) this.followCamera(state.pose);
    this.viewport.setExtent(this.layer.extent);
    this.showFacts(state);
    dataset.keyframes = String(this.layer.numKeyframes);
    dataset.landmarks = String(state.landmarks);
    dataset.frame = String(state.frame);
    dataset.imageFrame = String(this.strip.frame);
    dataset.waiting = String(state.isWaiting);
    dataset.densePoints = String(this.layer.cloud.count);
    document.body.dataset.state = "ready";
    if (isNew) this.viewport.invalidate();
  }

  private forget(): void {
    this.layer.clear();
    this.revision = 0;
    this.numViews = 0;
    this.strip.frame = -1;
    this.hasMask = false;
  }

  /** The camera has stopped: the whole path is shown, and its cloud in place of the image. */
  private finishing(): void {
    this.strip.element.hidden = true;
    this.makeRoom();
    const box = this.layer.box();
    if (!this.follow.checked || box.isEmpty()) return;
    this.viewport.setExtent(this.layer.extent);
    this.viewport.flyTo(obliquePose(box.expandByScalar(SURROUNDINGS), this.viewport.camera));
  }

  private followCamera(pose: number[]): void {
    const target = new THREE.Vector3(pose[0], pose[1], pose[2]);
    const forward = new THREE.Vector3(0, 0, 1).applyQuaternion(
      new THREE.Quaternion(pose[3], pose[4], pose[5], pose[6]),
    );
    forward.setZ(0).normalize();
    const eye = target
      .clone()
      .addScaledVector(forward, -BEHIND)
      .add(new THREE.Vector3(0, 0, ABOVE));
    this.viewport.setPose({ eye, target });
  }

  /** Moves the middle of the view out of the image's way. */
  private makeRoom(): void {
    this.viewport.setShift(0, this.strip.element.offsetHeight / 2);
  }

  private showFacts(state: LiveState): void {
    const tile = (value: string, name: string): HTMLElement =>
      h("div", { class: "tile" }, h("dt", {}, name), h("dd", {}, value));
    this.facts.replaceChildren(
      tile(grouped(state.frame), "frame"),
      tile(`${state.time.toFixed(1)} s`, "time in the input"),
      tile(grouped(this.layer.numKeyframes), "keyframes"),
      tile(grouped(state.landmarks), "landmarks"),
      ...(state.views > 0 ? [tile(short(this.layer.cloud.count), "points of depth maps")] : []),
      tile(this.strip.matched, "features matched"),
      tile(grouped(state.loops.length), "loops closed"),
      tile(
        state.cameraHeight === null ? "unknown" : length(state.cameraHeight, "m"),
        "camera height",
      ),
    );
    const times = stageChart(
      state.times,
      "Median · 95th percentile of the last 300 frames. Stages may overlap.",
    );
    this.times.replaceChildren(...(times ? [times] : []));
    const { chip } = this.page;
    chip.hidden = false;
    const isPaused = state.isPaused && state.state !== "finishing";
    chip.textContent = isPaused ? "paused" : statusOf(state);
    chip.className = `chip ${state.state === "tracking" && !isPaused ? "metric" : "rough"}`;
    chip.title =
      state.cameraHeight === null
        ? "The ground is not known yet: lengths have no unit."
        : "Lengths are in metres.";
  }
}
