import { h } from "./dom";
import { grouped } from "./format";
import type { LiveImage } from "./live_source";

const MATCHED = "#4be08a";
const UNMATCHED = "#ffffff90";
/** Opacity of what is left out, of 255. */
const SHADE = 160;

/** The present image of a run with its features. */
export class LiveStrip {
  private readonly canvas = h("canvas", {
    role: "img",
    "aria-label": "Present image with its features: those that agree with the map are filled; what is left out is dark",
  });
  readonly element = h("div", { class: "live-image", hidden: true }, this.canvas);
  // Drawn by the processor: a graphics card takes a second for thousands of small circles where it is
  // emulated, and the page would stand still meanwhile.
  private readonly context = this.canvas.getContext("2d", { willReadFrequently: true })!;
  /** Index of the frame that is shown; -1: none. */
  frame = -1;
  /** Darkens what is left out; of the size of an image or smaller. */
  private shade: HTMLCanvasElement | null = null;
  /** Matched features in words. */
  matched = "";

  /** `onAppear` is called when the first image takes its room. */
  constructor(private readonly onAppear: () => void) {}

  async show({ frame, features, jpeg }: LiveImage): Promise<void> {
    const image = await createImageBitmap(new Blob([jpeg], { type: "image/jpeg" }));
    this.frame = frame;
    const numMatched = features.filter((value, i) => i % 3 === 2 && value === 1).length;
    this.matched = `${grouped(numMatched)} of ${grouped(features.length / 3)}`;
    this.canvas.width = image.width;
    this.canvas.height = image.height;
    this.context.drawImage(image, 0, 0);
    if (this.shade) this.context.drawImage(this.shade, 0, 0, image.width, image.height);
    image.close();
    if (this.element.hidden) {
      this.element.hidden = false;
      this.onAppear();
    }
    this.drawFeatures(features);
  }

  /** `mask` is black where nothing is looked for. */
  async setMask(mask: Blob): Promise<void> {
    const image = await createImageBitmap(mask);
    const shade = h("canvas", { width: image.width, height: image.height });
    const context = shade.getContext("2d", { willReadFrequently: true })!;
    context.drawImage(image, 0, 0);
    const pixels = context.getImageData(0, 0, image.width, image.height);
    for (let i = 0; i < pixels.data.length; i += 4) {
      const isLeftOut = pixels.data[i] < 128;
      pixels.data.set([0, 0, 0, isLeftOut ? SHADE : 0], i);
    }
    context.putImageData(pixels, 0, 0);
    image.close();
    this.shade = shade;
  }

  private drawFeatures(features: Float32Array): void {
    const { canvas, context } = this;
    const { width, height } = canvas;
    const radius = Math.max(2, width / 400);
    for (let i = 0; i < features.length; i += 3) {
      const isMatched = features[i + 2] === 1;
      context.beginPath();
      context.arc(features[i] * width, features[i + 1] * height, radius, 0, 2 * Math.PI);
      context.fillStyle = context.strokeStyle = isMatched ? MATCHED : UNMATCHED;
      if (isMatched) context.fill();
      else context.stroke();
    }
  }
}
