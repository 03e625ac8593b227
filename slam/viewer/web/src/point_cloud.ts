import * as THREE from "three";
import {
  HEADER_BYTES,
  nodeBytes,
  readHeader,
  readIndex,
  readPoints,
  type NodePoints,
  type OctreeHeader,
  type OctreeNode,
} from "./octree_file";
import { adjacentNodes } from "./adjacent_nodes";
import { FailedNodes } from "./failed_nodes";
import { chooseNodes, type Choice } from "./node_choice";
import { makePointMaterial, makeVisibleTexture, VISIBLE_WIDTH } from "./point_material";
import { SourceError } from "./source";

/** Where the bytes of an octree come from (Source). */
export type OctreeSource = (begin: number, end: number) => Promise<ArrayBuffer>;

/** Requests at once, each of adjacent nodes: as many as browsers make to a server. */
const MAX_REQUESTS = 6;
/** Loaded points that are kept, in terms of those that may be shown. */
const KEPT_RATIO = 2;

export interface LoadedNode {
  node: OctreeNode;
  object: THREE.Points;
  points: NodePoints;
  lastShown: number;
}

/**
 * The cloud of a run: shows the nodes of its octree that matter in a view and loads those missing.
 */
export class PointCloud {
  readonly group = new THREE.Group();
  readonly material = makePointMaterial();
  /** By place in the index. */
  readonly loaded = new Map<number, LoadedNode>();
  pointBudget = 2_000_000;
  shownPoints = 0;
  private shown: number[] = [];
  private wanted: number[] = [];
  private readonly loading = new Set<number>();
  private numRequests = 0;
  private readonly failed: FailedNodes;
  private numLoaded = 0;
  private pass = 0;
  private readonly cloudFromWorld = new THREE.Matrix4();

  private constructor(
    private readonly source: OctreeSource,
    readonly header: OctreeHeader,
    readonly nodes: OctreeNode[],
    private readonly onChange: () => void,
    private readonly onError: (error: SourceError | Error) => void,
  ) {
    this.failed = new FailedNodes(onChange);
    const uniforms = this.material.uniforms;
    uniforms.rootMin.value.set(...header.min);
    uniforms.rootSide.value = header.side;
    uniforms.rootSpacing.value = header.side / header.cellsPerSide;
    uniforms.visibleNodes.value = makeVisibleTexture(Math.ceil(nodes.length / VISIBLE_WIDTH));
  }

  /** Reads header, index and root. */
  static async open(
    source: OctreeSource,
    onChange: () => void,
    onError: (error: Error) => void,
  ): Promise<PointCloud> {
    const header = readHeader(await source(0, HEADER_BYTES));
    const index = await source(header.indexOffset, header.fileSize);
    const cloud = new PointCloud(source, header, readIndex(index, header), onChange, onError);
    cloud.add(0, readPoints(await cloud.bytesOf([0]), cloud.nodes[0]));
    return cloud;
  }

  /** Puts the cloud of another run into the world, whose units it may not have. */
  setTransform(worldFromCloud: THREE.Matrix4): void {
    this.group.matrixAutoUpdate = false;
    this.group.matrix.copy(worldFromCloud);
    this.group.updateMatrixWorld(true);
    for (const { object } of this.loaded.values()) object.updateMatrixWorld(true);
    this.cloudFromWorld.copy(worldFromCloud).invert();
    const { uniforms } = this.material;
    uniforms.cloudFromWorld.value.copy(this.cloudFromWorld);
    const { side, cellsPerSide } = this.header;
    uniforms.rootSpacing.value = (worldFromCloud.getMaxScaleOnAxis() * side) / cellsPerSide;
  }

  /** A view of the world as one of the cloud. */
  private inCloud(camera: THREE.PerspectiveCamera): THREE.PerspectiveCamera {
    const inside = camera.clone();
    inside.matrixWorld.premultiply(this.cloudFromWorld);
    inside.matrixWorldInverse.copy(inside.matrixWorld).invert();
    inside.position.setFromMatrixPosition(inside.matrixWorld);
    return inside;
  }

  /** Whether nodes that the view wants are still to come. */
  get isLoading(): boolean {
    return this.loading.size > 0 || this.wanted.length > 0;
  }

  get shownNodes(): LoadedNode[] {
    return this.shown.map((place) => this.loaded.get(place)!);
  }

  /** Chooses what is shown from a camera and asks for what is missing. */
  update(camera: THREE.PerspectiveCamera, heightInPixels: number, clip: THREE.Box3 | null): void {
    ++this.pass;
    const pixelsPerRadian = heightInPixels / (2 * Math.tan((camera.fov * Math.PI) / 360));
    this.material.uniforms.pixelsPerRadian.value = pixelsPerRadian;
    const choice: Choice = chooseNodes(this.nodes, {
      camera: this.inCloud(camera),
      pixelsPerRadian,
      clip: clip && clip.clone().applyMatrix4(this.cloudFromWorld),
      budget: this.pointBudget,
      cellsPerSide: this.header.cellsPerSide,
      isLoaded: (place) => this.loaded.has(place),
    });
    for (const place of this.shown) this.loaded.get(place)!.object.visible = false;
    this.shown = choice.shown;
    this.shownPoints = 0;
    for (const place of this.shown) {
      const entry = this.loaded.get(place)!;
      entry.object.visible = true;
      entry.lastShown = this.pass;
      this.shownPoints += entry.node.pointCount;
    }
    this.writeVisibleTexture();
    this.wanted = choice.missing.filter((p) => !this.loading.has(p) && !this.failed.has(p));
    this.requestNext();
  }

