/** Range and confidence of a view, as slam/viewer/view_files.h describes them. */
export class ViewRange {
  readonly width: number;
  readonly height: number;
  private readonly codes: Uint16Array;
  private readonly confidences: Uint8Array;

  constructor(bytes: ArrayBuffer) {
    const view = new DataView(bytes);
    if (bytes.byteLength < 8) throw new Error("the ranges of this view are truncated");
    this.width = view.getUint32(0, true);
    this.height = view.getUint32(4, true);
    const count = this.width * this.height;
    if (bytes.byteLength !== 8 + 3 * count)
      throw new Error("the ranges of this view are truncated");
    this.codes = new Uint16Array(bytes, 8, count);
    this.confidences = new Uint8Array(bytes, 8 + 2 * count, count);
  }

  /**
   * Range in units of the world at a place of the panorama in 0..1, and the relative error to be
   * expected, beside that of the scale; null where there is none.
   */
  at(u: number, v: number): { range: number; confidence: number; error: number } | null {
    const i = this.indexAt(u, v);
    if (this.codes[i] === 0) return null;
    const confidence = this.confidences[i] / 255;
    return { range: rangeOf(this.codes[i]), confidence, error: 1 / confidence - 1 };
  }

  /** Ranges that 2 % and 98 % of the pixels do not exceed. */
  limits(): [number, number] {
    const known = this.codes.filter((code) => code > 0).sort();
    if (known.length === 0) return [1, 10];
    const at = (fraction: number): number =>
      rangeOf(known[Math.floor(fraction * (known.length - 1))]);
    return [at(0.02), at(0.98)];
  }

  /**
   * For the graphics card, RG: place of the range's logarithm in `limits`, 0 for none; confidence.
   */
  texels(limits: [number, number]): Uint8Array {
    const [low, high] = limits.map((range) => codeOf(range));
    const texels = new Uint8Array(2 * this.codes.length);
    for (let i = 0; i < this.codes.length; ++i) {
      if (this.codes[i] === 0) continue;
      const place = (this.codes[i] - low) / Math.max(high - low, 1);
      texels[2 * i] = 1 + Math.round(254 * Math.min(Math.max(place, 0), 1));
      texels[2 * i + 1] = this.confidences[i];
    }
    return texels;
  }

  private indexAt(u: number, v: number): number {
    const x = Math.min(Math.floor((u - Math.floor(u)) * this.width), this.width - 1);
    const y = Math.min(Math.max(Math.floor(v * this.height), 0), this.height - 1);
    return y * this.width + x;
  }
}

function rangeOf(code: number): number {
  return Math.exp((code - 32768) / 1024);
}

function codeOf(range: number): number {
  return 32768 + 1024 * Math.log(range);
}
