import type { Run } from "./run";
import { timeout } from "./timeout";

/** A node of the octree or an image comes within this time on slow connections, too. */
const TIMEOUT_MS = 60_000;
const ALIVE_MS = 5000;

/**
 * Where the page has its data from: the server of `orb360 view`, or the file of `orb360 report`.
 */
export interface Source {
  run(): Promise<Run>;
  /** Bytes `begin` to before `end` of the octree. */
  octree(begin: number, end: number): Promise<ArrayBuffer>;
  /** The same of the run with which it is compared; a report has none. */
  otherOctree(begin: number, end: number): Promise<ArrayBuffer>;
  /** JPEG of a frame of the input; an address for an image element. */
  inputImage(frame: number): string;
  /** JPEG of a view; an address for an image element. */
  viewImage(frame: number): string;
  /** Range and confidence of a view (slam/viewer/view_files.h). */
  viewRange(frame: number): Promise<ArrayBuffer>;
  /** Whether the data are in the page itself, which cannot lose its connection. */
  readonly isEmbedded: boolean;
  /** Whether the server answers. */
  isAlive(): Promise<boolean>;
}

/** What a request brought instead of data. */
export class SourceError extends Error {
  constructor(
    message: string,
    readonly isConnection: boolean,
  ) {
    super(message);
  }
}

async function request(
  path: string,
  headers: HeadersInit = {},
  limit = TIMEOUT_MS,
): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(path, { headers, cache: "no-store", signal: timeout(limit) });
  } catch {
    throw new SourceError("orb360 does not answer", true);
  }
  if (!response.ok) {
    throw new SourceError((await response.text()).trim() || `status ${response.status}`, false);
  }
  return response;
}

async function bytesOf(response: Response): Promise<ArrayBuffer> {
  try {
    return await response.arrayBuffer();
  } catch {
    throw new SourceError("the connection ended", true);
  }
}

class ServerSource implements Source {
  readonly isEmbedded = false;

  async run(): Promise<Run> {
    return (await request("run.json")).json();
  }

  async octree(begin: number, end: number): Promise<ArrayBuffer> {
    return this.part("cloud.octree", begin, end);
  }

  async otherOctree(begin: number, end: number): Promise<ArrayBuffer> {
    return this.part("other.octree", begin, end);
  }

  private async part(name: string, begin: number, end: number): Promise<ArrayBuffer> {
    const range = `bytes=${begin}-${end - 1}`;
    const bytes = await bytesOf(await request(name, { Range: range }));
    if (bytes.byteLength !== end - begin) {
      throw new SourceError("the octree has changed; load the page again", false);
    }
    return bytes;
  }

  inputImage(frame: number): string {
    return `images/${frame}.jpg`;
  }

  viewImage(frame: number): string {
    return `views/${frame}.jpg`;
  }

  async viewRange(frame: number): Promise<ArrayBuffer> {
    return bytesOf(await request(`views/${frame}.range`));
  }

  async isAlive(): Promise<boolean> {
    try {
      await request("alive", {}, ALIVE_MS);
      return true;
    } catch {
      return false;
    }
  }
}

function fromBase64(text: string): ArrayBuffer {
  const characters = atob(text.trim());
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < characters.length; ++i) bytes[i] = characters.charCodeAt(i);
  return bytes.buffer;
}

function embeddedText(id: string): string {
  return document.getElementById(id)?.textContent ?? "";
}

class EmbeddedSource implements Source {
  readonly isEmbedded = true;
  private bytes: ArrayBuffer | null = null;

  async run(): Promise<Run> {
    return JSON.parse(embeddedText("embedded-run"));
  }

  async octree(begin: number, end: number): Promise<ArrayBuffer> {
    this.bytes ??= fromBase64(embeddedText("embedded-octree"));
    return this.bytes.slice(begin, end);
  }

  async otherOctree(): Promise<ArrayBuffer> {
    throw new Error("a report has one cloud only");
  }

  inputImage(frame: number): string {
    throw new Error(`a report has no image ${frame} of the input`);
  }

  viewImage(frame: number): string {
    return `data:image/jpeg;base64,${embeddedText(`embedded-image-${frame}`).trim()}`;
  }

  async viewRange(frame: number): Promise<ArrayBuffer> {
    return fromBase64(embeddedText(`embedded-range-${frame}`));
  }

  async isAlive(): Promise<boolean> {
    return true;
  }
}

export function openSource(): Source {
  return document.getElementById("embedded-run") ? new EmbeddedSource() : new ServerSource();
}
