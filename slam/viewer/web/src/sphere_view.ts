import * as THREE from "three";
import { FullScreenQuad } from "three/addons/postprocessing/Pass.js";
import { colorTable } from "./color_maps";

export type Overlay = "image" | "range" | "confidence";

const VERTEX = `
out vec2 at;
void main() {
  at = 2.0 * uv - 1.0;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}
`;

const FRAGMENT = `
uniform sampler2D image, depth, rangeMap, confidenceMap;
uniform mat3 cameraFromView;
uniform vec2 tangents;
uniform int overlay;
in vec2 at;
out vec4 pixel;
const float PI = 3.14159265358979;
void main() {
  vec3 ray = cameraFromView * normalize(vec3(at * tangents, -1.0));
  // Optical camera frame: x right, y down, z forward, which is the middle of the image.
  vec2 place = vec2(0.5 + atan(ray.x, ray.z) / (2.0 * PI), 0.5 + asin(clamp(ray.y, -1.0, 1.0)) / PI);
  vec3 shown = textureLod(image, place, 0.0).rgb;
  if (overlay > 0) {
    vec2 known = textureLod(depth, place, 0.0).rg;
    float gray = dot(shown, vec3(0.299, 0.587, 0.114));
    if (known.r < 0.5 / 255.0) shown = vec3(0.35 * gray);
    else if (overlay == 1) {
      float near = (known.r * 255.0 - 1.0) / 254.0;
      shown = mix(texture(rangeMap, vec2(1.0 - near, 0.5)).rgb, vec3(gray), 0.18);
    } else shown = mix(texture(confidenceMap, vec2(known.g, 0.5)).rgb, vec3(gray), 0.18);
  }
  pixel = vec4(shown, 1.0);
}
`;

function mapTexture(table: Uint8Array): THREE.DataTexture {
  const texture = new THREE.DataTexture(table, 256, 1, THREE.RGBAFormat);
  texture.minFilter = texture.magFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

/** Draws an equirectangular image as a camera of any direction in its middle would see it. */
export class SphereView {
  /** Degrees: 0 looks along the middle of the image, positive to the right; up is positive. */
  yaw = 0;
  pitch = 0;
  /** Vertical, degrees. */
  fieldOfView = 75;
  overlay: Overlay = "image";
  private readonly renderer: THREE.WebGLRenderer;
  private readonly quad: FullScreenQuad;
  private readonly material: THREE.ShaderMaterial;
  private isQueued = false;

  constructor(readonly canvas: HTMLCanvasElement) {
    this.renderer = new THREE.WebGLRenderer({ canvas });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    this.material = new THREE.ShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: {
        image: { value: null },
        depth: { value: null },
        rangeMap: { value: mapTexture(colorTable("viridis")) },
        confidenceMap: { value: mapTexture(colorTable("cividis")) },
        cameraFromView: { value: new THREE.Matrix3() },
        tangents: { value: new THREE.Vector2() },
        overlay: { value: 0 },
      },
    });
    this.quad = new FullScreenQuad(this.material);
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement!);
  }

  setImage(image: HTMLImageElement): void {
    this.material.uniforms.image.value?.dispose();
    const texture = new THREE.Texture(image);
    texture.flipY = false;
    texture.wrapS = THREE.RepeatWrapping;
    texture.generateMipmaps = false;
    texture.minFilter = THREE.LinearFilter;
    texture.needsUpdate = true;
    this.material.uniforms.image.value = texture;
    this.invalidate();
  }

  setDepth(texels: Uint8Array, width: number, height: number): void {
    this.material.uniforms.depth.value?.dispose();
    const texture = new THREE.DataTexture(texels, width, height, THREE.RGFormat);
    texture.unpackAlignment = 1;
    texture.needsUpdate = true;
    this.material.uniforms.depth.value = texture;
    this.invalidate();
  }

  /** Turns by a movement of the pointer in CSS pixels. */
  drag(right: number, down: number): void {
    const perPixel = this.fieldOfView / Math.max(1, this.canvas.clientHeight);
    this.yaw -= right * perPixel;
    this.pitch = Math.min(Math.max(this.pitch + down * perPixel, -90), 90);
    this.invalidate();
  }

  zoom(factor: number): void {
    this.fieldOfView = Math.min(Math.max(this.fieldOfView * factor, 15), 110);
    this.invalidate();
  }

  /** Direction in the optical camera frame at a place on the canvas, CSS pixels. */
  directionAt(x: number, y: number): THREE.Vector3 {
    const { clientWidth, clientHeight } = this.canvas;
    const tangents = this.tangents();
    return new THREE.Vector3(
      ((2 * x) / clientWidth - 1) * tangents.x,
      (1 - (2 * y) / clientHeight) * tangents.y,
      -1,
    )
      .normalize()
      .applyMatrix3(this.cameraFromView());
  }

  /** Direction in the middle of the canvas. */
  forward(): THREE.Vector3 {
    return new THREE.Vector3(0, 0, -1).applyMatrix3(this.cameraFromView());
  }

  invalidate(): void {
    if (this.isQueued) return;
    this.isQueued = true;
    requestAnimationFrame(() => {
      this.isQueued = false;
      this.draw();
    });
  }

  private tangents(): THREE.Vector2 {
    const y = Math.tan((this.fieldOfView * Math.PI) / 360);
    return new THREE.Vector2(
      (y * this.canvas.clientWidth) / Math.max(1, this.canvas.clientHeight),
      y,
    );
  }

  /** From the view (x right, y up, z backwards) to the optical camera frame. */
  private cameraFromView(): THREE.Matrix3 {
    const axes = new THREE.Matrix4().makeRotationX(Math.PI);
    const turn = new THREE.Matrix4().makeRotationY((this.yaw * Math.PI) / 180);
    const tilt = new THREE.Matrix4().makeRotationX((this.pitch * Math.PI) / 180);
    return new THREE.Matrix3().setFromMatrix4(turn.multiply(tilt).multiply(axes));
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas.parentElement!;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.draw();
  }

  private draw(): void {
    const uniforms = this.material.uniforms;
    if (!uniforms.image.value || this.canvas.clientHeight === 0) return;
    uniforms.cameraFromView.value.copy(this.cameraFromView());
    uniforms.tangents.value.copy(this.tangents());
    uniforms.overlay.value = ["image", "range", "confidence"].indexOf(this.overlay);
    this.quad.render(this.renderer);
  }
}
