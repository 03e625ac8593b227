import type { Comparison, Run } from "./run";

/** As slam/viewer/comparison.cc pairs times, with the rounding of run.json; seconds. */
const MAX_DIFFERENCE = 0.02 + 2e-5;

/** For each frame of a run its error; null where the other path has no pose at its time. */
export function errorOfFrames(run: Run, comparison: Comparison): (number | null)[] {
  const { time, error } = comparison;
  let i = 0;
  return run.frames.time.map((t) => {
    while (i + 1 < time.length && Math.abs(time[i + 1] - t) <= Math.abs(time[i] - t)) ++i;
    return time.length > 0 && Math.abs(time[i] - t) <= MAX_DIFFERENCE ? error[i] : null;
  });
}

/** What the other path is, in a few words. */
export function otherName(comparison: Comparison): string {
  return comparison.isTruth ? "Ground truth" : "Other run";
}

/** How both paths were aligned, and with what. */
export function describeAlignment(run: Run, comparison: Comparison): string {
  const other = `${comparison.isTruth ? "ground truth" : "the run"} ${comparison.name}`;
  if (comparison.isRigid) {
    return `Compared with ${other}. Both are in metres: a rigid motion, SE(3), aligns them.`;
  }
  const unknown =
    run.unit === "m" ? "The other run" : comparison.unit === "m" ? "This run" : "Neither run";
  const verb = unknown === "Neither run" ? "has" : "has no";
  return (
    `Compared with ${other}. ${unknown} ${verb} metres: a similarity, Sim(3), aligns them, ` +
    `with ${comparison.scale.toPrecision(4)} units of this run for one of the other.`
  );
}
