import type { StageTimes } from "./run";
import { timeout } from "./timeout";

/** What the server tells of a run that goes on (slam/viewer/live_snapshot.h). */
export interface LiveState {
  frame: number;
  time: number;
  /** Milliseconds since this was the state of the run. */
  age: number;
  state: "initializing" | "tracking" | "lost" | "finishing";
  isPaused: boolean;
  /** The run stands still because it is paused. */
  isWaiting: boolean;
  /** Some of every image is left out. */
  isMasked: boolean;
  /** Wall times of the last frames by stage, ms. */
  times: StageTimes;
  map: number;
  revision: number;
  size: [number, number];
  /** How far the work after the last frame has got. */
  progress: { what: string; done: number; count: number; ofWhat: string } | null;
  pose: number[] | null;
  /** Id, frame and pose each; null where the page has them. */
  keyframes: number[][] | null;
  links: [number, number][] | null;
  loops: [number, number][];
  cameraHeight: number | null;
  landmarks: number;
  /** Views of the dense cloud so far. */
  views: number;
}

/** The image of a frame with its features. */
export interface LiveImage {
  frame: number;
  /** 3 numbers each: u, v in 0..1 of width and height, 1 where matched. */
  features: Float32Array;
  jpeg: ArrayBuffer;
}

/** Points in the coordinates of a camera. */
export interface CameraPoints {
  /** Of the keyframe, or the index of the frame of a view. */
  id: number;
  /** x y z qx qy qz qw of the camera in the world; keyframes have theirs in LiveState. */
  pose: Float32Array | null;
  position: Float32Array;
  color: Uint8Array;
}

/** The landmarks of keyframes that have changed. */
export interface LivePoints {
  revision: number;
  groups: CameraPoints[];
}

/** A further part of the dense cloud. */
export interface LiveCloud {
  /** Number of views that the page has with these. */
  numViews: number;
  /** Points of a view at most; what the page has beyond is dropped. */
  maxOfView: number;
  views: CameraPoints[];
}

const POINT_BYTES = 16;
const TIMEOUT_MS = 20_000;

async function get(path: string): Promise<Response> {
  const response = await fetch(path, { cache: "no-store", signal: timeout(TIMEOUT_MS) });
  if (!response.ok) throw new Error((await response.text()).trim());
  return response;
}

/** `since`: the revision of the poses that the page has. */
export async function liveState(since: number): Promise<LiveState> {
  return (await get(`live.json?since=${since}`)).json();
}

export async function liveImage(): Promise<LiveImage> {
  return readLiveImage(await (await get("live.image")).arrayBuffer());
}

/** Black where nothing is looked for. */
export async function liveMask(): Promise<Blob> {
  return (await get("live.mask")).blob();
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

/** Reads numbers one after the other. */
class ByteReader {
  private at = 0;
  private readonly view: DataView;

  constructor(
    private readonly bytes: ArrayBuffer,
    private readonly name: string,
  ) {
    this.view = new DataView(bytes);
  }

  get isAtEnd(): boolean {
    return this.at === this.bytes.byteLength;
  }

  uint32(): number {
    return this.view.getUint32(this.skip(4), true);
  }

  int32(): number {
    return this.view.getInt32(this.skip(4), true);
  }

  floats(count: number): Float32Array {
    const at = this.skip(4 * count);
    return Float32Array.from({ length: count }, (_, i) => this.view.getFloat32(at + 4 * i, true));
  }

  /** A number of points, and the points. */
  points(): { position: Float32Array; color: Uint8Array } {
    const count = this.uint32();
    const begin = this.skip(POINT_BYTES * count);
    const position = new Float32Array(3 * count);
    const color = new Uint8Array(3 * count);
    for (let i = 0; i < count; ++i) {
      for (let axis = 0; axis < 3; ++axis) {
        const at = begin + POINT_BYTES * i;
        position[3 * i + axis] = this.view.getFloat32(at + 4 * axis, true);
        color[3 * i + axis] = this.view.getUint8(at + 12 + axis);
      }
    }
    return { position, color };
  }

  private skip(count: number): number {
    const at = this.at;
    this.at += count;
    if (this.at > this.bytes.byteLength) throw new Error(`${this.name} is truncated`);
    return at;
  }
}

/** `since`: the revision of the landmarks that the page has. */
export async function livePoints(since: number): Promise<LivePoints> {
  return readLivePoints(await (await get(`live.points?since=${since}`)).arrayBuffer());
}

export function readLivePoints(bytes: ArrayBuffer): LivePoints {
  const reader = new ByteReader(bytes, "live.points");
  const revision = reader.uint32();
  const groups = Array.from({ length: reader.uint32() }, () => ({
    id: reader.int32(),
    pose: null,
    ...reader.points(),
  }));
  return { revision, groups };
}

/** `since`: number of views that the page has. */
export async function liveCloud(since: number): Promise<LiveCloud> {
  return readLiveCloud(await (await get(`live.cloud?since=${since}`)).arrayBuffer());
}

export function readLiveCloud(bytes: ArrayBuffer): LiveCloud {
  const reader = new ByteReader(bytes, "live.cloud");
  const numViews = reader.uint32();
  const maxOfView = reader.uint32();
  const views: CameraPoints[] = [];
  while (!reader.isAtEnd) {
    views.push({ id: reader.int32(), pose: reader.floats(7), ...reader.points() });
  }
  return { numViews, maxOfView, views };
}

/** Asks the run to do something. */
export async function control(action: "pause" | "resume" | "step" | "finish"): Promise<void> {
  const response = await fetch(action, { method: "POST", signal: timeout(TIMEOUT_MS) });
  if (!response.ok) throw new Error((await response.text()).trim());
}
