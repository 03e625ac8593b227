import * as THREE from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import { orientationOf, positionOf, type Run } from "./run";
import type { CanvasColors } from "./theme";

const MARK_PIXELS = 9;
const PATH_PIXELS = 3;
/** With colours that mean something. */
const COLORED_PATH_PIXELS = 6;

const MARK_VERTEX = `
uniform float size;
in float isSelected;
out float selected;
void main() {
  selected = isSelected;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_PointSize = size * (isSelected > 0.5 ? 1.8 : 1.0);
}
`;

const MARK_FRAGMENT = `
uniform vec3 color, selectedColor, edge;
in float selected;
out vec4 pixel;
void main() {
  float r = length(2.0 * gl_PointCoord - 1.0);
  if (r > 1.0) discard;
  pixel = vec4(r > 0.72 ? edge : selected > 0.5 ? selectedColor : color, 1.0);
}
`;

/** A line of constant width on the screen through pairs of points. */
export class WideLines {
  readonly object: LineSegments2;
  private readonly material: LineMaterial;
  private color = "#ffffff";

  constructor(width: number) {
    this.material = new LineMaterial({ linewidth: width, worldUnits: false });
    this.object = new LineSegments2(new LineSegmentsGeometry(), this.material);
    this.object.frustumCulled = false;
    this.object.visible = false;
  }

  setSegments(coordinates: number[]): void {
    this.object.geometry.dispose();
    this.object.geometry = new LineSegmentsGeometry();
    this.object.visible = coordinates.length > 0;
    if (coordinates.length > 0) this.object.geometry.setPositions(coordinates);
  }

  setColor(color: string): void {
    this.color = color;
    if (!this.material.vertexColors) this.material.color.set(color);
  }

  /** Colours of the ends of segments, 3 numbers in 0..1 each; null: the one of setColor. */
  setColors(colors: number[] | null): void {
    if (colors) this.object.geometry.setColors(colors);
    this.material.vertexColors = colors !== null;
    this.material.color.set(colors ? "#ffffff" : this.color);
    this.material.needsUpdate = true;
  }

  setWidth(pixels: number): void {
    this.material.linewidth = pixels;
  }

  setOpacity(opacity: number): void {
    this.material.transparent = opacity < 1;
    this.material.opacity = opacity;
  }

  /** Lines that must be seen even behind points. */
  drawOnTop(): void {
    this.material.depthTest = false;
    this.object.renderOrder = 10;
  }

  resize(width: number, height: number): void {
    this.material.resolution.set(width, height);
  }
}

/** Path, keyframes, their graph and the loops. */
export class TrajectoryLayer {
  readonly group = new THREE.Group();
  readonly path = new WideLines(PATH_PIXELS);
  readonly loops = new WideLines(3);
  readonly links: THREE.LineSegments<THREE.BufferGeometry, THREE.LineBasicMaterial>;
  readonly keyframes: THREE.Points<THREE.BufferGeometry, THREE.ShaderMaterial>;
  private readonly heading = new WideLines(4);
  private selected: number | null = null;
  private pathColor = "#ffffff";

  constructor(private readonly run: Run) {
    this.path.setSegments(this.segmentFrames().flatMap((frame) => positionOf(run, frame)));
    this.loops.setSegments(
      run.loops.flatMap(([a, b]) => [...positionOf(run, a), ...positionOf(run, b)]),
    );
    this.links = this.makeLinks();
    this.keyframes = this.makeMarks();
    this.heading.drawOnTop();
    this.group.add(
      this.links,
      this.path.object,
      this.loops.object,
      this.keyframes,
      this.heading.object,
    );
  }

  /** Position of a keyframe by its place among the keyframes. */
  positionOf(keyframe: number): THREE.Vector3 {
    return new THREE.Vector3(...positionOf(this.run, this.run.keyframes[keyframe]));
  }

  /** The keyframe's optical axis in the world. */
  forwardOf(keyframe: number): THREE.Vector3 {
    const orientation = orientationOf(this.run, this.run.keyframes[keyframe]);
    return new THREE.Vector3(0, 0, 1).applyQuaternion(new THREE.Quaternion(...orientation));
  }

