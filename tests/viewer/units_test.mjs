// Modules of the page by themselves.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./modules.mjs";

const {
  format,
  adjacentNodes,
  chooseNodes,
  THREE,
  ViewRange,
  colorAt,
  ticksBetween,
  PointCloud,
  errorOfFrames,
  FailedNodes,
  Measure,
  pickPoint,
  Connection,
  timeout,
} = await load(`
  export * as format from "./src/format";
  export { adjacentNodes } from "./src/adjacent_nodes";
  export * as THREE from "three";
  export { chooseNodes } from "./src/node_choice";
  export { ViewRange } from "./src/view_range";
  export { colorAt } from "./src/color_maps";
  export { ticksBetween } from "./src/charts";
  export { PointCloud } from "./src/point_cloud";
  export { errorOfFrames } from "./src/comparison";
  export { FailedNodes } from "./src/failed_nodes";
  export { Measure } from "./src/measure";
  export { pickPoint } from "./src/pick";
  export { Connection } from "./src/connection";
  export { timeout } from "./src/timeout";
`);

test("lengths have a unit, and the uncertainty that the scale gives them", () => {
  assert.equal(format.length(12.345, "m"), "12.35 m");
  assert.equal(format.length(-0.5, "m"), "−50 cm");
  assert.equal(format.length(0.5, "units"), "0.50 units");
  assert.equal(format.length(1234.5, "m"), "1234.5 m");
  assert.equal(format.uncertainLength(10, "m", 0.02), "10.00 m ± 20 cm");
  assert.equal(format.uncertainLength(10, "units", null), "10.00 units");
});

/** A complete octree of a cube at the origin, every node with 100 points. */
function completeOctree(side, depth) {
  const nodes = [];
  const add = (min, size, level) => {
    const place = nodes.length;
    const node = { min, side: size, level, pointCount: 100, children: [], octant: 0 };
    nodes.push(node);
    if (level === depth) return place;
    for (let octant = 0; octant < 8; ++octant) {
      const corner = [4, 2, 1].map((bit, axis) => min[axis] + (octant & bit ? size / 2 : 0));
      const child = add(corner, size / 2, level + 1);
      nodes[child].octant = octant;
      node.children.push(child);
    }
    return place;
  };
  add([0, 0, 0], side, 0);
  return nodes;
}

function choose(nodes, eye, target, { budget = 1e9, isLoaded = () => true } = {}) {
  const camera = new THREE.PerspectiveCamera(60, 1, 0.01, 1e4);
  camera.up.set(0, 0, 1);
  camera.position.set(...eye);
  camera.lookAt(...target);
  camera.updateMatrixWorld();
  return chooseNodes(nodes, {
    camera,
    pixelsPerRadian: 900,
    clip: null,
    budget,
    cellsPerSide: 64,
    isLoaded,
  });
}

test("nodes near the camera are shown finer than distant ones", () => {
  const nodes = completeOctree(100, 4);
  const { shown } = choose(nodes, [-1, 50, 50], [100, 50, 50]);
  const distanceOf = (node) =>
    Math.hypot(
      ...node.min.map((min, axis) =>
        Math.max(min - [-1, 50, 50][axis], 0, [-1, 50, 50][axis] - min - node.side),
      ),
    );
  const deepest = shown.map((place) => nodes[place]).filter((node) => node.level === 4);
  assert.ok(deepest.length > 0);
  // 64 cells of a node of level 3, 12.5 wide, are 1.3 pixels of 1/900 rad apart at 135.
  assert.ok(choose(nodes, [-1000, 50, 50], [0, 50, 50]).shown.every((p) => nodes[p].level <= 1));
  assert.ok(deepest.every((node) => distanceOf(node) < 136));
});

test("nodes out of view are not shown, and children only with their parents", () => {
  const nodes = completeOctree(100, 3);
  assert.deepEqual(choose(nodes, [-10, 50, 50], [-100, 50, 50]).shown, [0]);
  const { shown } = choose(nodes, [150, 50, 50], [50, 50, 50]);
  const set = new Set(shown);
  nodes.forEach((node, place) =>
    node.children.forEach((child) => {
      if (set.has(child)) assert.ok(set.has(place));
    }),
  );
});

test("the budget of points holds, and what is missing is asked for by importance", () => {
  const nodes = completeOctree(100, 4);
  const few = choose(nodes, [-5, 50, 50], [50, 50, 50], { budget: 2000 });
  assert.equal(few.shown.length, 20);
  const none = choose(nodes, [-5, 50, 50], [50, 50, 50], { isLoaded: (place) => place === 0 });
  assert.deepEqual(none.shown, [0]);
  assert.equal(none.missing.length, 8);
  // The near half first.
  assert.ok(none.missing.slice(0, 4).every((place) => nodes[place].min[0] === 0));
});

