import type { Viewport } from "./viewport";

/** What keys that move the camera do; the same in every page. */
export function viewportKeys(viewport: Viewport): Record<string, () => void> {
  const turn = 0.12; // radians
  return {
    ArrowLeft: () => viewport.orbit(-turn, 0),
    ArrowRight: () => viewport.orbit(turn, 0),
    ArrowUp: () => viewport.orbit(0, -turn),
    ArrowDown: () => viewport.orbit(0, turn),
    w: () => viewport.pan(0, 0.1),
    s: () => viewport.pan(0, -0.1),
    a: () => viewport.pan(-0.1, 0),
    d: () => viewport.pan(0.1, 0),
    "+": () => viewport.zoom(0.8),
    "=": () => viewport.zoom(0.8),
    "-": () => viewport.zoom(1.25),
  };
}

/** Whether a key is for the element that has the focus and not for the view. */
export function isForControl(event: KeyboardEvent): boolean {
  const target = event.target as HTMLElement;
  if (event.ctrlKey || event.metaKey || event.altKey) return true;
  if (target.closest("dialog")) return true;
  const isControl = target.closest("input, summary, button, #panorama canvas") !== null;
  return isControl && (event.key.startsWith("Arrow") || event.key === " ");
}
