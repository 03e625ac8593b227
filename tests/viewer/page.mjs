// What the tests of the page share: the program, the browser, and the pixels of the screen.
import { spawn } from "node:child_process";
import { request } from "node:http";
import { join } from "node:path";
import puppeteer from "puppeteer-core";

export const orb360 = join(process.env.ORB360_BINARY_DIR, "orb360");

/** Starts the program and waits until it prints an address. */
async function start(parameters) {
  const program = spawn(orb360, parameters);
  const ended = new Promise((resolve) => program.on("exit", resolve));
  let text = "";
  const url = await new Promise((resolve, reject) => {
    program.stdout.on("data", (data) => {
      text += data;
      const found = /(http:\S+)\s/.exec(text);
      if (found) resolve(found[1]);
    });
    program.stderr.on("data", (data) => (text += data));
    ended.then(() => reject(new Error(`orb360 has ended: ${text}`)));
  });
  return { program, ended, url };
}

/** Starts `orb360 view`. */
export async function serve(run, port = 0, more = []) {
  const { program, ended, url } = await start(["view", run, "--port", String(port), ...more]);
  return {
    url,
    port: Number(new URL(url).port),
    /** Ends it as Ctrl-C does; gives its exit status. */
    stop: async () => {
      program.kill("SIGINT");
      return ended;
    },
  };
}

/** Starts a run that is shown, and pauses it at once. */
export async function serveLive(input, out, more = ["--weights", "none"], mask = "none") {
  const options = ["--out", out, "--mask", mask, "--view=0", ...more];
  const { program, ended, url } = await start(["run", input, ...options]);
  const { host, origin } = new URL(url);
  const status = await new Promise((resolve) =>
    request(
      `${url}pause`,
      { method: "POST", headers: { Host: host, Origin: origin, "Content-Length": 0 } },
      (response) => resolve(response.resume().statusCode),
    ).end(),
  );
  if (status !== 200) throw new Error(`pause was answered with ${status}`);
  return { ended, url, kill: () => program.kill("SIGKILL") };
}

export function launch() {
  return puppeteer.launch({
    executablePath: process.env.ORB360_CHROMIUM,
    headless: true,
    args: [
      "--no-sandbox",
      "--use-gl=angle",
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
      "--hide-scrollbars",
      "--allow-file-access-from-files",
    ],
  });
}

/** Opens a page and waits until its points are there. Its problems are collected. */
export async function open(browser, url, { width = 1200, height = 800, scheme = "dark" } = {}) {
  const page = await browser.newPage();
  page.problems = [];
  page.requests = [];
  page.on("console", (message) => {
    if (["error", "warn"].includes(message.type())) page.problems.push(message.text());
  });
  page.on("pageerror", (error) => page.problems.push(error.message));
  page.on("request", (request) => page.requests.push(request.url()));
  await page.setViewport({ width, height });
  await page.emulateMediaFeatures([
    { name: "prefers-color-scheme", value: scheme },
    { name: "prefers-reduced-motion", value: "reduce" },
  ]);
  await page.goto(url);
  await page.waitForFunction(() => document.body.dataset.state !== "loading");
  await settle(page);
  return page;
}

/** Waits until nothing more is loaded and what is there was drawn. */
export async function settle(page) {
  await page.evaluate(
    () =>
      new Promise((resolve) => {
        const canvas = document.getElementById("view");
        let quiet = 0;
        const look = () => {
          quiet = canvas.dataset.loading === "true" ? 0 : quiet + 1;
          if (quiet > 12) resolve();
          else setTimeout(() => requestAnimationFrame(look), 25);
        };
        look();
      }),
  );
}

export function shownPoints(page) {
  return page.$eval("#view", (canvas) => Number(canvas.dataset.points));
}

/** Pixels of a part of the screen: width, height, and RGBA of each. */
export async function pixels(page, clip) {
  const png = await page.screenshot({ encoding: "base64", clip });
  const result = await page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const { data: values } = context.getImageData(0, 0, image.width, image.height);
    let text = "";
    for (let i = 0; i < values.length; i += 8192) {
      text += String.fromCharCode(...values.subarray(i, i + 8192));
    }
    return { width: image.width, height: image.height, text: btoa(text) };
  }, png);
  return { ...result, rgba: Buffer.from(result.text, "base64") };
}

/** The middle of the view, which no panel covers. */
export async function viewClip(page) {
  const box = await page.$eval("#stage", (stage) => {
    const { x, y, width, height } = stage.getBoundingClientRect();
    return { x, y, width, height };
  });
  return { x: box.x + 10, y: box.y + 50, width: box.width - 20, height: box.height - 130 };
}

/** Fraction of the view that is not background. */
export async function coverage(page) {
  const { rgba } = await pixels(page, await viewClip(page));
  const background = await page.evaluate(() => {
    const hex = getComputedStyle(document.documentElement)
      .getPropertyValue("--canvas-background")
      .trim();
    return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
  });
  let covered = 0;
  for (let i = 0; i < rgba.length; i += 4) {
    if (background.some((value, c) => Math.abs(rgba[i + c] - value) > 2)) ++covered;
  }
  return covered / (rgba.length / 4);
}

/** Where the view has pixels of a colour of the theme, in CSS pixels of the page. */
export async function findColor(page, name) {
  const clip = await viewClip(page);
  const { width, rgba } = await pixels(page, clip);
  const wanted = await page.evaluate((variable) => {
    const hex = getComputedStyle(document.documentElement).getPropertyValue(variable).trim();
    return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
  }, `--canvas-${name}`);
  const found = [];
  for (let i = 0; i < rgba.length / 4; ++i) {
    if (wanted.every((value, c) => Math.abs(rgba[4 * i + c] - value) <= 3)) {
      found.push({ x: clip.x + (i % width), y: clip.y + Math.floor(i / width) });
    }
  }
  return found;
}
