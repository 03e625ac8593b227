// Comparisons in a real browser (ORB360_RUN: a run, ORB360_TOWN: its input with ground truth,
// ORB360_COMPARED: a report of both).
import assert from "node:assert/strict";
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { findColor, launch, open, serve, settle } from "./page.mjs";

const run = process.env.ORB360_RUN;
let browser;

before(async () => {
  browser = await launch();
});

after(() => browser.close());

/** Clicks a button or a label of the comparison. */
async function choose(page, text) {
  await page.evaluate(
    (wanted) =>
      [...document.querySelectorAll("#comparison-section :is(button, label)")]
        .find((element) => element.textContent.includes(wanted))
        .click(),
    text,
  );
  await settle(page);
}

function textOf(page, selector) {
  return page.$eval(selector, (element) => element.textContent);
}

/** What a comparison with ground truth has to show. */
async function checkWithTruth(page) {
  assert.match(await textOf(page, "#comparison-section"), /ground truth.*SE\(3\)/);
  assert.match(await textOf(page, ".tiles"), /\d c?mabsolute|absolute.*\d c?m/);
  await page.keyboard.press("t");
  await choose(page, "Error");
  assert.equal((await findColor(page, "path")).length, 0, "the path has its own colour still");
  assert.ok(await page.$eval("#comparison-section .legend", (legend) => !legend.hidden));
  assert.match(await textOf(page, "#comparison-section .legend"), /^0\.0 cm.* c?m$/);
  assert.ok(
    (await page.$eval("#comparison-section polyline", (line) => line.points.numberOfItems)) > 40,
  );
  await choose(page, "One colour");
  assert.ok((await findColor(page, "path")).length > 20);
  // The run lies over the truth.
  await page.evaluate(() =>
    [...document.querySelectorAll(".check")]
      .filter((check) => /^(Path|Keyframes)/.test(check.textContent))
      .forEach((check) => check.click()),
  );
  await settle(page);
  assert.ok((await findColor(page, "other")).length > 20);
  await choose(page, "Ground truth");
  assert.equal((await findColor(page, "other")).length, 0);
  assert.deepEqual(page.problems, []);
}

test("compares a run with its ground truth", async () => {
  const server = await serve(run, 0, ["--compare", process.env.ORB360_TOWN]);
  const page = await open(browser, server.url);
  await checkWithTruth(page);
  await page.close();
  await server.stop();
});

test("a report compares without a server", async () => {
  const page = await open(browser, pathToFileURL(process.env.ORB360_COMPARED).href);
  await checkWithTruth(page);
  await page.close();
});

test("compares with a run of unknown scale, and shows its cloud", async () => {
  const other = mkdtempSync(join(tmpdir(), "orb360_compare_"));
  try {
    cpSync(run, other, { recursive: true });
    const path = join(other, "summary.json");
    const summary = JSON.parse(readFileSync(path));
    writeFileSync(path, JSON.stringify({ ...summary, scale: { state: "unknown" } }));
    const server = await serve(run, 0, ["--compare", other]);
    const page = await open(browser, server.url);
    assert.match(await textOf(page, "#comparison-section"), /other run has no metres.*Sim\(3\)/i);
    const shown = (name) => page.$eval("#view", (canvas, key) => Number(canvas.dataset[key]), name);
    assert.equal(await shown("otherPoints"), 0);
    await choose(page, "Cloud of the other run");
    // It is the same cloud, in the same place.
    assert.equal(await shown("otherPoints"), await shown("points"));
    await choose(page, "Cloud of the other run");
    assert.equal(await shown("otherPoints"), 0);
    assert.deepEqual(page.problems, []);
    for (const url of page.requests) {
      assert.ok(url.startsWith(server.url) || /^(data|blob):/.test(url), `asked for ${url}`);
    }
    await page.close();
    await server.stop();
  } finally {
    rmSync(other, { recursive: true });
  }
});
