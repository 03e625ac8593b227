import type * as THREE from "three";
import { h } from "./dom";
import type { Viewport } from "./viewport";

/** A text at a place of the world, over the canvas. */
export interface Label {
  setText(text: string): void;
  setPosition(position: THREE.Vector3): void;
  remove(): void;
}

/** Texts that follow places of the world. Their owner calls update() after each drawing. */
export class Labels {
  private readonly items = new Set<{ element: HTMLElement; position: THREE.Vector3 }>();

  constructor(
    private readonly layer: HTMLElement,
    private readonly viewport: Viewport,
  ) {}

  add(text: string, position: THREE.Vector3, kind = ""): Label {
    const element = h("div", { class: `label ${kind}` }, text);
    const item = { element, position: position.clone() };
    this.items.add(item);
    this.layer.append(element);
    this.place(item);
    return {
      setText: (changed) => (element.textContent = changed),
      setPosition: (changed) => {
        item.position.copy(changed);
        this.place(item);
      },
      remove: () => {
        element.remove();
        this.items.delete(item);
      },
    };
  }

  update(): void {
    for (const item of this.items) this.place(item);
  }

  private place(item: { element: HTMLElement; position: THREE.Vector3 }): void {
    const at = this.viewport.project(item.position);
    item.element.hidden = at === null;
    if (at) item.element.style.transform = `translate(${at.x}px, ${at.y}px) translate(-50%, -140%)`;
  }
}
