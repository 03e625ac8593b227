// Values around an image (orb360::nn::Padding).
layout(constant_id = 2) const int PADDING = 0;  // 0 zero, 1 wrap_replicate, 2 wrap_cross_pole

// Returns row and column of the pixel that stands at (y, x), which may lie beyond the edge; row -1
// stands for zero.
ivec2 Source(int y, int x, int height, int width) {
  if (PADDING == 0) {
    bool is_inside = y >= 0 && y < height && x >= 0 && x < width;
    return is_inside ? ivec2(y, x) : ivec2(-1, 0);
  }
  if (PADDING == 1) {
    y = clamp(y, 0, height - 1);
  } else {
    while (y < 0 || y >= height) {
      y = y < 0 ? -1 - y : 2 * height - 1 - y;
      x += width / 2;
    }
  }
  // The remainder of a negative number is undefined. The largest kernel, 15, reaches 7 pixels.
  return ivec2(y, (x + 8 * width) % width);
}