  select(keyframe: number | null, headingLength: number): void {
    const marks = this.keyframes.geometry.getAttribute("isSelected") as THREE.BufferAttribute;
    if (this.selected !== null) marks.setX(this.selected, 0);
    if (keyframe !== null) marks.setX(keyframe, 1);
    marks.needsUpdate = true;
    this.selected = keyframe;
    this.showHeading(keyframe === null ? null : this.forwardOf(keyframe), headingLength);
  }

  /** Shows where the panorama of the selected keyframe looks. */
  showHeading(direction: THREE.Vector3 | null, length: number): void {
    if (this.selected === null || direction === null) {
      this.heading.setSegments([]);
      return;
    }
    const from = this.positionOf(this.selected);
    const to = from.clone().addScaledVector(direction, length);
    this.heading.setSegments([...from.toArray(), ...to.toArray()]);
  }

  /**
   * Colours the path by frame, red, green and blue in 0..255; false: in one colour. Where the
   * function gives null, and at steps without a colour at either end, it has that one as well.
   */
  colorPath(colorOf: false | ((frame: number) => [number, number, number] | null)): void {
    this.path.setWidth(colorOf ? COLORED_PATH_PIXELS : PATH_PIXELS);
    if (!colorOf) {
      this.path.setColors(null);
      return;
    }
    const plain = new THREE.Color(this.pathColor).multiplyScalar(255).toArray();
    this.path.setColors(
      this.segmentFrames().flatMap((frame) => (colorOf(frame) ?? plain).map((c) => c / 255)),
    );
  }

  setColors(colors: CanvasColors): void {
    this.pathColor = colors.path;
    this.path.setColor(colors.path);
    this.loops.setColor(colors.loop);
    this.links.material.color.set(colors.link);
    this.heading.setColor(colors.selected);
    const uniforms = this.keyframes.material.uniforms;
    uniforms.color.value.set(colors.keyframe);
    uniforms.selectedColor.value.set(colors.selected);
    uniforms.edge.value.set(colors.background);
  }

  resize(width: number, height: number): void {
    for (const lines of [this.path, this.loops, this.heading]) lines.resize(width, height);
  }

  /** The frames at both ends of each step. Those from one map to the next are assumed. */
  private segmentFrames(): number[] {
    const { index, map } = this.run.frames;
    const frames: number[] = [];
    for (let i = 1; i < index.length; ++i) {
      if (map[i] === map[i - 1]) frames.push(i - 1, i);
    }
    return frames;
  }

  private makeLinks(): THREE.LineSegments<THREE.BufferGeometry, THREE.LineBasicMaterial> {
    const coordinates: number[] = [];
    for (let i = 0; i + 2 < this.run.links.length; i += 3) {
      for (const keyframe of [this.run.links[i], this.run.links[i + 1]]) {
        coordinates.push(...positionOf(this.run, this.run.keyframes[keyframe]));
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(coordinates, 3));
    const material = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.55 });
    const links = new THREE.LineSegments(geometry, material);
    links.frustumCulled = false;
    return links;
  }

  private makeMarks(): THREE.Points<THREE.BufferGeometry, THREE.ShaderMaterial> {
    const { keyframes } = this.run;
    const geometry = new THREE.BufferGeometry();
    const coordinates = keyframes.flatMap((frame) => positionOf(this.run, frame));
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(coordinates, 3));
    geometry.setAttribute(
      "isSelected",
      new THREE.Float32BufferAttribute(new Float32Array(keyframes.length), 1),
    );
    const material = new THREE.ShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: MARK_VERTEX,
      fragmentShader: MARK_FRAGMENT,
      uniforms: {
        size: { value: MARK_PIXELS * Math.min(devicePixelRatio, 2) },
        color: { value: new THREE.Color() },
        selectedColor: { value: new THREE.Color() },
        edge: { value: new THREE.Color() },
      },
    });
    const marks = new THREE.Points(geometry, material);
    marks.frustumCulled = false;
    marks.renderOrder = 5;
    return marks;
  }
}
