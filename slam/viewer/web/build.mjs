// Makes dist/ from src/: node build.mjs [FOLDER]. The same sources and the same package-lock.json
// give the same bytes.
import { copyFile, mkdir, readFile, rename } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, "dist");
await mkdir(out, { recursive: true });
const licence = await readFile(join(here, "node_modules/three/LICENSE"), "utf8");
await build({
  absWorkingDir: here,
  entryPoints: ["src/main.ts", "src/style.css"],
  outdir: out,
  bundle: true,
  format: "iife",
  target: ["chrome100", "firefox100", "safari16"],
  minify: true,
  charset: "utf8",
  legalComments: "none",
  banner: {
    js: `/* The page of orb360, BSD-3-Clause. It contains three.js:\n${licence.trim()}\n*/`,
  },
  logLevel: "warning",
});
await rename(join(out, "main.js"), join(out, "viewer.js"));
await rename(join(out, "style.css"), join(out, "viewer.css"));
await copyFile(join(here, "src/index.html"), join(out, "index.html"));