test("ranges of a view are found by their place in the panorama", () => {
  const [width, height] = [4, 2];
  const bytes = new ArrayBuffer(8 + 3 * width * height);
  const view = new DataView(bytes);
  view.setUint32(0, width, true);
  view.setUint32(4, height, true);
  for (let i = 1; i < 8; ++i) {
    view.setUint16(8 + 2 * i, Math.round(32768 + 1024 * Math.log(i)), true);
    view.setUint8(8 + 16 + i, 51);
  }
  const range = new ViewRange(bytes);
  assert.equal(range.at(0.1, 0.1), null);
  assert.ok(Math.abs(range.at(0.3, 0.2).range - 1) < 1e-3);
  assert.ok(Math.abs(range.at(0.99, 0.99).range - 7) < 7e-3);
  assert.ok(Math.abs(range.at(1.3, 0.2).range - 1) < 1e-3, "the seam is not closed");
  assert.equal(range.at(0.3, 0.2).confidence, 0.2);
  assert.ok(Math.abs(range.at(0.3, 0.2).error - 4) < 1e-9);
  assert.equal(range.texels(range.limits())[0], 0);
  assert.throws(() => new ViewRange(bytes.slice(0, 20)), /truncated/);
});

test("each frame has the error at its own time", () => {
  const run = { frames: { time: [0, 0.1, 0.2, 0.3, 0.4] } };
  const comparison = { time: [0.0, 0.105, 0.3, 0.385], error: [1, 2, 3, 4] };
  assert.deepEqual(errorOfFrames(run, comparison), [1, 2, null, 3, 4]);
  assert.deepEqual(errorOfFrames(run, { time: [], error: [] }), [null, null, null, null, null]);
});

test("the cloud of another run is chosen as it lies in the world", () => {
  const nodes = completeOctree(100, 4);
  const cloud = Object.assign(Object.create(PointCloud.prototype), {
    group: new THREE.Group(),
    loaded: new Map(),
    cloudFromWorld: new THREE.Matrix4(),
    header: { side: 100, cellsPerSide: 64 },
    material: { uniforms: { cloudFromWorld: { value: new THREE.Matrix4() }, rootSpacing: {} } },
  });
  // Twice as large, turned, and far away.
  const worldFromCloud = new THREE.Matrix4().compose(
    new THREE.Vector3(1000, 0, 0),
    new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(0, 0, 1), Math.PI / 2),
    new THREE.Vector3(2, 2, 2),
  );
  cloud.setTransform(worldFromCloud);
  assert.equal(cloud.material.uniforms.rootSpacing.value, (2 * 100) / 64);
  const camera = new THREE.PerspectiveCamera(60, 1, 0.1, 5000);
  camera.up.set(0, 0, 1);
  const inCloud = new THREE.Vector3(-5, 50, 50);
  camera.position.copy(inCloud.clone().applyMatrix4(worldFromCloud));
  camera.lookAt(new THREE.Vector3(50, 50, 50).applyMatrix4(worldFromCloud));
  camera.updateMatrixWorld();
  assert.ok(cloud.inCloud(camera).position.distanceTo(inCloud) < 1e-6);
  const view = {
    pixelsPerRadian: 900,
    clip: null,
    budget: 1e9,
    cellsPerSide: 64,
    isLoaded: () => true,
  };
  const shown = chooseNodes(nodes, { ...view, camera: cloud.inCloud(camera) }).shown;
  assert.deepEqual(shown, choose(nodes, [-5, 50, 50], [50, 50, 50]).shown);
});

test("one request reads the wanted nodes that lie side by side in the file, up to 512 KiB", () => {
  const bytes = 12;
  let offset = 88;
  const node = (pointCount) => {
    const made = { offset, pointCount };
    offset += bytes * pointCount;
    return made;
  };
  // The node 4 has no points; 8 to 10 have 240 KB each.
  const nodes = [10, 20, 30, 40, 0, 50, 60, 70, 20_000, 20_000, 20_000].map(node);
  assert.deepEqual(adjacentNodes(nodes, 2, [1, 2, 3, 6]), [1, 2, 3]);
  assert.deepEqual(adjacentNodes(nodes, 0, [0]), [0], "0 only is wanted");
  assert.deepEqual(adjacentNodes(nodes, 0, [0, 2, 3]), [0], "1 is not wanted");
  assert.deepEqual(adjacentNodes(nodes, 4, [3, 4, 5]), [4], "there is nothing to read");
  assert.deepEqual(adjacentNodes(nodes, 3, [3, 4, 5]), [3, 5], "nothing lies between");
  assert.deepEqual(adjacentNodes(nodes, 8, [10, 9, 8]), [8, 9]);
});

