import { nodeBytes, type OctreeNode } from "./octree_file";

/** Of a request: enough that its overhead does not matter, and little enough to be shown soon. */
const MAX_BYTES = 512 * 1024;

/**
 * The node `first`, and those of `wanted` whose bytes lie beside it in the file, in the order of the
 * file: one request reads them all. Children that have no children do.
 */
export function adjacentNodes(
  nodes: readonly OctreeNode[],
  first: number,
  wanted: readonly number[],
): number[] {
  const end = (place: number): number => nodes[place].offset + nodeBytes(nodes[place]);
  const others = wanted.filter((place) => place !== first && nodes[place].pointCount > 0);
  const byBegin = new Map(others.map((place) => [nodes[place].offset, place]));
  const byEnd = new Map(others.map((place) => [end(place), place]));
  const run = [first];
  if (nodes[first].pointCount === 0) return run;
  let left = MAX_BYTES - nodeBytes(nodes[first]);
  const extend = (place: number | undefined, add: (place: number) => void): boolean => {
    if (place === undefined || nodeBytes(nodes[place]) > left) return false;
    left -= nodeBytes(nodes[place]);
    add(place);
    return true;
  };
  while (extend(byBegin.get(end(run[run.length - 1])), (place) => run.push(place)));
  while (extend(byEnd.get(nodes[run[0]].offset), (place) => run.unshift(place)));
  return run;
}
