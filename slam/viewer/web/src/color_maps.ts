/** Perceptually uniform colour maps: stops at equal distances, between which colours are linear. */

/** viridis, by S. van der Walt and N. Smith. */
const VIRIDIS = "440154 482878 3e4989 31688e 26828e 1f9e89 35b779 6ece58 b5de2b fde725";
/** cividis, by J. Nunez and others: it looks the same to people who confuse red and green. */
const CIVIDIS = "00224e 123570 3b496c 575d6d 707173 8a8678 a59c74 c3b369 e1cc55 fee838";
/** magma, by S. van der Walt and N. Smith, without its darkest part. */
const MAGMA = "2c115f 51127c 721f81 932b80 b73779 d8456c f1605d fb8861 fec287 fcfdbf";
/** plasma, by the same, without its darkest part: for lines over dark and light backgrounds. */
const PLASMA = "7201a8 9c179e bd3786 d8576b ed7953 fb9f3a fdca26 f0f921";

export type ColorMapName = "viridis" | "cividis" | "magma" | "plasma";

const STOPS: Record<ColorMapName, string> = {
  viridis: VIRIDIS,
  cividis: CIVIDIS,
  magma: MAGMA,
  plasma: PLASMA,
};

function stopsOf(name: ColorMapName): [number, number, number][] {
  return STOPS[name].split(" ").map((hex) => {
    const value = parseInt(hex, 16);
    return [value >> 16, (value >> 8) & 255, value & 255];
  });
}

/** Red, green, blue in 0..255 at a place in 0..1. */
export function colorAt(name: ColorMapName, place: number): [number, number, number] {
  const stops = stopsOf(name);
  const at = Math.min(Math.max(place, 0), 1) * (stops.length - 1);
  const i = Math.min(Math.floor(at), stops.length - 2);
  const [a, b] = [stops[i], stops[i + 1]];
  return [0, 1, 2].map((c) => Math.round(a[c] + (b[c] - a[c]) * (at - i))) as [
    number,
    number,
    number,
  ];
}

/** 256 colours, RGBA. */
export function colorTable(name: ColorMapName): Uint8Array {
  const table = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; ++i) table.set([...colorAt(name, i / 255), 255], 4 * i);
  return table;
}

export function cssGradient(name: ColorMapName): string {
  return `linear-gradient(to right, ${stopsOf(name)
    .map((c) => `rgb(${c.join(",")})`)
    .join(", ")})`;
}
