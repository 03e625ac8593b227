#version 450
#extension GL_GOOGLE_include_directive : require
// Takes x and c from the pixel of each 2 x 2 square with the largest c, the first one in row-major
// order among equals, and applies the rule to c.
#include "common.glsl"
#include "math.glsl"

layout(constant_id = 2) const int IS_QUARTER = 1;  // c / 4, otherwise sqrt(c)

layout(push_constant) uniform Parameters {
  View x;
  View c;
  View y;
  View y_confidence;
  int height;  // of y
  int width;
};

// The root of a negative number is undefined in shaders, and NaN on the CPU.
float Root(float x) { return x < 0.0 ? Nan() : sqrt(x); }

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.y >= height || at.x >= width) return;
  float value = arena[At(x, at.z, 2 * at.y, 2 * at.x)];
  float best = arena[At(c, at.z, 2 * at.y, 2 * at.x)];
  for (int k = 1; k < 4; ++k) {
    int v = 2 * at.y + k / 2;
    int u = 2 * at.x + k % 2;
    float confidence = arena[At(c, at.z, v, u)];
    if (confidence > best) {
      best = confidence;
      value = arena[At(x, at.z, v, u)];
    }
  }
  arena[At(y, at.z, at.y, at.x)] = value;
  arena[At(y_confidence, at.z, at.y, at.x)] = IS_QUARTER != 0 ? 0.25 * best : Root(best);
}
