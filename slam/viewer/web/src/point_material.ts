import * as THREE from "three";

/** By what points are coloured; the shader has the same numbers. */
export enum ColorBy {
  Image = 0,
  Height = 1,
  Confidence = 2,
  Error = 3,
}

/** Width of the texture that tells which nodes are shown. */
export const VISIBLE_WIDTH = 2048;

/** Levels below the root that the shader goes through: no octree has more. */
const MAX_LEVELS = 16;

const VERTEX = `
precision highp float;
precision highp usampler2D;
in uvec4 steps;      // position in the node, normal
in vec4 tint;        // red, green, blue, confidence
uniform mat4 modelMatrix, viewMatrix, projectionMatrix;
uniform vec3 rootMin;
uniform mat4 cloudFromWorld;
uniform vec4 overlay;  // a colour, and how much of it is mixed in
uniform float rootSide, rootSpacing, pixelsPerRadian, pointScale, minSize, maxSize, ground, voxel;
uniform float leafSpacing, leastConfidence;
uniform usampler2D visibleNodes;  // masks of shown and of hidden children, place of the first shown
uniform int colorBy;
uniform vec2 colorRange;
uniform sampler2D colorMap;
uniform bool isClipped;
uniform vec3 clipMin, clipMax;
out vec3 color;

// Distance between the points that are shown around a position: that of the finest node there. Where
// nothing finer is hidden, points stand for themselves and are not enlarged to close gaps.
float spacingAt(vec3 p) {
  vec3 at = clamp((p - rootMin) / rootSide, 0.0, 0.999999);
  int node = 0;
  float spacing = rootSpacing;
  for (int level = 0; level < ${MAX_LEVELS}; ++level) {
    uvec2 entry = texelFetch(visibleNodes,
        ivec2(node % ${VISIBLE_WIDTH}, node / ${VISIBLE_WIDTH}), 0).xy;
    at *= 2.0;
    uvec3 half_ = uvec3(at);
    at -= vec3(half_);
    uint octant = half_.x * 4u + half_.y * 2u + half_.z;
    if ((entry.x >> octant & 1u) == 0u) {
      return (entry.x >> (8u + octant) & 1u) == 0u ? min(spacing, leafSpacing) : spacing;
    }
    uint before = entry.x & ((1u << octant) - 1u);
    uint count = 0u;
    for (uint bit = 0u; bit < 8u; ++bit) count += before >> bit & 1u;
    node = int(entry.y + count);
    spacing *= 0.5;
  }
  return spacing;
}

void main() {
  vec4 world = modelMatrix * vec4(vec3(steps.xyz) + 0.5, 1.0);
  bool isOutside = any(lessThan(world.xyz, clipMin)) || any(greaterThan(world.xyz, clipMax));
  if ((isClipped && isOutside) || tint.a < leastConfidence) {
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    gl_PointSize = 0.0;
    return;
  }
  vec4 inView = viewMatrix * world;
  gl_Position = projectionMatrix * inView;
  float size = spacingAt((cloudFromWorld * world).xyz) * pointScale * pixelsPerRadian / max(-inView.z, 1e-6);
  gl_PointSize = clamp(size, minSize, maxSize);
  color = tint.rgb;
  if (colorBy != ${ColorBy.Image}) {
    float value = world.z - ground;
    if (colorBy == ${ColorBy.Confidence}) value = tint.a;
    if (colorBy == ${ColorBy.Error}) value = voxel * (1.0 / max(tint.a, 1.0 / 255.0) - 1.0);
    float place = (value - colorRange.x) / max(colorRange.y - colorRange.x, 1e-9);
    color = texture(colorMap, vec2(clamp(place, 0.002, 0.998), 0.5)).rgb;
  }
  color = mix(color, overlay.rgb, overlay.a);
}
`;

const FRAGMENT = `
precision highp float;
in vec3 color;
out vec4 pixel;
void main() {
  vec2 p = 2.0 * gl_PointCoord - 1.0;
  if (dot(p, p) > 1.0) discard;
  pixel = vec4(color, 1.0);
}
`;

export type PointMaterial = THREE.RawShaderMaterial;

export function makePointMaterial(): PointMaterial {
  return new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3,
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    uniforms: {
      rootMin: { value: new THREE.Vector3() },
      cloudFromWorld: { value: new THREE.Matrix4() },
      overlay: { value: new THREE.Vector4(0, 0, 0, 0) },
      rootSide: { value: 1 },
      rootSpacing: { value: 1 },
      pixelsPerRadian: { value: 1 },
      pointScale: { value: 1.35 },
      minSize: { value: 1.5 },
      maxSize: { value: 16 * Math.min(devicePixelRatio, 2) },
      leafSpacing: { value: 1e9 },
      leastConfidence: { value: 0 },
      ground: { value: 0 },
      voxel: { value: 0 },
      visibleNodes: { value: null },
      colorBy: { value: ColorBy.Image },
      colorRange: { value: new THREE.Vector2(0, 1) },
      colorMap: { value: null },
      isClipped: { value: false },
      clipMin: { value: new THREE.Vector3() },
      clipMax: { value: new THREE.Vector3() },
    },
  });
}

/** The texture that tells the shader which nodes are shown, in breadth-first order. */
export function makeVisibleTexture(rows: number): THREE.DataTexture {
  const texture = new THREE.DataTexture(
    new Uint32Array(2 * VISIBLE_WIDTH * rows),
    VISIBLE_WIDTH,
    rows,
    THREE.RGIntegerFormat,
    THREE.UnsignedIntType,
  );
  texture.internalFormat = "RG32UI";
  return texture;
}
