// What the page of a run does, in a real browser (ORB360_RUN: a run with views).
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { coverage, findColor, launch, open, serve, settle, shownPoints } from "./page.mjs";

const run = process.env.ORB360_RUN;
let browser;
let server;

before(async () => {
  browser = await launch();
  server = await serve(run);
});

after(async () => {
  await browser.close();
  assert.equal(await server.stop(), 0, "Ctrl-C ends orb360 view with status 0");
});

/** Runs a test on a page of its own, which must report no problem and load from its server only. */
function onPage(name, options, body) {
  test(name, async () => {
    const page = await open(browser, server.url, options);
    try {
      await body(page);
      assert.deepEqual(page.problems, []);
      for (const url of page.requests) {
        assert.ok(url.startsWith(server.url) || /^(data|blob):/.test(url), `asked for ${url}`);
      }
    } finally {
      await page.close();
    }
  });
}

function press(page, selector) {
  return page.$eval(selector, (button) => button.click());
}

onPage("shows the points of a run", {}, async (page) => {
  assert.equal(await page.evaluate(() => document.body.dataset.state), "ready");
  assert.ok((await shownPoints(page)) > 10000);
  assert.ok((await coverage(page)) > 0.1);
  assert.match(await page.title(), /orb360$/);
});

onPage("shows as many points as are asked for", {}, async (page) => {
  const all = await shownPoints(page);
  const ask = async (exponent) => {
    await page.evaluate((value) => {
      const slider = [...document.querySelectorAll(".slider input")].find((input) =>
        input.parentElement.textContent.startsWith("Points at once"),
      );
      slider.value = String(value);
      slider.dispatchEvent(new Event("input"));
    }, exponent);
    await settle(page);
    return shownPoints(page);
  };
  const few = await ask(4.5);
  assert.ok(few > 5000 && few < 60000, `${few} points`);
  assert.ok(few < 0.5 * all);
  assert.equal(await ask(7), all);
});

onPage("opens the panorama of a keyframe that is clicked", {}, async (page) => {
  await page.keyboard.press("t");
  await settle(page);
  const marks = await findColor(page, "keyframe");
  assert.ok(marks.length > 5, "no keyframe is to be seen");
  const { x, y } = marks[Math.floor(marks.length / 2)];
  await page.mouse.click(x, y);
  await page.waitForSelector("#panorama:not([hidden]):not(.without-image)");
  assert.match(await page.$eval("#panorama h2", (title) => title.textContent), /^Keyframe \d+/);
  const sphere = await page.$("#panorama canvas");
  const hasRange = () =>
    page.evaluate(() =>
      [...document.querySelectorAll("#panorama .segmented button")].every(
        (button) => !button.disabled,
      ),
    );
  for (let i = 0; i < 10 && !(await hasRange()); ++i) {
    // Not every keyframe is a view.
    await page.keyboard.press("]");
    await settle(page);
  }
  const image = await sphere.screenshot({ encoding: "base64" });
  await page.evaluate(() =>
    [...document.querySelectorAll("#panorama .segmented button")]
      .find((button) => button.textContent === "Range")
      .click(),
  );
  await page.waitForFunction(() =>
    document.querySelector("#panorama .legend").textContent.includes("m"),
  );
  await settle(page);
  assert.notEqual(await sphere.screenshot({ encoding: "base64" }), image);
  await sphere.hover();
  await page.waitForFunction(() =>
    /± .+ away, confidence|no range/.test(document.querySelector(".readout").textContent),
  );
  const box = await sphere.boundingBox();
  await page.mouse.move(box.x + 200, box.y + 100);
  await page.mouse.down();
  await page.mouse.move(box.x + 80, box.y + 140, { steps: 4 });
  await page.mouse.up();
  await page.keyboard.press("Escape");
  await page.waitForSelector("#panorama", { hidden: true });
});

onPage("shows in the cloud where a panorama looks", {}, async (page) => {
  await page.keyboard.press("]");
  await page.waitForSelector("#panorama:not([hidden]):not(.without-image)");
  await settle(page);
  const before = new Set((await findColor(page, "selected")).map(({ x, y }) => `${x} ${y}`));
  assert.ok(before.size > 20, "there is no arrow");
  const box = await (await page.$("#panorama canvas")).boundingBox();
  await page.mouse.move(box.x + 40, box.y + 150);
  await page.mouse.down();
  await page.mouse.move(box.x + 480, box.y + 150, { steps: 5 });
  await page.mouse.up();
  await settle(page);
  const turned = (await findColor(page, "selected")).filter(({ x, y }) => !before.has(`${x} ${y}`));
  assert.ok(turned.length > 20, "the arrow has not turned with the panorama");
});

