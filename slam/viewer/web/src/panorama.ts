import * as THREE from "three";
import { cssGradient } from "./color_maps";
import { h, icon } from "./dom";
import { length, percent, uncertainLength } from "./format";
import { scaleSigma, type Run } from "./run";
import type { Source } from "./source";
import { SphereView, type Overlay } from "./sphere_view";
import { ViewRange } from "./view_range";

const KEY_DEGREES = 8;

export interface PanoramaEvents {
  /** Another keyframe was chosen: -1 the one before, 1 the next. */
  onStep: (by: number) => void;
  onClose: () => void;
  /** The panorama looks in another direction of the optical camera frame of the frame shown. */
  onTurn: (forward: THREE.Vector3, frame: number) => void;
  /** The user wants to be where the keyframe is. */
  onGo: () => void;
}

/** The image of a keyframe, to look around in, with the ranges and confidences of its pixels. */
export class Panorama {
  readonly element: HTMLElement;
  private readonly canvas = h("canvas", {
    tabindex: 0,
    role: "img",
    "aria-label": "Panorama of the keyframe. Arrow keys look around, plus and minus zoom.",
  });
  private readonly title = h("h2", {});
  private readonly readout = h("output", { class: "readout" });
  private readonly legend = h("div", { class: "legend" });
  private readonly notice = h("p", { class: "notice", hidden: true });
  private readonly overlays = new Map<Overlay, HTMLButtonElement>();
  private view: SphereView | null = null;
  private range: ViewRange | null = null;
  private limits: [number, number] = [1, 10];
  private request = 0;
  private shownFrame = 0; // whose image is shown: the nearest view may stand for the keyframe

  constructor(
    private readonly run: Run,
    private readonly source: Source,
    private readonly events: PanoramaEvents,
  ) {
    const segmented = h("div", { class: "segmented", role: "group", "aria-label": "Overlay" });
    for (const overlay of ["image", "range", "confidence"] as const) {
      const button = h(
        "button",
        {
          type: "button",
          "aria-pressed": String(overlay === "image"),
          onclick: () => this.setOverlay(overlay),
        },
        overlay[0].toUpperCase() + overlay.slice(1),
      );
      this.overlays.set(overlay, button);
      segmented.append(button);
    }
    const button = (
      name: Parameters<typeof icon>[0],
      text: string,
      action: () => void,
    ): HTMLElement =>
      h(
        "button",
        { type: "button", class: "icon", title: text, "aria-label": text, onclick: action },
        icon(name),
      );
    this.element = h(
      "section",
      { id: "panorama", hidden: true, "aria-label": "Keyframe" },
      h(
        "header",
        {},
        this.title,
        h("span", { class: "spacer" }),
        button("previous", "Previous keyframe ([)", () => events.onStep(-1)),
        button("next", "Next keyframe (])", () => events.onStep(1)),
        button("go", "Stand there", () => events.onGo()),
        button("close", "Close (Esc)", () => events.onClose()),
      ),
      h("div", { class: "sphere" }, this.canvas, this.notice),
      h("footer", {}, segmented, this.legend, this.readout),
    );
    this.listen();
  }

  get isOpen(): boolean {
    return !this.element.hidden;
  }

  /** Shows a keyframe: its own view, or says why there is none. */
  async show(keyframe: number): Promise<void> {
    const request = ++this.request;
    const frame = this.run.frames.index[this.run.keyframes[keyframe]];
    const time = this.run.frames.time[this.run.keyframes[keyframe]];
    this.title.textContent = `Keyframe ${keyframe + 1} · frame ${frame} · ${time.toFixed(2)} s`;
    this.element.hidden = false;
    this.readout.textContent = "";
    this.range = null;
    const hasImage = this.run.images.includes(frame);
    // The range of another frame would not fit the image of this one.
    const view = hasImage && !this.run.views.includes(frame) ? null : this.viewNearest(frame);
    if (view === null && !hasImage) {
      this.say(
        "This run kept no images. Run it again with --save-views to look around here.",
        true,
      );
      return;
    }
    this.say("Loading the panorama …", this.view === null);
    const image = new Image();
    image.src = hasImage ? this.source.inputImage(frame) : this.source.viewImage(view!);
    try {
      const [range] = await Promise.all([
        view === null ? null : this.source.viewRange(view),
        image.decode(),
      ]);
      if (request !== this.request) return;
      this.range = range && new ViewRange(range);
    } catch (error) {
      if (request === this.request) {
        this.say(`The panorama cannot be loaded: ${(error as Error).message}`, true);
      }
      return;
    }
    this.say(
      view === null
        ? "No range of this keyframe was kept."
        : view === frame
          ? ""
          : `This keyframe has no image of its own; that of frame ${view} is shown.`,
      false,
    );
    this.view ??= new SphereView(this.canvas);
    this.view.setImage(image);
    for (const overlay of ["range", "confidence"] as const) {
      this.overlays.get(overlay)!.disabled = this.range === null;
    }
    if (this.range) {
      this.limits = this.range.limits();
      this.view.setDepth(this.range.texels(this.limits), this.range.width, this.range.height);
    } else this.setOverlay("image");
    this.showLegend();
    this.shownFrame = hasImage ? frame : view!;
    this.turned();
  }

