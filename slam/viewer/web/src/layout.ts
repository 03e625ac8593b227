import { h, icon, svg } from "./dom";

/** The fixed parts of the page. */
export interface Layout {
  canvas: HTMLCanvasElement;
  labels: HTMLElement;
  stage: HTMLElement;
  panel: HTMLElement;
  panelBody: HTMLElement;
  title: HTMLElement;
  chip: HTMLElement;
  toolbar: HTMLElement;
  counter: HTMLElement;
  progress: HTMLElement;
  banner: HTMLElement;
  center: HTMLElement;
}

function brand(): HTMLElement {
  return h(
    "span",
    { class: "brand" },
    svg(
      "svg",
      { viewBox: "0 0 32 32", width: 24, height: 24, fill: "none", "aria-hidden": "true" },
      svg("circle", { cx: 16, cy: 16, r: 13, stroke: "currentColor", "stroke-width": 2.6 }),
      svg("ellipse", {
        cx: 16,
        cy: 16,
        rx: 13,
        ry: 5,
        stroke: "currentColor",
        "stroke-width": 1.8,
      }),
      svg("circle", { cx: 16, cy: 16, r: 3.4, class: "brand-dot" }),
    ) as unknown as Node,
    h("b", {}, "orb360"),
  );
}

/** Makes the page, with a panel that can be folded away. */
export function makeLayout(): Layout {
  const canvas = h("canvas", {
    id: "view",
    tabindex: 0,
    role: "application",
    "aria-label":
      "3D view of the run. Arrow keys turn, W A S D move, plus and minus zoom, question mark lists all keys.",
  });
  const labels = h("div", { class: "labels", "aria-hidden": "true" });
  const title = h("h1", {});
  const chip = h("button", { type: "button", class: "chip", hidden: true });
  const panelBody = h("div", { class: "panel-body" });
  const panel = h("aside", { id: "panel", "aria-label": "Run" }, panelBody);
  const menu = h(
    "button",
    {
      type: "button",
      class: "icon",
      "aria-label": "Show or hide the panel",
      title: "Panel (P)",
      "aria-expanded": "true",
      "aria-controls": "panel",
      id: "menu",
      onclick: () => togglePanel(),
    },
    icon("menu"),
  );
  const toolbar = h("div", { id: "toolbar", role: "toolbar", "aria-label": "Tools", hidden: true });
  const counter = h("div", { id: "counter" });
  const progress = h(
    "div",
    { id: "progress", role: "progressbar", "aria-label": "Loading points" },
    h("i"),
  );
  const banner = h("div", { id: "banner", role: "alert", hidden: true });
  const center = h("div", { id: "center" });
  const stage = h("main", { id: "stage" }, canvas, labels, progress, center, toolbar, counter);
  document
    .getElementById("app")!
    .append(
      h("header", { id: "bar" }, menu, brand(), title, h("span", { class: "spacer" }), chip),
      banner,
      stage,
      panel,
    );
  if (innerWidth < 720) togglePanel(false);
  return {
    canvas,
    labels,
    stage,
    panel,
    panelBody,
    title,
    chip,
    toolbar,
    counter,
    progress,
    banner,
    center,
  };
}

/** Shows or hides the panel. */
export function togglePanel(isShown?: boolean): void {
  const app = document.getElementById("app")!;
  const isHidden = app.classList.toggle(
    "without-panel",
    isShown === undefined ? undefined : !isShown,
  );
  document.getElementById("menu")?.setAttribute("aria-expanded", String(!isHidden));
}

/** A part of the panel that can be folded. */
export function section(name: string, isOpen: boolean, ...children: (Node | null)[]): HTMLElement {
  return h("details", { class: "section", open: isOpen }, h("summary", {}, name), ...children);
}

/** A message in the middle of the view. */
export function centerMessage(title: string, text: string, ...actions: Node[]): HTMLElement {
  return h("div", { class: "message" }, h("h2", {}, title), h("p", {}, text), ...actions);
}
