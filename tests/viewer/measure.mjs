// Times and memory of the page for a run, or for a report (FILE.html): node measure.mjs RUN
// [POINTS [NEARER]], in build/viewer_tests.
// POINTS: how many may be shown at once. NEARER: how often plus is pressed from the first view.
import { readFileSync, readdirSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { launch, serve, shownPoints } from "./page.mjs";

process.env.ORB360_CHROMIUM ??= "/usr/bin/chromium";
const [run, points = "5000000", nearer = "10"] = process.argv.slice(2);
const server = run.endsWith(".html") ? null : await serve(run);
const browser = await launch();
const page = await browser.newPage();
await page.setViewport({ width: 1400, height: 900 });
const begin = Date.now();
const seconds = () => ((Date.now() - begin) / 1000).toFixed(2);
await page.goto(server?.url ?? pathToFileURL(run).href);
await page.waitForFunction(() => Number(document.querySelector("#view")?.dataset.points) > 0);
console.log(`first points drawn after ${seconds()} s`);
await page.evaluate((budget) => {
  const slider = [...document.querySelectorAll(".slider input")].find((input) =>
    input.parentElement.textContent.startsWith("Points at once"),
  );
  slider.value = String(Math.log10(budget) + 0.01);
  slider.dispatchEvent(new Event("input"));
}, Number(points));
await page.focus("#view");
for (let i = 0; i < Number(nearer); ++i) await page.keyboard.press("+");
await page.waitForFunction(() => document.querySelector("#view").dataset.loading === "false", {
  timeout: 600000,
});
console.log(`${await shownPoints(page)} points drawn after ${seconds()} s`);
const { JSHeapUsedSize } = await page.metrics();
console.log(`JavaScript heap ${(JSHeapUsedSize / 2 ** 20).toFixed(0)} MiB`);
const { arrayBuffers } = await page.evaluate(async () => {
  const memory = await performance.measureUserAgentSpecificMemory?.().catch(() => null);
  return { arrayBuffers: memory ? memory.bytes : null };
});
if (arrayBuffers) console.log(`page ${(arrayBuffers / 2 ** 20).toFixed(0)} MiB`);
// Resident memory of the browser's renderer and its graphics process.
for (const pid of readdirSync("/proc").filter((name) => /^\d+$/.test(name))) {
  try {
    const command = readFileSync(`/proc/${pid}/cmdline`, "utf8");
    const type = /--type=(renderer|gpu-process)/.exec(command);
    if (!type || !command.includes("puppeteer")) continue;
    const resident = Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, "utf8"))[1]);
    if (resident > 150000) console.log(`${type[1]} ${(resident / 1024).toFixed(0)} MiB resident`);
  } catch {
    /* It has ended. */
  }
}
await browser.close();
await server?.stop();
