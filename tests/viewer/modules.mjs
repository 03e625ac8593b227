// Modules of the page by themselves, bundled by esbuild.
import { createRequire } from "node:module";
import { fileURLToPath } from "node:url";

const web = fileURLToPath(new URL("../viewer_web/", import.meta.url));
const esbuild = createRequire(`${web}package.json`)("esbuild");

/** Imports what a TypeScript text exports. */
export async function load(text) {
  const { outputFiles } = await esbuild.build({
    stdin: { contents: text, resolveDir: web, loader: "ts" },
    bundle: true,
    format: "esm",
    write: false,
  });
  return import(
    "data:text/javascript;base64," + Buffer.from(outputFiles[0].contents).toString("base64")
  );
}

// What modules look for in a page when they are loaded.
globalThis.document = { getElementById: () => null };
