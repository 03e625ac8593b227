/** What the server tells of a run that goes on (slam/viewer/live_snapshot.h). */
export interface LiveState {
  frame: number;
  time: number;
  state: "initializing" | "tracking" | "lost";
  isPaused: boolean;
  map: number;
  revision: number;
  size: [number, number];
  features: number[];
  pose: number[] | null;
  keyframes: number[][];
  links: [number, number][];
  loops: [number, number][];
  cameraHeight: number | null;
  landmarks: number;
}

/** Landmarks in the frames of their keyframes. */
export interface LivePoints {
  revision: number;
  keyframe: Int32Array;
  position: Float32Array;
  color: Uint8Array;
}

const POINT_BYTES = 20;

async function get(path: string): Promise<Response> {
  const response = await fetch(path, { cache: "no-store" });
  if (!response.ok) throw new Error((await response.text()).trim());
  return response;
}

export async function liveState(): Promise<LiveState> {
  return (await get("live.json")).json();
}

export async function liveImage(): Promise<ImageBitmap> {
  return createImageBitmap(await (await get("live.jpg")).blob());
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
  const response = await fetch(action, { method: "POST" });
  if (!response.ok) throw new Error((await response.text()).trim());
}
