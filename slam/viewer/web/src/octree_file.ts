/** The octree of a cloud, as docs/formats/octree.md describes it. */

export const HEADER_BYTES = 88;
const NODE_BYTES = 32;
const POINT_BYTES = 12;
const MAGIC = "ORB360OC";
const VERSION = 1;

export interface OctreeHeader {
  hasConfidences: boolean;
  pointCount: number;
  nodeCount: number;
  cellsPerSide: number;
  min: [number, number, number];
  side: number;
  indexOffset: number;
  fileSize: number;
  indexCrc: number;
}

export interface OctreeNode {
  offset: number;
  pointCount: number;
  crc: number;
  level: number;
  /** Corner with the least coordinates, and side of the cube. */
  min: [number, number, number];
  side: number;
  /** Places of the children in the index, in the order of the bits of their mask. */
  children: number[];
  /** Which child it is of its parent: 4 x + 2 y + z. */
  octant: number;
}

/** Points of a node as the graphics card takes them. */
export interface NodePoints {
  /** x, y, z, normal: 4 a point. */
  positions: Uint16Array;
  /** red, green, blue, confidence: 4 a point. */
  colors: Uint8Array;
}

/** The octree cannot be read. */
export class OctreeError extends Error {}

const CRC_TABLE = Uint32Array.from({ length: 256 }, (_, byte) => {
  let crc = byte;
  for (let bit = 0; bit < 8; ++bit) crc = (crc & 1) !== 0 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
  return crc >>> 0;
});

/** CRC-32 of bytes, that of PNG. */
export function crc32(bytes: Uint8Array): number {
  let crc = 0xffffffff;
  for (let i = 0; i < bytes.length; ++i) crc = (crc >>> 8) ^ CRC_TABLE[(crc ^ bytes[i]) & 0xff];
  return ~crc >>> 0;
}

export function readHeader(bytes: ArrayBuffer): OctreeHeader {
  if (bytes.byteLength < HEADER_BYTES) throw new OctreeError("the octree is truncated");
  const view = new DataView(bytes);
  const magic = String.fromCharCode(...new Uint8Array(bytes, 0, 8));
  if (magic !== MAGIC) throw new OctreeError("this is no octree of a cloud");
  const version = view.getUint32(8, true);
  if (version !== VERSION) throw new OctreeError(`the octree has version ${version}`);
  if (crc32(new Uint8Array(bytes, 0, 84)) !== view.getUint32(84, true)) {
    throw new OctreeError("the octree is damaged");
  }
  const attributes = view.getUint32(12, true);
  return {
    hasConfidences: (attributes & 2) !== 0,
    pointCount: Number(view.getBigUint64(16, true)),
    nodeCount: view.getUint32(24, true),
    cellsPerSide: view.getUint32(28, true),
    min: [view.getFloat64(32, true), view.getFloat64(40, true), view.getFloat64(48, true)],
    side: view.getFloat64(56, true),
    indexOffset: Number(view.getBigUint64(64, true)),
    fileSize: Number(view.getBigUint64(72, true)),
    indexCrc: view.getUint32(80, true),
  };
}

export function readIndex(bytes: ArrayBuffer, header: OctreeHeader): OctreeNode[] {
  if (bytes.byteLength !== header.nodeCount * NODE_BYTES) {
    throw new OctreeError("the octree is truncated");
  }
  if (crc32(new Uint8Array(bytes)) !== header.indexCrc) {
    throw new OctreeError("the octree is damaged");
  }
  const view = new DataView(bytes);
  const nodes: OctreeNode[] = [];
  const places = new Map<string, number>();
  const cells: [number, number, number][] = [];
  for (let i = 0; i < header.nodeCount; ++i) {
    const at = i * NODE_BYTES;
    const level = view.getUint8(at + 28);
    const side = header.side / 2 ** level;
    const cell: [number, number, number] = [
      view.getUint32(at + 16, true),
      view.getUint32(at + 20, true),
      view.getUint32(at + 24, true),
    ];
    cells.push(cell);
    places.set(`${level} ${cell[0]} ${cell[1]} ${cell[2]}`, i);
    nodes.push({
      offset: Number(view.getBigUint64(at, true)),
      pointCount: view.getUint32(at + 8, true),
      crc: view.getUint32(at + 12, true),
      level,
      min: [0, 1, 2].map((axis) => header.min[axis] + cell[axis] * side) as OctreeNode["min"],
      side,
      children: [],
      octant: ((cell[0] & 1) << 2) | ((cell[1] & 1) << 1) | (cell[2] & 1),
    });
  }
  for (let i = 0; i < header.nodeCount; ++i) {
    const mask = view.getUint8(i * NODE_BYTES + 29);
    for (let octant = 0; octant < 8; ++octant) {
      if (((mask >> octant) & 1) === 0) continue;
      const [x, y, z] = cells[i];
      const key = [2 * x + ((octant >> 2) & 1), 2 * y + ((octant >> 1) & 1), 2 * z + (octant & 1)];
      const child = places.get(`${nodes[i].level + 1} ${key.join(" ")}`);
      if (child === undefined) throw new OctreeError("the octree is damaged");
      nodes[i].children.push(child);
    }
  }
  return nodes;
}

export function nodeBytes(node: OctreeNode): number {
  return node.pointCount * POINT_BYTES;
}

export function readPoints(bytes: ArrayBuffer, node: OctreeNode): NodePoints {
  if (bytes.byteLength !== nodeBytes(node)) throw new OctreeError("the octree is truncated");
  if (crc32(new Uint8Array(bytes)) !== node.crc) throw new OctreeError("the octree is damaged");
  return {
    positions: new Uint16Array(bytes, 0, 4 * node.pointCount),
    colors: new Uint8Array(bytes, 8 * node.pointCount),
  };
}