onPage("measures distances with the uncertainty of the scale", {}, async (page) => {
  await page.keyboard.press("m");
  const { width, height } = page.viewport();
  await page.mouse.click(width / 2 + 130, height / 2 + 40);
  await page.mouse.click(width / 2 + 220, height / 2 + 10);
  await page.waitForFunction(() =>
    [...document.querySelectorAll(".label")].some((label) =>
      /\d m ± |\d cm ± /.test(label.textContent),
    ),
  );
  assert.match(await page.$eval("#announcer", (region) => region.textContent), /±/);
  await page.keyboard.press("g");
  await page.mouse.click(width / 2 + 130, height / 2 + 40);
  await page.waitForFunction(() =>
    [...document.querySelectorAll(".label")].some((label) =>
      /above the ground of frame/.test(label.textContent),
    ),
  );
  await press(page, "#toolbar button[aria-label='Remove measurements']");
  assert.equal((await page.$$(".label")).length, 0);
});

onPage(
  "colours points by height, confidence and error, with a legend in units",
  {},
  async (page) => {
    const before = await coverage(page);
    for (const [name, legend] of [
      ["Height", / m/],
      ["Confidence", /^0\.0.*1\.0$/],
      ["Error", /m/],
    ]) {
      await page.evaluate(
        (text) =>
          [...document.querySelectorAll("#panel .segmented button")]
            .find((button) => button.textContent === text)
            .click(),
        name,
      );
      await settle(page);
      assert.match(await page.$eval(".legend.wide", (node) => node.textContent), legend);
      assert.ok(Math.abs((await coverage(page)) - before) < 0.02);
    }
  },
);

onPage("hides what is outside the clip box", {}, async (page) => {
  const before = await coverage(page);
  await page.keyboard.press("c");
  await page.evaluate(() => {
    const slider = document.querySelector("input[aria-label='upper limit of x (forward)']");
    slider.value = "120";
    slider.dispatchEvent(new Event("input"));
  });
  await settle(page);
  assert.ok((await coverage(page)) < 0.8 * before);
  await page.keyboard.press("c");
  await settle(page);
  assert.ok(Math.abs((await coverage(page)) - before) < 0.02);
});

onPage("follows the system between dark and light", {}, async (page) => {
  const colors = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const dark = await colors();
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "light" }]);
  await settle(page);
  assert.notEqual(await colors(), dark);
  assert.ok((await coverage(page)) < 0.98, "the canvas has kept the dark background");
});

onPage("fits a screen of 360 pixels", { width: 360, height: 720 }, async (page) => {
  assert.ok((await coverage(page)) > 0.05);
  await page.click("#menu");
  await page.keyboard.press("]");
  await page.waitForSelector("#panorama:not([hidden])");
  const wide = await page.evaluate(() =>
    [...document.querySelectorAll("header *, #toolbar *, #panorama *")]
      .filter(
        (node) => node.getClientRects().length > 0 && node.getBoundingClientRect().right > 361,
      )
      .map((node) => node.outerHTML.slice(0, 80)),
  );
  assert.deepEqual(wide, []);
  assert.equal(await page.evaluate(() => document.scrollingElement.scrollWidth), 360);
});

onPage("names every control for screen readers", {}, async (page) => {
  await page.keyboard.press("]");
  const nameless = await page.evaluate(() =>
    [...document.querySelectorAll("button, input, canvas, section, aside")]
      .filter(
        (node) =>
          !(
            node.getAttribute("aria-label") ||
            node.textContent.trim() ||
            node.closest("label")?.textContent.trim()
          ),
      )
      .map((node) => node.outerHTML.slice(0, 80)),
  );
  assert.deepEqual(nameless, []);
});

onPage("turns and moves by the keyboard", {}, async (page) => {
  const shot = () => page.screenshot({ encoding: "base64" });
  await page.focus("#view");
  for (const key of ["ArrowLeft", "w", "+", "t", "h"]) {
    const before = await shot();
    await page.keyboard.press(key);
    await settle(page);
    assert.notEqual(await shot(), before, `${key} does nothing`);
  }
  await page.keyboard.press("?");
  await page.waitForSelector("dialog[open]");
  await page.keyboard.press("Escape");
});
