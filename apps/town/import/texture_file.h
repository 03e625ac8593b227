#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

#include "apps/town/image/texture.h"

namespace orb360::town {

/// What the fourth channel of an image means.
enum class Alpha { kCoverage, kIgnored };

/// A texture made from an image.
struct ImageTexture {
  Texture texture;
  bool has_holes;  ///< the coverage is below one half somewhere
};

/// Converts an 8 or 16-bit image as OpenCV reads it (gray, BGR or BGRA in sRGB, first row at the
/// top). Sides become powers of two, at most 4096. Pixels in a hole take the colour of their
/// surroundings, so that no fringe of the hidden colour appears. Throws UserError, whose message
/// begins with `name`, for other kinds of image.
ImageTexture MakeTexture(const cv::Mat& image, const std::string& name,
                         Alpha alpha = Alpha::kCoverage);

/// Reads PNG, JPEG, SGI (.rgb, .rgba, .sgi, .bw), TGA or another format that OpenCV knows. Throws
/// UserError.
ImageTexture ReadTexture(const std::filesystem::path& path, Alpha alpha = Alpha::kCoverage);

/// Returns ".png" for "A/B.PNG".
std::string LowerExtension(const std::filesystem::path& path);

}  // namespace orb360::town
