import { h } from "./dom";

const KEYS: [string, string][] = [
  ["Drag, one finger", "turn"],
  ["Right drag, two fingers", "move"],
  ["Wheel, pinch", "zoom to the cursor"],
  ["Double click", "look at a point"],
  ["← → ↑ ↓", "turn"],
  ["W A S D", "move"],
  ["+ −", "zoom"],
  ["H, T", "whole run, from above"],
  ["M, G", "measure distances, heights over the ground"],
  ["C", "clip box"],
  ["[ ]", "previous, next keyframe"],
  ["P", "panel"],
  ["Esc", "end a line, a tool, the panorama"],
];

/** A dialog with the ways to move around. */
export function makeHelp(): HTMLDialogElement {
  const dialog = h("dialog", { id: "help", "aria-label": "Keys and gestures" });
  dialog.append(
    h("h2", {}, "Keys and gestures"),
    h("dl", {}, ...KEYS.flatMap(([key, action]) => [h("dt", {}, key), h("dd", {}, action)])),
    h("button", { type: "button", onclick: () => dialog.close() }, "Close"),
  );
  document.body.append(dialog);
  return dialog;
}
