/** What `run.json` has of a run (slam/viewer/run_scene.h). */
/** Wall times of frames by stage, ms. */
export type StageTimes = Record<string, { median: number; p95: number }>;

export interface Run {
  folder: string;
  summary: Summary;
  unit: "m" | "units";
  hasCloud: boolean;
  /** Of the dense cloud as it is, units; null for landmarks. */
  voxelSize: number | null;
  frames: {
    index: number[];
    time: number[];
    map: number[];
    position: number[];
    orientation: number[];
  };
  keyframes: number[];
  links: number[];
  loops: [number, number][];
  scale: { time: number[]; value: number[]; sigma: number[] };
  /** Frames whose image the input still has, and those whose image and range the run kept. */
  images: number[];
  views: number[];
  missing: string[];
  /** With another path. */
  comparison?: Comparison | null;
}

/** A run against another path (slam/viewer/comparison.h). */
export interface Comparison {
  name: string;
  isTruth: boolean;
  isRigid: boolean;
  /** Of the similarity from the other world to that of the run. */
  scale: number;
  rotation: [number, number, number, number];
  translation: Vector;
  /** Positions of the other path in the world of the run. */
  path: number[];
  hasCloud: boolean;
  /** Of errors. */
  unit: "m" | "units";
  time: number[];
  error: number[];
  rmse: number;
  mean: number;
  median: number;
  max: number;
}

/** summary.json; an older run may lack any of it. */
export interface Summary {
  version?: string;
  input?: string;
  frames?: number;
  tracked?: number;
  lost?: number;
  maps?: number;
  keyframes?: number;
  landmarks?: number;
  loops?: number;
  merges?: number;
  levelled?: boolean;
  seconds?: number;
  frames_per_second?: number;
  peak_memory_mb?: number;
  interrupted?: boolean;
  warnings?: string[];
  scale?: Scale;
  timing_ms?: StageTimes;
  cloud?: { points?: number; seconds?: number };
  positions?: { source?: string; failure?: string | null } | null;
}

export interface Scale {
  state?: "metric" | "rough" | "unknown";
  value?: number | null;
  sigma?: number | null;
  camera_height?: number | null;
  assumed_height?: boolean;
  sources?: string[];
}

export type Vector = [number, number, number];

export function positionOf(run: Run, frame: number): Vector {
  const p = run.frames.position;
  return [p[3 * frame], p[3 * frame + 1], p[3 * frame + 2]];
}

/** Unit quaternion x, y, z, w: world from the optical camera frame (x right, y down, z forward). */
export function orientationOf(run: Run, frame: number): [number, number, number, number] {
  const q = run.frames.orientation;
  return [q[4 * frame], q[4 * frame + 1], q[4 * frame + 2], q[4 * frame + 3]];
}

/** Standard deviation of lengths, as a fraction of them; null where lengths have no metres. */
export function scaleSigma(run: Run): number | null {
  if (run.unit !== "m") return null;
  return run.summary.scale?.sigma ?? null;
}

/** Height of the camera over the ground, in units of the world; null where it is not known. */
export function cameraHeight(run: Run): number | null {
  const scale = run.summary.scale;
  if (run.unit !== "m" || scale?.camera_height == null) return null;
  return scale.camera_height / (scale.value ?? 1);
}

/** Length of the path; steps from one map to the next do not count. */
export function pathLength(run: Run): number {
  let length = 0;
  for (let i = 1; i < run.frames.index.length; ++i) {
    if (run.frames.map[i] !== run.frames.map[i - 1]) continue;
    const [a, b] = [positionOf(run, i - 1), positionOf(run, i)];
    length += Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  }
  return length;
}
