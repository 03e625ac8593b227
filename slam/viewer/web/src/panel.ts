import type * as THREE from "three";
import { scaleChart, stageChart } from "./charts";
import type { ClipBox } from "./clip_box";
import { h } from "./dom";
import { grouped, length } from "./format";
import { section, togglePanel, type Layout } from "./layout";
import type { PointCloud } from "./point_cloud";
import { PointControls } from "./point_controls";
import type { Run } from "./run";
import { factTiles, notes, scaleState } from "./run_facts";
import type { TrajectoryLayer } from "./trajectory_layer";
import type { Viewport } from "./viewport";

/** Opens the panel at one of its sections. */
export function showSection(page: Layout, id: string): void {
  const part = page.panelBody.querySelector<HTMLDetailsElement>(`#${id}`);
  if (!part) return;
  togglePanel(true);
  part.open = true;
  part.scrollIntoView({ block: "nearest" });
}

/** Title and state of the scale over the view. */
function fillBar(run: Run, page: Layout): void {
  const name = run.summary.input || run.folder;
  const shortName = name.replace(/\/+$/, "").split("/").pop() || name;
  document.title = `${shortName} · orb360`;
  page.title.textContent = shortName;
  page.title.title = `${name}, in ${run.folder}`;
  const scale = scaleState(run);
  page.chip.textContent = scale.chip;
  page.chip.className = `chip ${scale.state}`;
  page.chip.hidden = false;
  page.chip.title = scale.sentence;
  page.chip.addEventListener("click", () => showSection(page, "scale-section"));
}

function layerToggles(run: Run, layer: TrajectoryLayer, onChange: () => void): HTMLElement {
  const toggle = (name: string, key: string, object: THREE.Object3D, count: number): HTMLElement =>
    h(
      "label",
      { class: "check" },
      h("input", {
        type: "checkbox",
        checked: object.visible && count > 0,
        disabled: count === 0,
        onchange: (event: Event) => {
          object.visible = (event.target as HTMLInputElement).checked;
          onChange();
        },
      }),
      h("i", { class: `swatch ${key}` }),
      h("span", {}, name),
      h("small", {}, grouped(count)),
    );
  return h(
    "div",
    { class: "checks" },
    toggle("Path", "path", layer.path.object, run.frames.index.length),
    toggle("Keyframes", "keyframe", layer.keyframes, run.keyframes.length),
    toggle("Keyframe graph", "link", layer.links, run.links.length / 3),
    toggle("Loops", "loop", layer.loops.object, run.loops.length),
  );
}

/** Fills bar and panel with what a run states. */
export function fillPanel(
  run: Run,
  page: Layout,
  layer: TrajectoryLayer,
  onChange: () => void,
): void {
  fillBar(run, page);
  const scale = section("Scale", true, h("p", {}, scaleState(run).sentence), scaleChart(run));
  scale.id = "scale-section";
  const facts = factTiles(run);
  const times = stageChart(
    run.summary.timing_ms ?? {},
    "Median · 95th percentile of the frames. Stages may overlap.",
  );
  const notices = notes(run);
  page.panelBody.append(
    ...[
      section("Layers", true, layerToggles(run, layer, onChange)),
      facts.childElementCount > 0 && section("Run", true, facts),
      scale,
      times && section("Time of a frame", false, times),
      notices && section("Notes", true, notices),
      h("p", { class: "caption version" }, `orb360 ${run.summary.version ?? ""}`),
    ].filter((part) => part !== null && part !== false),
  );
}

/** Adds what belongs to the cloud at the top of the panel. */
export function addCloudSections(
  run: Run,
  page: Layout,
  cloud: PointCloud,
  clipBox: ClipBox,
  viewport: Viewport,
): void {
  const points = section("Points", true, new PointControls(run, cloud, viewport).element);
  const size = length(cloud.header.side, run.unit);
  points.title = `Octree of ${grouped(cloud.nodes.length)} nodes, ${size} wide`;
  const clip = section("Clip box", false, clipBox.element);
  clip.id = "clip-section";
  page.panelBody.prepend(points);
  points.after(clip);
}
