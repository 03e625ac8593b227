/** Colours of what is drawn on the canvas, as the style sheet has them. */

export interface CanvasColors {
  background: string;
  path: string;
  other: string;
  keyframe: string;
  selected: string;
  link: string;
  loop: string;
  measure: string;
  box: string;
}

export function canvasColors(): CanvasColors {
  const style = getComputedStyle(document.documentElement);
  const read = (name: string): string => style.getPropertyValue(`--canvas-${name}`).trim();
  return {
    background: read("background"),
    path: read("path"),
    other: read("other"),
    keyframe: read("keyframe"),
    selected: read("selected"),
    link: read("link"),
    loop: read("loop"),
    measure: read("measure"),
    box: read("box"),
  };
}

/** Calls back now and whenever the system changes between light and dark. */
export function followTheme(apply: (colors: CanvasColors) => void): void {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  apply(canvasColors());
  dark.addEventListener("change", () => apply(canvasColors()));
}
