/** Clicks that moved further, in CSS pixels, are drags. */
const CLICK_PIXELS = 5;

/** Places are CSS pixels of the element. */
export interface PointerEvents {
  onClick: (x: number, y: number) => void;
  onDoubleClick: (x: number, y: number) => void;
  /** A mouse without a pressed button was moved; once for each frame of the screen. */
  onHover: (x: number, y: number) => void;
}

/** Tells clicks from drags. */
export function listenToPointer(element: HTMLElement, events: PointerEvents): void {
  let down: { x: number; y: number } | null = null;
  let latest: { x: number; y: number } | null = null; // not yet looked at
  const placeOf = (event: MouseEvent): { x: number; y: number } => {
    const box = element.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };
  element.addEventListener("pointerdown", (event) => {
    down = event.isPrimary && event.button === 0 ? placeOf(event) : null;
  });
  element.addEventListener("pointerup", (event) => {
    const at = placeOf(event);
    if (down && Math.hypot(at.x - down.x, at.y - down.y) < CLICK_PIXELS) events.onClick(at.x, at.y);
    down = null;
  });
  element.addEventListener("dblclick", (event) => {
    const at = placeOf(event);
    events.onDoubleClick(at.x, at.y);
  });
  element.addEventListener("pointermove", (event) => {
    if (event.pointerType !== "mouse" || event.buttons !== 0) return;
    if (latest === null) {
      requestAnimationFrame(() => {
        events.onHover(latest!.x, latest!.y);
        latest = null;
      });
    }
    latest = placeOf(event);
  });
}
