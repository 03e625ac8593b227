// A run that goes on, in a real browser (ORB360_RUN: a finished run, beside which runs are written,
// ORB360_TOWN: its input).
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { coverage, launch, serveLive } from "./page.mjs";

const out = join(process.env.ORB360_RUN, "..");
const town = process.env.ORB360_TOWN;
let browser;

before(async () => {
  browser = await launch();
});

after(() => browser.close());

async function openLive(url) {
  const page = await browser.newPage();
  page.problems = [];
  page.on("pageerror", (error) => page.problems.push(error.message));
  page.on("console", (message) => message.type() === "error" && page.problems.push(message.text()));
  await page.emulateMediaFeatures([
    { name: "prefers-color-scheme", value: "dark" },
    { name: "prefers-reduced-motion", value: "reduce" },
  ]);
  await page.goto(url);
  return page;
}

function clickButton(page, name) {
  return page.evaluate(
    (text) =>
      [...document.querySelectorAll(".live-buttons button")]
        .find((button) => button.textContent === text)
        .click(),
    name,
  );
}

/** Asks for one frame and waits until the page shows where the run waits again: that frame. */
async function step(page) {
  const answer = page.waitForResponse((response) => response.url().endsWith("/step"));
  await clickButton(page, "One frame");
  await answer; // A state that is asked for from now on knows of the step.
  const shown = await page.waitForFunction(
    async () => {
      const state = await (await fetch("live.json?since=0")).json();
      const shown = Number(document.querySelector("#view").dataset.frame);
      return state.isWaiting && state.frame === shown && { shown };
    },
    { polling: 50 },
  );
  return (await shown.jsonValue()).shown;
}

function waitFor(page, name, least) {
  return page.waitForFunction(
    (key, value) => Number(document.querySelector("#view").dataset[key]) >= value,
    { timeout: 120_000 },
    name,
    least,
  );
}

test("shows, steps and finishes a run that goes on", async (t) => {
  const live = await serveLive(town, join(out, "live"));
  t.after(live.kill); // where the test fails before it has ended
  const page = await openLive(live.url);
  const click = (name) => clickButton(page, name);
  let frame = await step(page); // A frame may have been under way when the run was paused.
  for (let i = 0; i < 4; ++i) assert.equal(await step(page), ++frame);
  assert.equal(await page.$eval(".chip", (chip) => chip.textContent), "paused");
  assert.equal(await page.$eval("#view", (canvas) => canvas.dataset.imageFrame), String(frame));
  const isFollowing = () => page.$eval(".check input", (input) => input.checked);
  assert.ok(await isFollowing());
  await page.focus("#view");
  await page.keyboard.press("ArrowLeft");
  assert.ok(!(await isFollowing()), "keys move the camera, which then follows no more");
  await click("Go on");
  await page.waitForFunction(
    () =>
      Number(document.querySelector("#view").dataset.keyframes) > 3 &&
      Number(document.querySelector("#view").dataset.landmarks) > 100,
  );
  assert.ok(await page.$eval(".live-image canvas", (canvas) => canvas.width > 300));
  assert.deepEqual(
    await page.$$eval(".bar-name", (names) => names.map((name) => name.textContent).sort()),
    ["Features", "Tracking", "Waiting for mapping", "Whole frame"],
  );
  assert.deepEqual(page.problems, []);
  await click("Finish early");
  assert.equal(await live.ended, 0);
  await page.waitForFunction(() => document.body.dataset.connection === "lost");
  assert.match(await page.$eval("#banner", (banner) => banner.textContent), /has ended/);
  await page.close();
});

test("darkens what is left out of the images", async (t) => {
  // The right half of the image.
  const mask = join(out, "mask.pgm");
  const row = [...Array(32).fill(255), ...Array(32).fill(0)];
  const pixels = Buffer.from(Array(32).fill(row).flat());
  writeFileSync(mask, Buffer.concat([Buffer.from("P5 64 32 255\n"), pixels]));
  const options = ["--weights", "none"];
  const live = await serveLive(town, join(out, "live_masked"), options, mask);
  t.after(live.kill);
  const page = await openLive(live.url);
  await clickButton(page, "One frame");
  await page.waitForFunction(() => document.body.dataset.state === "ready");
  const [left, right] = await page.$eval(".live-image canvas", (canvas) => {
    const { width, height } = canvas;
    const context = canvas.getContext("2d");
    return [0, width / 2].map((x) => {
      const { data } = context.getImageData(x, 0, width / 2, height / 3); // the sky
      return data.reduce((sum, value, i) => sum + (i % 4 < 3 ? value : 0), 0) / data.length;
    });
  });
  assert.ok(right < 0.5 * left, `${left} and ${right}`);
  assert.deepEqual(page.problems, []);
  await clickButton(page, "Finish early");
  await live.ended;
  await page.close();
});

test("shows the dense cloud as depth is computed", async (t) => {
  const live = await serveLive(town, join(out, "live_dense"), ["--cloud-quality", "draft"]);
  t.after(live.kill); // where the test fails before it has ended
  const page = await openLive(live.url);
  // It was paused before its first frame.
  await page.waitForFunction(() =>
    /Go on/.test(document.querySelector(".live-buttons").textContent),
  );
  await clickButton(page, "Go on");
  await page.waitForFunction(() => document.body.dataset.state === "ready");
  await waitFor(page, "keyframes", 8);
  await clickButton(page, "Finish early");
  await page.waitForFunction(
    () => /^computing depth: \d+ of \d+ steps$/.test(document.querySelector(".chip").textContent),
    { timeout: 120_000 },
  );
  assert.ok(
    await page.$$eval(".live-buttons button", (all) => all.every((button) => button.disabled)),
    "there is nothing left to pause",
  );
  // How many parts the page has seen by now depends on how busy the machine is.
  const shown = await page.evaluateHandle(() => {
    const { dataset } = document.querySelector("#view");
    const counts = [Number(dataset.densePoints)];
    new MutationObserver(() => counts.push(Number(dataset.densePoints))).observe(
      document.querySelector("#view"),
      { attributeFilter: ["data-dense-points"] },
    );
    return counts;
  });
  await waitFor(page, "densePoints", 5001); // more than one view has
  assert.ok(await page.$eval(".live-image", (strip) => strip.hidden), "the image hides the cloud");
  assert.ok((await coverage(page)) > 0.02);
  assert.match(await page.$eval(".tiles", (tiles) => tiles.textContent), /points of depth maps/);
  assert.deepEqual(page.problems, []);
  assert.equal(await live.ended, 0);
  const counts = await shown.jsonValue();
  assert.deepEqual(counts, [...counts].sort((a, b) => a - b), "points were lost");
  await page.close();
});
