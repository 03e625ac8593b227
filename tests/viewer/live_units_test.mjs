// What the page of a run that goes on reads and moves.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./modules.mjs";

const { readLivePoints, readLiveCloud, readLiveImage, PosedPoints, LiveLayer, THREE } = await load(`
  export * as THREE from "three";
  export { readLivePoints, readLiveCloud, readLiveImage } from "./src/live_source";
  export { PosedPoints } from "./src/posed_points";
  export { LiveLayer } from "./src/live_layer";
`);

/** Bytes of numbers, little endian: pairs of a type of DataView's setters and a value. */
function bytesOf(...numbers) {
  const sizes = { Uint8: 1, Int32: 4, Uint32: 4, Float32: 4 };
  const view = new DataView(
    new ArrayBuffer(numbers.reduce((size, [type]) => size + sizes[type], 0)),
  );
  let at = 0;
  for (const [type, value] of numbers) {
    view[`set${type}`](at, value, true);
    at += sizes[type];
  }
  return view.buffer;
}

const POINT = [
  ...[0.5, -0.25, 2].map((value) => ["Float32", value]),
  ...[10, 20, 30, 0].map((value) => ["Uint8", value]),
];

test("landmarks of a live run are read as they are written", () => {
  const bytes = bytesOf(
    ["Uint32", 3],
    ["Uint32", 2],
    ...[["Int32", 5], ["Uint32", 1], ...POINT],
    ...[
      ["Int32", 7],
      ["Uint32", 0],
    ],
  );
  const { revision, groups } = readLivePoints(bytes);
  assert.equal(revision, 3);
  assert.deepEqual(
    groups.map(({ id }) => id),
    [5, 7],
  );
  assert.deepEqual([...groups[0].position], [0.5, -0.25, 2]);
  assert.deepEqual([...groups[0].color], [10, 20, 30]);
  assert.equal(groups[1].position.length, 0);
  assert.throws(() => readLivePoints(bytes.slice(0, 26)), /truncated/);
});

test("the dense cloud of a live run is read as it is written", () => {
  const bytes = bytesOf(
    ["Uint32", 12],
    ["Uint32", 5000],
    ["Int32", 40],
    ...[1, 2, 3, 0, 0, 0, 1].map((value) => ["Float32", value]),
    ["Uint32", 2],
    ...POINT,
    ...POINT,
  );
  const { numViews, maxOfView, views } = readLiveCloud(bytes);
  assert.equal(numViews, 12);
  assert.equal(maxOfView, 5000);
  assert.equal(views.length, 1);
  assert.equal(views[0].id, 40);
  assert.deepEqual([...views[0].pose], [1, 2, 3, 0, 0, 0, 1]);
  assert.deepEqual([...views[0].position.slice(3)], [0.5, -0.25, 2]);
  for (const end of [6, 20, bytes.byteLength - 1]) {
    assert.throws(() => readLiveCloud(bytes.slice(0, end)), /truncated/);
  }
});

test("points of a camera move with its pose, and are drawn up to a limit", () => {
  const points = new PosedPoints(2);
  points.set(4, Float32Array.of(1, 0, 0, 0, 1, 0), new Uint8Array(6));
  const [object] = points.group.children;
  assert.ok(!object.visible, "it is shown without a pose");
  // Turned by 90 degrees about z, then moved.
  points.setPoses(new Map([[4, [10, 20, 30, 0, 0, Math.SQRT1_2, Math.SQRT1_2]]]));
  const at = new THREE.Vector3(1, 0, 0).applyMatrix4(object.matrix);
  assert.ok(object.visible && at.distanceTo(new THREE.Vector3(10, 21, 30)) < 1e-6);
  points.setPoses(new Map());
  assert.ok(!object.visible);
  assert.equal(points.count, 2);
  points.limit(1);
  assert.equal(points.count, 1);
  points.set(4, new Float32Array(), new Uint8Array());
  assert.equal(points.group.children.length, 0);
});

test("the image of a live run comes with the features of its own frame", () => {
  const bytes = new ArrayBuffer(8 + 12 + 3);
  const view = new DataView(bytes);
  view.setUint32(0, 41, true);
  view.setUint32(4, 2, true);
  [2500, 2000, 0, 5000, 10000, 1].forEach((v, i) => view.setUint16(8 + 2 * i, v, true));
  new Uint8Array(bytes).set([1, 2, 3], 20);
  const image = readLiveImage(bytes);
  assert.equal(image.frame, 41);
  assert.deepEqual([...image.features], [...Float32Array.of(0.25, 0.2, 0, 0.5, 1, 1)]);
  assert.deepEqual([...new Uint8Array(image.jpeg)], [1, 2, 3]);
  assert.throws(() => readLiveImage(bytes.slice(0, 19)), /truncated/);
});

/** A state of a run with keyframes along x. */
function stateWith(places) {
  return {
    keyframes: places.map((x, i) => [i, 3 * i, x, 0, 0, 0, 0, 0, 1]),
    links: [],
    loops: [],
    pose: null,
  };
}

test("a map of any size is within the range that is drawn", () => {
  const layer = new LiveLayer();
  assert.ok(layer.extent >= 100, "the surroundings of the first frames are cut off");
  layer.setState(stateWith([0, 5]));
  const small = layer.extent;
  layer.setState(stateWith([-900, 0, 700]));
  assert.ok(layer.extent >= 1600 && small < 1600);
  // Poses that have not changed are not sent again.
  layer.setState({ ...stateWith([]), keyframes: null, links: null });
  assert.equal(layer.numKeyframes, 3);
  assert.ok(layer.extent >= 1600);
});