  hide(): void {
    ++this.request;
    this.element.hidden = true;
  }

  setOverlay(overlay: Overlay): void {
    for (const [name, button] of this.overlays) {
      button.setAttribute("aria-pressed", String(name === overlay));
    }
    if (!this.view) return;
    this.view.overlay = overlay;
    this.view.invalidate();
    this.showLegend();
  }

  /** The frame whose image stands for a keyframe: its own, or the nearest. */
  private viewNearest(frame: number): number | null {
    let best: number | null = null;
    for (const view of this.run.views) {
      if (best === null || Math.abs(view - frame) < Math.abs(best - frame)) best = view;
    }
    return best;
  }

  private say(text: string, coversImage: boolean): void {
    this.notice.textContent = text;
    this.notice.hidden = text === "";
    this.notice.classList.toggle("cover", coversImage);
    this.element.classList.toggle("without-image", coversImage);
  }

  private showLegend(): void {
    const overlay = this.view?.overlay ?? "image";
    this.legend.replaceChildren();
    if (overlay === "range") {
      const [near, far] = this.limits.map((range) => length(range, this.run.unit));
      this.legend.append(
        h("span", {}, far),
        h("i", { style: `background: ${cssGradient("viridis")}` }),
        h("span", {}, near),
      );
    } else if (overlay === "confidence") {
      this.legend.append(
        h("span", {}, "0"),
        h("i", { style: `background: ${cssGradient("cividis")}` }),
        h("span", {}, "1"),
      );
    }
  }

  private showReadout(x: number, y: number): void {
    if (!this.view || !this.range) return;
    const ray = this.view.directionAt(x, y);
    const u = 0.5 + Math.atan2(ray.x, ray.z) / (2 * Math.PI);
    const v = 0.5 + Math.asin(Math.min(Math.max(ray.y, -1), 1)) / Math.PI;
    const found = this.range.at(u, v);
    if (!found) {
      this.readout.textContent = "no range here";
      return;
    }
    const error = Math.hypot(scaleSigma(this.run) ?? 0, found.error);
    this.readout.textContent =
      `${uncertainLength(found.range, this.run.unit, error)} away, confidence ` +
      percent(found.confidence);
  }

  private turned(): void {
    if (this.view) this.events.onTurn(this.view.forward(), this.shownFrame);
  }

  private listen(): void {
    const pointers = new Map<number, { x: number; y: number }>();
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    this.canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (before && this.view) {
        const now = { x: event.clientX, y: event.clientY };
        const others = [...pointers].filter(([id]) => id !== event.pointerId).map(([, p]) => p);
        if (others.length > 0) {
          const distance = (p: { x: number; y: number }): number =>
            Math.hypot(p.x - others[0].x, p.y - others[0].y);
          this.view.zoom(distance(before) / Math.max(distance(now), 1));
        } else {
          this.view.drag(now.x - before.x, now.y - before.y);
        }
        pointers.set(event.pointerId, now);
        this.turned();
      }
      const box = this.canvas.getBoundingClientRect();
      this.showReadout(event.clientX - box.left, event.clientY - box.top);
    });
    const release = (event: PointerEvent): void => void pointers.delete(event.pointerId);
    this.canvas.addEventListener("pointerup", release);
    this.canvas.addEventListener("pointercancel", release);
    this.canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.view?.zoom(Math.exp(0.001 * event.deltaY));
      },
      { passive: false },
    );
    this.canvas.addEventListener("keydown", (event) => this.pressed(event));
  }

  private pressed(event: KeyboardEvent): void {
    if (!this.view) return;
    const step = this.canvas.clientHeight * (KEY_DEGREES / this.view.fieldOfView);
    const moves: Record<string, [number, number]> = {
      ArrowLeft: [step, 0],
      ArrowRight: [-step, 0],
      ArrowUp: [0, step],
      ArrowDown: [0, -step],
    };
    if (event.key in moves) this.view.drag(...moves[event.key]);
    else if (event.key === "+" || event.key === "=") this.view.zoom(0.85);
    else if (event.key === "-") this.view.zoom(1 / 0.85);
    else return;
    event.preventDefault();
    event.stopPropagation();
    this.turned();
    this.showReadout(this.canvas.clientWidth / 2, this.canvas.clientHeight / 2);
  }
}
