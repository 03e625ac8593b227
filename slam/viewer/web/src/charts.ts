import { h, svg } from "./dom";
import type { Run } from "./run";

const STAGES: Record<string, string> = {
  frame: "Whole frame",
  extraction: "Features",
  tracking: "Tracking",
  adoption: "Waiting for mapping",
};

/** Time of a frame by stage: the median as a bar, up to the 95th percentile as a thin one. */
export function stageChart(run: Run): HTMLElement | null {
  const times = Object.entries(run.summary.timing_ms ?? {});
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
    h("p", { class: "caption" }, "Median · 95th percentile of the frames. Stages may overlap."),
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

/** The scale along the path with its standard deviation. */
export function scaleChart(run: Run): HTMLElement | null {
  const { time, value, sigma } = run.scale;
  if (time.length < 2) return null;
  const [width, height, left, bottom, top] = [300, 130, 38, 18, 6];
  const low = Math.min(...value.map((v, i) => v * Math.exp(-sigma[i])), 0.99);
  const high = Math.max(...value.map((v, i) => v * Math.exp(sigma[i])), 1.01);
  const x = (t: number): number =>
    left + ((t - time[0]) / Math.max(time[time.length - 1] - time[0], 1e-9)) * (width - left - 4);
  const y = (v: number): number => top + ((high - v) / (high - low)) * (height - top - bottom);
  const at = (v: (i: number) => number, i: number): string =>
    `${x(time[i]).toFixed(1)},${y(v(i)).toFixed(1)}`;
  const order = time.map((_, i) => i);
  const upper = order.map((i) => at((j) => value[j] * Math.exp(sigma[j]), i));
  const lower = order.map((i) => at((j) => value[j] * Math.exp(-sigma[j]), i)).reverse();
  const line = order.map((i) => at((j) => value[j], i)).join(" ");
  const decimals = high - low < 0.05 ? 3 : 2;
  const grid = ticksBetween(low, high).flatMap((tick) => [
    svg("line", {
      class: tick === 1 ? "grid one" : "grid",
      x1: left,
      x2: width,
      y1: y(tick),
      y2: y(tick),
    }),
    svg("text", { x: left - 5, y: y(tick) + 3.5, "text-anchor": "end" }, tick.toFixed(decimals)),
  ]);
  const times = ticksBetween(time[0], time[time.length - 1]).map((tick) =>
    svg(
      "text",
      { x: x(tick), y: height - 4, "text-anchor": "middle" },
      `${tick.toFixed(tick % 1 ? 1 : 0)} s`,
    ),
  );
  const spread = `${low.toFixed(3)} to ${high.toFixed(3)}`;
  return h(
    "div",
    { class: "chart" },
    svg(
      "svg",
      {
        viewBox: `0 0 ${width} ${height}`,
        role: "img",
        "aria-label": `Metres in a unit along the path, with standard deviation: ${spread}`,
      },
      ...grid,
      ...times,
      svg("polygon", { class: "band", points: [...upper, ...lower].join(" ") }),
      svg("polyline", { class: "line", points: line }),
    ) as unknown as Node,
    h(
      "p",
      { class: "caption" },
      "Estimated metres in a unit of the map along the path, ± one standard deviation. 1 is a map that is right.",
    ),
  );
}
