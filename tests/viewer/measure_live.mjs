// What a page costs a run, and how old what it shows is: node measure_live.mjs INPUT OUT [PAIRS], in
// build/viewer_tests. Each pair is a run without and one with a viewer, which asks for all that the
// page asks for as often, but draws nothing: a browser would take the processor from the run. The
// latency is that of a page in a browser, from the frame that was tracked to its image on the page.
import { execFileSync, spawn } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { launch, orb360, serveLive } from "./page.mjs";

process.env.ORB360_CHROMIUM ??= "/usr/bin/chromium";
const POLL_MS = 130; // as in slam/viewer/web/src/live.ts
const [input, out, pairs = "5"] = process.argv.slice(2);
const options = ["--weights", "none", "--mask", "none"];

const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

/** Milliseconds of a frame, of the whole run. */
function millisecondsOf(folder) {
  const { seconds, frames } = JSON.parse(readFileSync(join(folder, "summary.json")));
  return (1000 * seconds) / frames;
}

/** Asks for what the page asks for until the run has ended. */
async function watch(url) {
  let revision = 0;
  for (;;) {
    const begin = Date.now();
    try {
      const state = await (await fetch(`${url}live.json?since=${revision}`)).json();
      if (state.revision > revision) {
        await (await fetch(`${url}live.points?since=${revision}`)).arrayBuffer();
        revision = state.revision;
      }
      await (await fetch(`${url}live.image`)).arrayBuffer();
    } catch {
      return;
    }
    await new Promise((resolve) => setTimeout(resolve, Math.max(20, POLL_MS - (Date.now() - begin))));
  }
}

function runUnseen(folder) {
  execFileSync(orb360, ["run", input, "--out", folder, ...options], { stdio: "ignore" });
}

async function runSeen(folder) {
  const program = spawn(orb360, ["run", input, "--out", folder, ...options, "--view=0"]);
  let text = "";
  program.stdout.on("data", (data) => {
    const isNew = !text.includes("http");
    text += data;
    const found = /(http:\S+)\s/.exec(text);
    if (isNew && found) void watch(found[1]);
  });
  await new Promise((resolve) => program.on("exit", resolve));
}

const ratios = [];
for (let i = 0; i < Number(pairs); ++i) {
  const [unseen, seen] = [join(out, "unseen"), join(out, "seen")];
  // Which one comes first alternates.
  if (i % 2 === 0) runUnseen(unseen);
  await runSeen(seen);
  if (i % 2 === 1) runUnseen(unseen);
  ratios.push(millisecondsOf(seen) / millisecondsOf(unseen));
  console.log(
    `${millisecondsOf(unseen).toFixed(1)} ms a frame unseen, ${millisecondsOf(seen).toFixed(1)} seen`,
  );
}
console.log(`a viewer makes a run ${(100 * (median(ratios) - 1)).toFixed(1)} % longer (median)`);

const live = await serveLive(input, join(out, "latency"));
const browser = await launch();
const page = await browser.newPage();
await page.goto(live.url);
await page.waitForFunction(() => {
  const button = document.querySelector(".live-buttons button");
  if (button?.textContent !== "Go on") return false;
  button.click();
  return true;
});
const latencies = [];
let lastFrame = "";
let hasEnded = false;
void live.ended.then(() => (hasEnded = true));
while (!hasEnded) {
  const { frame, latency } = await page.evaluate(() => {
    const { imageFrame, latency } = document.querySelector("#view").dataset;
    return { frame: imageFrame, latency };
  });
  if (frame !== lastFrame && latency !== undefined) latencies.push(Number(latency));
  lastFrame = frame;
  await new Promise((resolve) => setTimeout(resolve, 20));
}
await browser.close();
console.log(
  `latency of ${latencies.length} images: median ${median(latencies)} ms, 95th percentile ` +
    `${latencies.sort((a, b) => a - b)[Math.floor(0.95 * latencies.length)]} ms`,
);
