import { h, icon } from "./dom";
import type { MeasureMode } from "./measure";

export interface ToolbarEvents {
  onHome: () => void;
  onTop: () => void;
  onMode: (mode: MeasureMode | null) => void;
  onClear: () => void;
  onClip: (isOn: boolean) => void;
  onHelp: () => void;
}

export interface Toolbar {
  /** Begins measuring, or ends it where it is on. */
  toggleMode(mode: MeasureMode): void;
  toggleClip(): void;
}

/** The buttons over the view. */
export function makeToolbar(element: HTMLElement, events: ToolbarEvents): Toolbar {
  const button = (
    name: Parameters<typeof icon>[0],
    text: string,
    key: string,
    action: () => void,
    canToggle = false,
  ): HTMLButtonElement =>
    h(
      "button",
      {
        type: "button",
        class: "icon",
        title: key ? `${text} (${key})` : text,
        "aria-label": text,
        "aria-pressed": canToggle ? "false" : null,
        onclick: action,
      },
      icon(name),
    );
  let mode: MeasureMode | null = null;
  let isClipped = false;
  const modes: Record<MeasureMode, HTMLButtonElement> = {
    distance: button(
      "measure",
      "Measure distances",
      "M",
      () => toolbar.toggleMode("distance"),
      true,
    ),
    height: button(
      "height",
      "Heights over the ground",
      "G",
      () => toolbar.toggleMode("height"),
      true,
    ),
  };
  const clip = button("clip", "Clip box", "C", () => toolbar.toggleClip(), true);
  const hint = h("span", { class: "hint", hidden: true });
  const toolbar: Toolbar = {
    toggleMode(chosen) {
      mode = mode === chosen ? null : chosen;
      for (const [name, node] of Object.entries(modes)) {
        node.setAttribute("aria-pressed", String(name === mode));
      }
      hint.hidden = mode === null;
      hint.textContent =
        mode === "distance" ? "Click points; double click ends a line" : "Click a point";
      events.onMode(mode);
    },
    toggleClip() {
      isClipped = !isClipped;
      clip.setAttribute("aria-pressed", String(isClipped));
      events.onClip(isClipped);
    },
  };
  element.append(
    button("home", "Whole run", "H", events.onHome),
    button("top", "From above", "T", events.onTop),
    h("i", { class: "divider" }),
    h(
      "span",
      { class: "for-cloud" },
      modes.distance,
      modes.height,
      button("trash", "Remove measurements", "", events.onClear),
      h("i", { class: "divider" }),
      clip,
    ),
    button("help", "Keys and gestures", "?", events.onHelp),
    hint,
  );
  return toolbar;
}
