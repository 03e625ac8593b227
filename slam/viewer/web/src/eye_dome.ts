import * as THREE from "three";
import { FullScreenQuad } from "three/addons/postprocessing/Pass.js";

const VERTEX = `
out vec2 at;
void main() {
  at = uv;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}
`;

// Eye-dome lighting (Boucheny, 2009): what lies behind its neighbours on the screen is darker, by the
// difference of the logarithms of the distances.
const FRAGMENT = `
uniform sampler2D colors, depths;
uniform vec2 pixel;
uniform float near, far, strength;
uniform vec3 background;
in vec2 at;
float logDistance(float depth) {
  return log2(near * far / (far - depth * (far - near)));
}
void main() {
  float depth = texture(depths, at).r;
  if (depth >= 1.0) {
    gl_FragColor = vec4(background, 1.0);
    gl_FragDepth = 1.0;
    return;
  }
  float here = logDistance(depth);
  float sum = 0.0;
  for (int i = 0; i < 8; ++i) {
    float angle = float(i) * 0.785398;
    float other = texture(depths, at + 1.4 * pixel * vec2(cos(angle), sin(angle))).r;
    // Nothing behind is far away, but not so far that an edge against the sky becomes black.
    sum += other >= 1.0 ? 0.0 : max(0.0, here - logDistance(other));
  }
  float shade = exp(-strength * 14.0 * sum / 8.0);
  gl_FragColor = vec4(texture(colors, at).rgb * mix(1.0, max(shade, 0.25), step(1e-6, strength)), 1.0);
  gl_FragDepth = depth;
}
`;

/** Draws points into a texture and that with eye-dome lighting to the screen, with its depth. */
export class EyeDome {
  strength = 0.7;
  private readonly target = new THREE.WebGLRenderTarget(1, 1, {
    minFilter: THREE.NearestFilter,
    magFilter: THREE.NearestFilter,
    depthTexture: new THREE.DepthTexture(1, 1, THREE.UnsignedIntType),
  });
  private readonly quad = new FullScreenQuad(
    new THREE.ShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT.replaceAll("gl_FragColor", "shown").replace(
        "void main",
        "out vec4 shown;\nvoid main",
      ),
      uniforms: {
        colors: { value: this.target.texture },
        depths: { value: this.target.depthTexture },
        pixel: { value: new THREE.Vector2() },
        near: { value: 1 },
        far: { value: 2 },
        strength: { value: 1 },
        background: { value: new THREE.Color() },
      },
      depthTest: true,
      depthFunc: THREE.AlwaysDepth,
      depthWrite: true,
      toneMapped: false,
    }),
  );

  resize(width: number, height: number): void {
    this.target.setSize(width, height);
  }

  render(
    renderer: THREE.WebGLRenderer,
    scene: THREE.Scene,
    camera: THREE.PerspectiveCamera,
    background: THREE.Color,
  ): void {
    renderer.setRenderTarget(this.target);
    renderer.setClearColor(0x000000, 1);
    renderer.clear();
    renderer.render(scene, camera);
    renderer.setRenderTarget(null);
    const uniforms = (this.quad.material as THREE.ShaderMaterial).uniforms;
    uniforms.pixel.value.set(1 / this.target.width, 1 / this.target.height);
    uniforms.near.value = camera.near;
    uniforms.far.value = camera.far;
    uniforms.strength.value = this.strength;
    uniforms.background.value.copy(background);
    renderer.clear();
    this.quad.render(renderer);
  }
}
