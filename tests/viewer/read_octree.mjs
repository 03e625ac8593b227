// Reads an octree with the page's own reader and prints each point: node read_octree.mjs FILE WEB.
// WEB is the folder with the page's sources and esbuild.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

const [file, web] = process.argv.slice(2);
const esbuild = createRequire(join(web, "package.json"))("esbuild");
const { outputFiles } = await esbuild.build({
  entryPoints: [join(web, "src/octree_file.ts")],
  bundle: true,
  format: "esm",
  write: false,
});
const reader = await import(
  "data:text/javascript;base64," + Buffer.from(outputFiles[0].contents).toString("base64")
);

const all = readFileSync(file);
const slice = (begin, end) => all.buffer.slice(all.byteOffset + begin, all.byteOffset + end);
try {
  const header = reader.readHeader(slice(0, Math.min(reader.HEADER_BYTES, all.length)));
  const nodes = reader.readIndex(slice(header.indexOffset, header.fileSize), header);
  const named = new Set(nodes.flatMap((node) => node.children));
  if (named.size !== nodes.length - 1) throw new Error("children and nodes differ");
  const lines = [];
  for (const node of nodes) {
    const bytes = slice(node.offset, node.offset + reader.nodeBytes(node));
    const { positions, colors } = reader.readPoints(bytes, node);
    for (let i = 0; i < node.pointCount; ++i) {
      const place = [0, 1, 2].map(
        (axis) => node.min[axis] + ((positions[4 * i + axis] + 0.5) * node.side) / 65536,
      );
      lines.push([...place, ...colors.subarray(4 * i, 4 * i + 4), node.side / 65536].join(" "));
    }
  }
  process.stdout.write(lines.join("\n") + "\n");
} catch (error) {
  process.stderr.write(`${error.message}\n`);
  process.exitCode = 1;
}
