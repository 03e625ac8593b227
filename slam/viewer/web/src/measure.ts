import * as THREE from "three";
import { announce } from "./dom";
import { uncertainLength } from "./format";
import { groundBelow } from "./ground";
import type { Label, Labels } from "./labels";
import { scaleSigma, type Run } from "./run";
import { WideLines } from "./trajectory_layer";

export type MeasureMode = "distance" | "height";

/** Distances between picked points, and heights of points above the ground. */
export class Measure {
  readonly group = new THREE.Group();
  mode: MeasureMode | null = null;
  private readonly lines = new WideLines(2.5);
  private readonly rubber = new WideLines(2.5);
  private segments: number[] = [];
  private labels: Label[] = [];
  private rubberLabel: Label | null = null;
  private last: THREE.Vector3 | null = null; // where the line goes on
  private latest: THREE.Vector3 | null = null; // picked since the line or the tool began

  constructor(
    private readonly run: Run,
    private readonly texts: Labels,
    private readonly onChange: () => void,
  ) {
    this.lines.drawOnTop();
    this.rubber.drawOnTop();
    this.rubber.setOpacity(0.7);
    this.group.add(this.lines.object, this.rubber.object);
  }

  setMode(mode: MeasureMode | null): void {
    this.mode = mode;
    this.endLine();
  }

  /** A point was picked. */
  add(point: THREE.Vector3): void {
    if (this.latest?.equals(point)) return; // the second click of a double click
    this.latest = point.clone();
    if (this.mode === "height") this.addHeight(point);
    else if (this.mode === "distance") this.addDistance(point);
    this.onChange();
  }

  /** The point under the cursor has changed. */
  hover(point: THREE.Vector3 | null): void {
    const last = this.last;
    if (this.mode !== "distance" || !last || !point || point.equals(last)) {
      this.hideRubber();
      return;
    }
    this.rubber.setSegments([...last.toArray(), ...point.toArray()]);
    const middle = last.clone().lerp(point, 0.5);
    const text = this.describe(last.distanceTo(point));
    this.rubberLabel ??= this.texts.add(text, middle, "faint");
    this.rubberLabel.setText(text);
    this.rubberLabel.setPosition(middle);
    this.onChange();
  }

  /** The next point begins another line. */
  endLine(): void {
    this.last = null;
    this.latest = null;
    this.hideRubber();
    this.onChange();
  }

  clear(): void {
    this.segments = [];
    this.lines.setSegments([]);
    for (const label of this.labels) label.remove();
    this.labels = [];
    this.endLine();
  }

  setColor(color: string): void {
    this.lines.setColor(color);
    this.rubber.setColor(color);
  }

  resize(width: number, height: number): void {
    this.lines.resize(width, height);
    this.rubber.resize(width, height);
  }

  private hideRubber(): void {
    this.rubber.setSegments([]);
    this.rubberLabel?.remove();
    this.rubberLabel = null;
  }

  private describe(value: number): string {
    return uncertainLength(value, this.run.unit, scaleSigma(this.run));
  }

  private addSegment(
    from: THREE.Vector3,
    to: THREE.Vector3,
    text: string,
    at: THREE.Vector3,
  ): void {
    this.segments.push(...from.toArray(), ...to.toArray());
    this.lines.setSegments(this.segments);
    this.labels.push(this.texts.add(text, at));
    announce(text);
  }

  private addDistance(point: THREE.Vector3): void {
    if (!this.last) {
      this.last = point.clone();
      this.labels.push(this.texts.add("", point, "dot"));
      return;
    }
    const text = this.describe(this.last.distanceTo(point));
    this.addSegment(this.last, point, text, this.last.clone().lerp(point, 0.5));
    this.last = point.clone();
    this.hideRubber();
  }

  private addHeight(point: THREE.Vector3): void {
    const ground = groundBelow(this.run, point);
    if (!ground) {
      announce("The ground is not known in this run, so there are no heights.");
      this.labels.push(this.texts.add("the ground is not known in this run", point, "faint"));
      return;
    }
    const foot = new THREE.Vector3(point.x, point.y, ground.z);
    const height = point.z - ground.z;
    const text = `${this.describe(height)} above the ground of frame ${ground.frame}`;
    this.addSegment(foot, point, text, point);
  }
}