test("nodes that the connection failed are asked for again, ever later", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  let numFreed = 0;
  const failed = new FailedNodes(() => ++numFreed);
  failed.add(7, true);
  failed.add(8, false);
  assert.ok(failed.has(7) && failed.has(8));
  t.mock.timers.tick(1000);
  assert.ok(!failed.has(7) && failed.has(8), "damaged nodes are not asked for again");
  assert.equal(numFreed, 1);
  failed.add(7, true);
  t.mock.timers.tick(1000);
  assert.ok(failed.has(7), "the second time it takes longer");
  t.mock.timers.tick(1000);
  assert.ok(!failed.has(7));
  failed.loaded(7);
  failed.add(7, true);
  t.mock.timers.tick(1000);
  assert.ok(!failed.has(7), "success forgets earlier failures");
  failed.clear();
  assert.ok(!failed.has(8));
});

test("requests end after their time, and one question after the server is asked at once", async (t) => {
  t.mock.timers.enable({ apis: ["setTimeout", "setInterval"] });
  const signal = timeout(500);
  t.mock.timers.tick(499);
  assert.ok(!signal.aborted);
  t.mock.timers.tick(1);
  assert.ok(signal.aborted);
  const answers = [];
  const source = {
    isEmbedded: false,
    isAlive: () => new Promise((answer) => answers.push(answer)),
  };
  const events = [];
  const connection = new Connection(
    source,
    () => events.push("lost"),
    () => events.push("found"),
  );
  t.mock.timers.tick(20_000);
  const check = connection.check();
  assert.equal(answers.length, 1);
  answers[0](false);
  await check;
  const next = connection.check();
  assert.equal(answers.length, 2);
  answers[1](true);
  await next;
  assert.deepEqual(events, ["lost", "found"]);
});

test("a double click ends a line and does not measure from a point to itself", () => {
  const texts = [];
  const labels = {
    add: (text) => (texts.push(text), { setText() {}, setPosition() {}, remove() {} }),
  };
  const measure = new Measure({ unit: "units", summary: {} }, labels, () => {});
  measure.setMode("distance");
  const at = (x) => new THREE.Vector3(x, 0, 0);
  measure.add(at(0));
  measure.add(at(2));
  measure.add(at(2));
  measure.endLine();
  assert.deepEqual(texts, ["", "2.00 units"]);
  measure.add(at(2)); // Another line may begin where one has ended.
  measure.add(at(5));
  assert.deepEqual(texts.slice(2), ["", "3.00 units"]);
});

test("points that the least confidence hides are not picked", () => {
  // Two points on the ray, the nearer with a confidence of 0.2.
  const entry = {
    node: { min: [0, 0, 0], side: 65536, pointCount: 2 },
    points: {
      positions: Uint16Array.of(100, 0, 0, 0, 200, 0, 0, 0),
      colors: Uint8Array.of(0, 0, 0, 51, 0, 0, 0, 255),
    },
  };
  const cloud = { shownNodes: [entry], material: { uniforms: { leastConfidence: { value: 0 } } } };
  const ray = new THREE.Ray(new THREE.Vector3(0, 0.5, 0.5), new THREE.Vector3(1, 0, 0));
  const viewport = { ray: () => ({ ray, radiansPerPixel: 1e-3 }), clip: null };
  assert.equal(pickPoint(viewport, cloud, 0, 0, 8).position.x, 100.5);
  cloud.material.uniforms.leastConfidence.value = 0.2; // It is shown at its own confidence.
  assert.equal(pickPoint(viewport, cloud, 0, 0, 8).position.x, 100.5);
  cloud.material.uniforms.leastConfidence.value = 0.25;
  assert.equal(pickPoint(viewport, cloud, 0, 0, 8).position.x, 200.5);
});

test("colours of maps grow brighter from end to end", () => {
  const brightness = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;
  for (const name of ["viridis", "cividis", "magma", "plasma"]) {
    for (let i = 1; i <= 20; ++i) {
      assert.ok(brightness(colorAt(name, i / 20)) > brightness(colorAt(name, (i - 1) / 20)), name);
    }
  }
});

test("charts have round ticks within their limits", () => {
  assert.deepEqual(ticksBetween(0, 10), [0, 5, 10]);
  assert.deepEqual(
    ticksBetween(0.98, 1.02).map((tick) => tick.toFixed(2)),
    ["0.98", "1.00", "1.02"],
  );
});