  /** Asks again for what could not be loaded. */
  retry(): void {
    this.failed.clear();
    this.onChange();
  }

  private requestNext(): void {
    while (this.numRequests < MAX_REQUESTS && this.wanted.length > 0) {
      const places = adjacentNodes(this.nodes, this.wanted[0], this.wanted);
      this.wanted = this.wanted.filter((place) => !places.includes(place));
      void this.load(places);
    }
  }

  /** The bytes of nodes that lie one after the other in the file. */
  private async bytesOf(places: readonly number[]): Promise<ArrayBuffer> {
    const last = this.nodes[places[places.length - 1]];
    const [begin, end] = [this.nodes[places[0]].offset, last.offset + nodeBytes(last)];
    return end > begin ? this.source(begin, end) : new ArrayBuffer(0);
  }

  private async load(places: readonly number[]): Promise<void> {
    for (const place of places) this.loading.add(place);
    ++this.numRequests;
    try {
      const bytes = await this.bytesOf(places);
      const { offset } = this.nodes[places[0]];
      for (const place of places) this.read(place, bytes, offset);
    } catch (error) {
      for (const place of places) this.fail(place, error as Error);
    } finally {
      --this.numRequests;
      for (const place of places) this.loading.delete(place);
    }
    this.dropUnused();
    this.onChange();
    this.requestNext();
  }

  /** Adds a node from `bytes`, which begin at `offset` in the file. */
  private read(place: number, bytes: ArrayBuffer, offset: number): void {
    const node = this.nodes[place];
    const begin = node.offset - offset;
    try {
      this.add(place, readPoints(bytes.slice(begin, begin + nodeBytes(node)), node));
      this.failed.loaded(place);
    } catch (error) {
      this.fail(place, error as Error);
    }
  }

  private fail(place: number, error: Error): void {
    this.failed.add(place, error instanceof SourceError && error.isConnection);
    this.onError(error);
  }

  private add(place: number, points: NodePoints): void {
    const node = this.nodes[place];
    const geometry = new THREE.BufferGeometry();
    const steps = new THREE.BufferAttribute(points.positions, 4);
    steps.gpuType = THREE.IntType; // no conversion to float: the shader reads integers
    geometry.setAttribute("steps", steps);
    geometry.setAttribute("tint", new THREE.BufferAttribute(points.colors, 4, true));
    geometry.setDrawRange(0, node.pointCount);
    const object = new THREE.Points(geometry, this.material);
    const scale = node.side / 65536;
    object.position.set(...node.min);
    object.scale.set(scale, scale, scale);
    object.updateMatrix();
    object.matrixAutoUpdate = false;
    object.frustumCulled = false;
    object.visible = false;
    this.group.add(object);
    object.updateMatrixWorld(true);
    this.loaded.set(place, { node, object, points, lastShown: this.pass });
    this.numLoaded += node.pointCount;
  }

  /** Forgets nodes that were not shown for the longest time. The root stays. */
  private dropUnused(): void {
    const limit = KEPT_RATIO * this.pointBudget;
    if (this.numLoaded <= limit) return;
    const oldest = [...this.loaded.entries()]
      .filter(([place, entry]) => place !== 0 && entry.lastShown < this.pass)
      .sort(([, a], [, b]) => a.lastShown - b.lastShown || b.node.level - a.node.level);
    for (const [place, entry] of oldest) {
      if (this.numLoaded <= limit) return;
      this.group.remove(entry.object);
      entry.object.geometry.dispose();
      this.loaded.delete(place);
      this.numLoaded -= entry.node.pointCount;
      this.shown = this.shown.filter((shown) => shown !== place);
    }
  }

  /**
   * Writes, in breadth-first order, masks of shown and hidden children and the place of the first.
   */
  private writeVisibleTexture(): void {
    const texture = this.material.uniforms.visibleNodes.value as THREE.DataTexture;
    const data = texture.image.data as unknown as Uint32Array;
    const isShown = new Set(this.shown);
    const queue = [0];
    for (let i = 0; i < queue.length; ++i) {
      const children = this.nodes[queue[i]].children.filter((child) => isShown.has(child));
      let mask = 0;
      for (const child of this.nodes[queue[i]].children) {
        mask |= 1 << (this.nodes[child].octant + (isShown.has(child) ? 0 : 8));
      }
      data[2 * i] = mask;
      data[2 * i + 1] = queue.length;
      queue.push(...children);
    }
    texture.needsUpdate = true;
  }
}
