// Servers and runs in different states, in a real browser (ORB360_RUN: a run with views, ORB360_REPORT:
// its report).
import assert from "node:assert/strict";
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { coverage, findColor, launch, open, serve, shownPoints } from "./page.mjs";

const run = process.env.ORB360_RUN;
let browser;

before(async () => {
  browser = await launch();
});

after(() => browser.close());

/** A copy of the run that a test may change. */
async function withCopy(change, body) {
  const folder = mkdtempSync(join(tmpdir(), "orb360_viewer_"));
  try {
    cpSync(run, folder, { recursive: true });
    change(folder);
    const other = await serve(folder);
    try {
      await body(other);
    } finally {
      await other.stop();
    }
  } finally {
    rmSync(folder, { recursive: true });
  }
}

/** Changes what a run's summary states. */
function edit(folder, change) {
  const path = join(folder, "summary.json");
  const summary = JSON.parse(readFileSync(path));
  change(summary);
  writeFileSync(path, JSON.stringify(summary));
}

test("serves two viewers at once", async () => {
  const server = await serve(run);
  const other = await launch(); // A page in the background would not draw.
  try {
    const pages = await Promise.all([open(browser, server.url), open(other, server.url)]);
    for (const page of pages) {
      assert.ok((await shownPoints(page)) > 10000);
      assert.deepEqual(page.problems, []);
      await page.close();
    }
  } finally {
    await other.close();
    await server.stop();
  }
});

test("says that the server is gone, and goes on when it is back", async () => {
  const first = await serve(run);
  const page = await open(browser, first.url);
  assert.equal(await first.stop(), 0);
  await page.waitForFunction(() => document.body.dataset.connection === "lost");
  assert.ok(
    await page.$eval("#banner", (banner) => !banner.hidden && banner.textContent.length > 20),
  );
  assert.ok((await shownPoints(page)) > 10000, "what was loaded is gone");
  const second = await serve(run, first.port);
  await page.waitForFunction(() => document.body.dataset.connection === "connected");
  assert.ok(await page.$eval("#banner", (banner) => banner.hidden));
  await page.close();
  await second.stop();
});

test("shows a run of unknown scale in units", async () => {
  const change = (folder) =>
    edit(folder, (summary) => {
      summary.scale = { state: "unknown", value: null, sigma: null };
    });
  await withCopy(change, async (other) => {
    const page = await open(browser, other.url);
    assert.equal(await page.$eval(".chip", (chip) => chip.textContent), "scale unknown");
    assert.match(await page.$eval("#panel", (panel) => panel.textContent), /\d units/);
    assert.doesNotMatch(await page.$eval(".tiles", (tiles) => tiles.textContent), /\d m\b/);
    await page.close();
  });
});

test("shows the path of a run without a cloud, and says what is missing", async () => {
  const change = (folder) => {
    for (const name of ["cloud.ply", "cloud.octree", "views"]) {
      rmSync(join(folder, name), { recursive: true });
    }
    edit(folder, (summary) => (summary.input = "gone.mp4"));
  };
  await withCopy(change, async (other) => {
    const page = await open(browser, other.url);
    assert.match(await page.$eval("#center", (center) => center.textContent), /No points/);
    assert.ok((await findColor(page, "path")).length > 20);
    assert.match(await page.$eval(".notes", (notes) => notes.textContent), /--save-views/);
    await page.keyboard.press("]");
    await page.waitForSelector("#panorama.without-image");
    assert.deepEqual(page.problems, []);
    await page.close();
  });
});

test("shows images of the input where the run kept none", async () => {
  await withCopy(
    (folder) => rmSync(join(folder, "views"), { recursive: true }),
    async (other) => {
      const page = await open(browser, other.url);
      await page.keyboard.press("]");
      await page.waitForSelector("#panorama:not([hidden]):not(.without-image)");
      await page.waitForFunction(() =>
        /No range/.test(document.querySelector("#panorama .notice").textContent),
      );
      const range = await page.evaluate(
        () =>
          [...document.querySelectorAll("#panorama .segmented button")].find(
            (button) => button.textContent === "Range",
          ).disabled,
      );
      assert.ok(range);
      assert.deepEqual(page.problems, []);
      await page.close();
    },
  );
});

test("shows why a run cannot be loaded", async () => {
  await withCopy(
    () => {},
    async (other) => {
      const page = await browser.newPage();
      await page.setRequestInterception(true);
      page.on("request", (request) =>
        request.url().endsWith("run.json")
          ? request.respond({ status: 500, body: "summary.json: is damaged" })
          : request.continue(),
      );
      await page.goto(other.url);
      await page.waitForFunction(() => document.body.dataset.state === "failed");
      assert.match(await page.$eval("#center", (center) => center.textContent), /is damaged/);
      await page.close();
    },
  );
});

test("opens a report from a file, without a server", async () => {
  const page = await open(browser, pathToFileURL(process.env.ORB360_REPORT).href);
  assert.equal(await page.evaluate(() => document.body.dataset.connection), "embedded");
  assert.ok((await shownPoints(page)) > 10000);
  assert.ok((await coverage(page)) > 0.1);
  await page.keyboard.press("]");
  await page.waitForSelector("#panorama:not([hidden]):not(.without-image)");
  assert.deepEqual(page.problems, []);
  for (const url of page.requests) assert.match(url.slice(0, 5), /^(file:|data:|blob:)$/);
  await page.close();
});
