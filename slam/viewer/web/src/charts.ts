import { h, svg } from "./dom";
import type { Comparison, Run, StageTimes } from "./run";

const STAGES: Record<string, string> = {
  frame: "Whole frame",
  extraction: "Features",
  tracking: "Tracking",
  adoption: "Waiting for mapping",
};

/** Time of a frame by stage: the median as a bar, up to the 95th percentile as a thin one. */
export function stageChart(stages: StageTimes, caption: string): HTMLElement | null {
  const times = Object.entries(stages);
  if (times.length === 0) return null;
  times.sort(([, a], [, b]) => b.p95 - a.p95);
  const longest = Math.max(...times.map(([, time]) => time.p95), 1e-9);
  const rows = times.map(([stage, { median, p95 }]) => {
    const width = (value: number): string => `width: ${((100 * value) / longest).toFixed(1)}%`;
    return h(
      "div",
      { class: "bar-row" },
      h("span", { class: "bar-name" }, STAGES[stage] ?? stage),
      h("span", { class: "bar-value" }, `${median.toFixed(1)} · ${p95.toFixed(1)} ms`),
      h(
        "span",
        { class: "bar", "aria-hidden": "true" },
        h("i", { class: "p95", style: width(p95) }),
        h("i", { class: "median", style: width(median) }),
      ),
    );
  });
  return h(
    "div",
    { class: "chart" },
    ...rows,
    h("p", { class: "caption" }, caption),
  );
}

/** Round numbers that divide an interval into three or four parts. */
export function ticksBetween(low: number, high: number): number[] {
  const rough = (high - low) / 3;
  if (!(rough > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((digit) => digit * power).find((size) => size >= rough)!;
  const ticks: number[] = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i)
    ticks.push(i * step + 0);
  return ticks;
}

interface TimeChart {
  time: number[];
  low: number;
  high: number;
  /** Text of a value on the axis. */
  text: (value: number) => string;
  label: string;
  caption: string;
  /** What is drawn, given the place of a value at the i-th time. */
  draw: (at: (i: number, value: number) => string) => SVGElement[];
}

/** Axes over time, and what is drawn between them. */
function timeChart({ time, low, high, text, label, caption, draw }: TimeChart): HTMLElement {
  const [width, height, left, bottom, top] = [300, 130, 38, 18, 6];
  const end = time[time.length - 1];
  const x = (t: number): number =>
    left + ((t - time[0]) / Math.max(end - time[0], 1e-9)) * (width - left - 4);
  const y = (v: number): number => top + ((high - v) / (high - low)) * (height - top - bottom);
  const grid = ticksBetween(low, high).flatMap((tick) => [
    svg("line", {
      class: tick === 1 ? "grid one" : "grid",
      x1: left,
      x2: width,
      y1: y(tick),
      y2: y(tick),
    }),
    svg("text", { x: left - 5, y: y(tick) + 3.5, "text-anchor": "end" }, text(tick)),
  ]);
  const times = ticksBetween(time[0], end).map((tick) =>
    svg(
      "text",
      { x: x(tick), y: height - 4, "text-anchor": "middle" },
      `${tick.toFixed(tick % 1 ? 1 : 0)} s`,
    ),
  );
  return h(
    "div",
    { class: "chart" },
    svg(
      "svg",
      { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": label },
      ...grid,
      ...times,
      ...draw((i, value) => `${x(time[i]).toFixed(1)},${y(value).toFixed(1)}`),
    ) as unknown as Node,
    h("p", { class: "caption" }, caption),
  );
}

/** The scale along the path with its standard deviation. */
export function scaleChart(run: Run): HTMLElement | null {
  const { time, value, sigma } = run.scale;
  if (time.length < 2) return null;
  const low = Math.min(...value.map((v, i) => v * Math.exp(-sigma[i])), 0.99);
  const high = Math.max(...value.map((v, i) => v * Math.exp(sigma[i])), 1.01);
  const decimals = high - low < 0.05 ? 3 : 2;
  return timeChart({
    time,
    low,
    high,
    text: (tick) => tick.toFixed(decimals),
    label: `Metres in a unit along the path, with standard deviation: ${low.toFixed(3)} to ${high.toFixed(3)}`,
    caption:
      "Estimated metres in a unit of the map along the path, ± one standard deviation. 1 is a map that is right.",
    draw: (at) => {
      const upper = value.map((v, i) => at(i, v * Math.exp(sigma[i])));
      const lower = value.map((v, i) => at(i, v * Math.exp(-sigma[i]))).reverse();
      const line = value.map((v, i) => at(i, v)).join(" ");
      return [
        svg("polygon", { class: "band", points: [...upper, ...lower].join(" ") }),
        svg("polyline", { class: "line", points: line }),
      ];
    },
  });
}

/** Times without an error for longer than this are a gap, in terms of the median step. */
const GAP_STEPS = 5;

/** The error along the path. */
export function errorChart({ time, error, max, unit }: Comparison): HTMLElement {
  const steps = time.slice(1).map((t, i) => t - time[i]);
  const gap = GAP_STEPS * ([...steps].sort((a, b) => a - b)[steps.length >> 1] ?? 0);
  const isShort = unit === "m" && max < 1;
  const high = Math.max(isShort ? 100 * max : max, 1e-9);
  const symbol = isShort ? "cm" : unit;
  return timeChart({
    time,
    low: 0,
    high,
    text: (tick) => tick.toFixed(high < 1 ? 2 : high < 4 ? 1 : 0),
    label: `Error along the path: at most ${high.toFixed(2)} ${symbol}`,
    caption: `Distance between the positions after the alignment, ${symbol}, over time.`,
    draw: (at) => {
      const lines: string[][] = [[]];
      error.forEach((value, i) => {
        if (i > 0 && steps[i - 1] > gap) lines.push([]);
        lines[lines.length - 1].push(at(i, isShort ? 100 * value : value));
      });
      return lines.map((line) => svg("polyline", { class: "line", points: line.join(" ") }));
    },
  });
}
