#version 450
#extension GL_GOOGLE_include_directive : require
// The sine of the latitude of each row, from a table, because Vulkan's sine has 11 bits only.
#include "common.glsl"

layout(push_constant) uniform Parameters {
  View y;
  int height;
  int width;
  uint table;  // [row]
};

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.y >= height || at.x >= width) return;
  arena[At(y, 0, at.y, at.x)] = constants[table + uint(at.y)];
}
