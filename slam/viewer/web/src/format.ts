/** Numbers as the page writes them. */

const GROUPED = new Intl.NumberFormat("en", { maximumFractionDigits: 0 });

export function grouped(value: number): string {
  return GROUPED.format(value);
}

/** 1234567 as "1.2 M". */
export function short(value: number): string {
  if (value >= 1e6) return `${(value / 1e6).toFixed(value >= 1e7 ? 0 : 1)} M`;
  if (value >= 1e4) return `${(value / 1e3).toFixed(0)} k`;
  return grouped(value);
}

/** A length with its unit: centimetres where it is short. */
export function length(value: number, unit: "m" | "units"): string {
  const size = Math.abs(value);
  const sign = value < 0 ? "−" : "";
  if (unit === "m" && size < 1) return `${sign}${(100 * size).toFixed(size < 0.1 ? 1 : 0)} cm`;
  return `${sign}${size.toFixed(size < 100 ? 2 : 1)} ${unit}`;
}

/** A length with the standard deviation that the scale gives it. */
export function uncertainLength(value: number, unit: "m" | "units", sigma: number | null): string {
  if (sigma === null) return length(value, unit);
  return `${length(value, unit)} ± ${length(Math.abs(value) * sigma, unit)}`;
}

export function percent(fraction: number): string {
  return `${(100 * fraction).toFixed(1)}\u00a0%`;
}

export function duration(seconds: number): string {
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  return `${Math.floor(seconds / 60)} min ${Math.round(seconds % 60)} s`;
}
