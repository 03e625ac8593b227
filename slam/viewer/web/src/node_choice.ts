import * as THREE from "three";
import type { OctreeNode } from "./octree_file";

/** A node whose points are this close on the screen, in pixels, needs no finer ones. */
const FINE_ENOUGH = 1.3;

export interface Choice {
  /** Places of the nodes to show, all loaded, parents before children. */
  shown: number[];
  /** Places of nodes that would be shown next, the most important first. */
  missing: number[];
}

interface Viewpoint {
  camera: THREE.PerspectiveCamera;
  pixelsPerRadian: number;
  clip: THREE.Box3 | null;
  budget: number;
  cellsPerSide: number;
  isLoaded: (place: number) => boolean;
}

/** Nodes by importance, the largest first: a binary heap. */
class Queue {
  private readonly items: { place: number; weight: number }[] = [];

  get isEmpty(): boolean {
    return this.items.length === 0;
  }

  push(place: number, weight: number): void {
    this.items.push({ place, weight });
    let i = this.items.length - 1;
    while (i > 0) {
      const parent = (i - 1) >> 1;
      if (this.items[parent].weight >= this.items[i].weight) break;
      [this.items[parent], this.items[i]] = [this.items[i], this.items[parent]];
      i = parent;
    }
  }

  pop(): { place: number; weight: number } {
    const top = this.items[0];
    const last = this.items.pop()!;
    if (this.items.length === 0) return top;
    this.items[0] = last;
    for (let i = 0; ;) {
      let largest = i;
      for (const child of [2 * i + 1, 2 * i + 2]) {
        if (child < this.items.length && this.items[child].weight > this.items[largest].weight) {
          largest = child;
        }
      }
      if (largest === i) return top;
      [this.items[largest], this.items[i]] = [this.items[i], this.items[largest]];
      i = largest;
    }
  }
}

/**
 * Goes from the root to the nodes that are largest on the screen, until the budget of points is
 * used.
 * A node is shown only with its parent, so that what is missing makes the view coarser, not
 * wrong.
 */
export function chooseNodes(nodes: OctreeNode[], view: Viewpoint): Choice {
  const frustum = new THREE.Frustum().setFromProjectionMatrix(
    new THREE.Matrix4().multiplyMatrices(
      view.camera.projectionMatrix,
      view.camera.matrixWorldInverse,
    ),
  );
  const box = new THREE.Box3();
  const weightOf = (node: OctreeNode): number => {
    box.min.set(...node.min);
    box.max.set(node.min[0] + node.side, node.min[1] + node.side, node.min[2] + node.side);
    if (!frustum.intersectsBox(box) || (view.clip && !view.clip.intersectsBox(box))) return 0;
    const distance = box.distanceToPoint(view.camera.position);
    return (view.pixelsPerRadian * node.side) / Math.max(distance, 0.25 * node.side);
  };
  const choice: Choice = { shown: [], missing: [] };
  const queue = new Queue();
  queue.push(0, weightOf(nodes[0]) || 1);
  let left = view.budget;
  while (!queue.isEmpty && left > 0) {
    const { place, weight } = queue.pop();
    const node = nodes[place];
    left -= node.pointCount;
    if (!view.isLoaded(place)) {
      choice.missing.push(place);
      continue;
    }
    choice.shown.push(place);
    if (weight / view.cellsPerSide < FINE_ENOUGH) continue;
    for (const child of node.children) {
      const childWeight = weightOf(nodes[child]);
      if (childWeight > 0) queue.push(child, childWeight);
    }
  }
  return choice;
}
