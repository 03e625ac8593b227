import { h } from "./dom";
import { duration, grouped, length, percent, short } from "./format";
import { pathLength, type Run } from "./run";

/** The state of the scale in a word, and in a sentence. */
export function scaleState(run: Run): { state: string; chip: string; sentence: string } {
  const scale = run.summary.scale;
  const state = scale?.state ?? "unknown";
  const sigma = scale?.sigma;
  if (state === "unknown" || sigma == null) {
    return {
      state: "unknown",
      chip: "scale unknown",
      sentence:
        "Nothing tells the scale of this run well enough. Lengths are in units of the map, " +
        "which are not metres.",
    };
  }
  const from = (scale?.sources ?? []).join(" and ");
  const height =
    scale?.camera_height == null
      ? ""
      : ` ${scale.assumed_height ? "A camera height of" : "The camera height is"} ` +
        `${scale.camera_height.toFixed(2)} m${scale.assumed_height ? " was assumed" : ""}.`;
  return {
    state,
    chip: `${state} ± ${percent(sigma)}`,
    sentence:
      `Metres have a standard deviation of ${percent(sigma)}` +
      `${from ? `, from ${from}` : ""}.${height}`,
  };
}

function tile(value: string, name: string): HTMLElement {
  return h("div", { class: "tile" }, h("dt", {}, name), h("dd", {}, value));
}

/** The figures of a run. */
export function factTiles(run: Run): HTMLElement {
  const s = run.summary;
  const tiles: HTMLElement[] = [];
  const add = (value: string | null, name: string): void => {
    if (value !== null) tiles.push(tile(value, name));
  };
  const number = (value: number | undefined): string | null =>
    value === undefined ? null : grouped(value);
  if (s.frames) add(percent((s.tracked ?? 0) / s.frames), `of ${grouped(s.frames)} frames tracked`);
  if (run.frames.index.length > 1) add(length(pathLength(run), run.unit), "path");
  add(number(s.keyframes), "keyframes");
  add(s.landmarks === undefined ? null : short(s.landmarks), "landmarks");
  add(number(s.loops), s.loops === 1 ? "loop closed" : "loops closed");
  add(number(s.lost), "times lost");
  if (s.cloud?.points) add(short(s.cloud.points), "points in the cloud");
  const { comparison } = run;
  if (comparison) {
    add(length(comparison.rmse, comparison.unit), "absolute trajectory error (root mean square)");
    add(length(comparison.max, comparison.unit), "largest error of a position");
  }
  if ((s.maps ?? 1) > 1) add(number(s.maps), "maps");
  if (s.frames_per_second) add(s.frames_per_second.toFixed(1), "frames a second");
  if (s.seconds !== undefined) add(duration(s.seconds), "tracking and mapping");
  if (s.cloud?.seconds) add(duration(s.cloud.seconds), "dense depth and cloud");
  if (s.peak_memory_mb) add(`${grouped(s.peak_memory_mb)} MB`, "memory at most");
  return h("dl", { class: "tiles" }, ...tiles);
}

/** Warnings of the run, and what the folder lacks. */
export function notes(run: Run): HTMLElement | null {
  const warnings = [...(run.summary.warnings ?? [])];
  if (run.summary.interrupted) warnings.unshift("The run ended early.");
  if (run.summary.positions?.failure) warnings.push(`Positions: ${run.summary.positions.failure}`);
  if (warnings.length + run.missing.length === 0) return null;
  return h(
    "ul",
    { class: "notes" },
    ...warnings.map((text) => h("li", { class: "warning" }, text)),
    ...run.missing.map((text) => h("li", {}, text)),
  );
}
