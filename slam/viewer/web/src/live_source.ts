import { timeout } from "./timeout";

/** What the server tells of a run that goes on (slam/viewer/live_snapshot.h). */
export interface LiveState {
  frame: number;
  time: number;
  state: "initializing" | "tracking" | "lost" | "finishing";
  isPaused: boolean;
  /** The run stands still because it is paused. */
  isWaiting: boolean;
  map: number;
  revision: number;
  size: [number, number];
  pose: number[] | null;
  keyframes: number[][];
  links: [number, number][];
  loops: [number, number][];
  cameraHeight: number | null;
  landmarks: number;
}

/** The image of a frame with its features. */
export interface LiveImage {
  frame: number;
  /** 3 numbers each: u, v in 0..1 of width and height, 1 where matched. */
  features: Float32Array;
  jpeg: ArrayBuffer;
}

/** Landmarks in the frames of their keyframes. */
export interface LivePoints {
  revision: number;
  keyframe: Int32Array;
  position: Float32Array;
  color: Uint8Array;
}

const POINT_BYTES = 20;
const TIMEOUT_MS = 20_000;

async function get(path: string): Promise<Response> {
  const response = await fetch(path, { cache: "no-store", signal: timeout(TIMEOUT_MS) });
  if (!response.ok) throw new Error((await response.text()).trim());
  return response;
}

export async function liveState(): Promise<LiveState> {
  return (await get("live.json")).json();
}

export async function liveImage(): Promise<LiveImage> {
  return readLiveImage(await (await get("live.image")).arrayBuffer());
}

export function readLiveImage(bytes: ArrayBuffer): LiveImage {
  const view = new DataView(bytes);
  const count = view.getUint32(4, true);
  const end = 8 + 6 * count;
  if (bytes.byteLength < end) throw new Error("live.image is truncated");
  const features = new Float32Array(3 * count);
  for (let i = 0; i < 3 * count; ++i) {
    const value = view.getUint16(8 + 2 * i, true);
    features[i] = i % 3 === 2 ? value : value / 10_000;
  }
  return { frame: view.getUint32(0, true), features, jpeg: bytes.slice(end) };
}

export async function livePoints(): Promise<LivePoints> {
  return readLivePoints(await (await get("live.points")).arrayBuffer());
}

export function readLivePoints(bytes: ArrayBuffer): LivePoints {
  const view = new DataView(bytes);
  const count = view.getUint32(4, true);
  if (bytes.byteLength !== 8 + POINT_BYTES * count) throw new Error("live.points is truncated");
  const points = {
    revision: view.getUint32(0, true),
    keyframe: new Int32Array(count),
    position: new Float32Array(3 * count),
    color: new Uint8Array(3 * count),
  };
  for (let i = 0; i < count; ++i) {
    const at = 8 + POINT_BYTES * i;
    points.keyframe[i] = view.getInt32(at, true);
    for (let axis = 0; axis < 3; ++axis) {
      points.position[3 * i + axis] = view.getFloat32(at + 4 + 4 * axis, true);
      points.color[3 * i + axis] = view.getUint8(at + 16 + axis);
    }
  }
  return points;
}

/** Asks the run to do something. */
export async function control(action: "pause" | "resume" | "step" | "finish"): Promise<void> {
  const response = await fetch(action, { method: "POST", signal: timeout(TIMEOUT_MS) });
  if (!response.ok) throw new Error((await response.text()).trim());
}
