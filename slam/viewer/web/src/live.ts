import * as THREE from "three";
import { announce, h } from "./dom";
import { grouped, length } from "./format";
import { centerMessage, section, type Layout } from "./layout";
import { LiveLayer } from "./live_layer";
import {
  control,
  liveImage,
  livePoints,
  liveState,
  type LiveImage,
  type LiveState,
} from "./live_source";
import { followTheme } from "./theme";
import { Viewport } from "./viewport";
import { viewportKeys } from "./viewport_keys";

const POLL_MS = 200;
/** How far behind the camera the view follows it, units of the world. */
const BEHIND = 22;
const ABOVE = 14;

const STATES: Record<LiveState["state"], string> = {
  initializing: "looking for a first motion",
  tracking: "tracking",
  lost: "lost",
  finishing: "finishing: map and cloud",
};

/** Least extent that is shown, units of the world. */
const MIN_EXTENT = 200;

/** The page of a run that goes on. */
export class LiveViewer {
  private readonly viewport: Viewport;
  private readonly layer = new LiveLayer();
  private readonly image = h("canvas", {
    role: "img",
    "aria-label": "Present image with its features: those that agree with the map are filled",
  });
  private readonly strip = h("div", { class: "live-image", hidden: true }, this.image);
  private readonly facts = h("dl", { class: "tiles" });
  private readonly follow = h("input", { type: "checkbox", checked: true });
  private readonly pause = h(
    "button",
    { type: "button", onclick: () => this.togglePause() },
    "Pause",
  );
  private readonly buttons: HTMLButtonElement[];
  private revision = 0;
  private shownMap = -1;
  private last: LiveState | null = null;
  private shownFrame = -1; // of the image
  private matched = ""; // features, as text
  private hasEnded = false;

  constructor(private readonly page: Layout) {
    this.viewport = new Viewport(page.canvas);
    this.viewport.overlay.add(this.layer.group);
    this.viewport.onResize = (width, height) => {
      this.layer.resize(width, height);
      this.makeRoom();
    };
    page.canvas.setAttribute(
      "aria-label",
      "3D view of the run. Arrow keys turn, W A S D move, plus and minus zoom.",
    );
    this.layer.resize(page.stage.clientWidth, page.stage.clientHeight);
    this.viewport.setExtent(MIN_EXTENT);
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
    page.stage.append(this.strip);
    page.panelBody.append(
      section(
        "Run",
        true,
        h("div", { class: "live-buttons" }, ...this.buttons),
        this.facts,
        h("label", { class: "check" }, this.follow, h("span", {}, "Follow the camera")),
      ),
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
    void this.ask(this.last?.isPaused ? "resume" : "pause");
  }

  private say(text: string | null): void {
    this.page.banner.hidden = text === null;
    this.page.banner.textContent = text ?? "";
  }

  private async poll(): Promise<void> {
    try {
      await this.update(await liveState());
      // What an action has brought stays until the next.
      if (this.hasEnded) this.say(null);
      document.body.dataset.connection = "connected";
      this.hasEnded = false;
    } catch {
      if (!this.hasEnded) {
        this.hasEnded = true;
        document.body.dataset.connection = "lost";
        this.say("The run has ended, or does not answer. `orb360 view` shows the finished run.");
      }
    }
    setTimeout(() => void this.poll(), this.hasEnded ? 5 * POLL_MS : POLL_MS);
  }

  private async update(state: LiveState): Promise<void> {
    for (const button of this.buttons) button.disabled = state.state === "finishing";
    if (state.size[0] === 0) return;
    if (state.state !== this.last?.state) announce(STATES[state.state]);
    this.last = state;
    document.body.dataset.state = "ready";
    this.page.center.replaceChildren();
    if (state.revision !== this.revision || state.map !== this.shownMap) {
      const points = await livePoints();
      this.layer.setLandmarks(points);
      this.revision = points.revision;
      this.shownMap = state.map;
    }
    this.layer.setState(state);
    if (this.follow.checked && state.pose) this.followCamera(state.pose);
    this.fitExtent(state);
    if (state.frame !== this.shownFrame) await this.showImage(await liveImage());
    this.showFacts(state);
    this.page.canvas.dataset.keyframes = String(state.keyframes.length);
    this.page.canvas.dataset.landmarks = String(state.landmarks);
    this.page.canvas.dataset.frame = String(state.frame);
    this.viewport.invalidate();
  }

  /** Near and far planes have to hold the whole map. */
  private fitExtent(state: LiveState): void {
    const box = new THREE.Box3();
    for (const keyframe of state.keyframes) {
      box.expandByPoint(new THREE.Vector3(keyframe[2], keyframe[3], keyframe[4]));
    }
    const size = box.isEmpty() ? 0 : box.getSize(new THREE.Vector3()).length();
    // Landmarks lie around the path.
    this.viewport.setExtent(Math.max(MIN_EXTENT, 2 * size));
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
    this.viewport.setShift(0, this.strip.offsetHeight / 2);
  }

  private showFacts(state: LiveState): void {
    const tile = (value: string, name: string): HTMLElement =>
      h("div", { class: "tile" }, h("dt", {}, name), h("dd", {}, value));
    this.facts.replaceChildren(
      tile(grouped(state.frame), "frame"),
      tile(`${state.time.toFixed(1)} s`, "time in the input"),
      tile(grouped(state.keyframes.length), "keyframes"),
      tile(grouped(state.landmarks), "landmarks"),
      tile(this.matched, "features matched"),
      tile(grouped(state.loops.length), "loops closed"),
      tile(
        state.cameraHeight === null ? "unknown" : length(state.cameraHeight, "m"),
        "camera height",
      ),
    );
    this.pause.textContent = state.isPaused ? "Go on" : "Pause";
    const { chip } = this.page;
    chip.hidden = false;
    const isPaused = state.isPaused && state.state !== "finishing";
    chip.textContent = isPaused ? "paused" : STATES[state.state];
    chip.className = `chip ${state.state === "tracking" && !isPaused ? "metric" : "rough"}`;
    chip.title =
      state.cameraHeight === null
        ? "The ground is not known yet: lengths have no unit."
        : "Lengths are in metres.";
  }

  private async showImage({ frame, features, jpeg }: LiveImage): Promise<void> {
    const image = await createImageBitmap(new Blob([jpeg], { type: "image/jpeg" }));
    this.shownFrame = frame;
    const numMatched = features.filter((value, i) => i % 3 === 2 && value === 1).length;
    this.matched = `${grouped(numMatched)} of ${grouped(features.length / 3)}`;
    this.page.canvas.dataset.imageFrame = String(frame);
    const context = this.image.getContext("2d")!;
    this.image.width = image.width;
    this.image.height = image.height;
    context.drawImage(image, 0, 0);
    image.close();
    if (this.strip.hidden) {
      this.strip.hidden = false;
      this.makeRoom();
    }
    const { width, height } = this.image;
    const radius = Math.max(2, width / 400);
    for (let i = 0; i < features.length; i += 3) {
      context.beginPath();
      context.arc(
        features[i] * width,
        features[i + 1] * height,
        radius,
        0,
        2 * Math.PI,
      );
      context.fillStyle = context.strokeStyle =
        features[i + 2] === 1 ? "#4be08a" : "#ffffff90";
      if (features[i + 2] === 1) context.fill();
      else context.stroke();
    }
  }
}
