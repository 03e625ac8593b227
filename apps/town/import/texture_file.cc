#include "apps/town/import/texture_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/town/import/lower_case.h"
#include "apps/town/import/sgi_image.h"
#include "apps/town/import/tga_image.h"
#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

constexpr int kLargestSide = 4096;

int TextureSide(int side) {
  return std::min(static_cast<int>(std::bit_ceil(static_cast<unsigned>(side))), kLargestSide);
}

cv::Mat4b ToBgra(cv::Mat image, const std::string& name, Alpha alpha) {
  if (image.depth() == CV_16U) image.convertTo(image, CV_8U, 1.0 / 257);
  cv::Mat4b result;
  if (image.depth() == CV_8U) {
    if (image.channels() == 4 && alpha == Alpha::kIgnored)
      cv::cvtColor(image, image, cv::COLOR_BGRA2BGR);
    if (image.channels() == 1) cv::cvtColor(image, result, cv::COLOR_GRAY2BGRA);
    if (image.channels() == 3) cv::cvtColor(image, result, cv::COLOR_BGR2BGRA);
    if (image.channels() == 4) result = image;
  }
  if (result.empty()) throw UserError(name + ": is of a kind of image that is not read");
  return result;
}

/// Returns linear red, green and blue, and coverage.
cv::Mat4f ToLinear(const cv::Mat4b& bgra) {
  std::array<float, 256> linear;
  for (int i = 0; i < 256; ++i) linear[static_cast<size_t>(i)] = Srgb(i, i, i).r;
  cv::Mat4f result(bgra.size());
  for (int y = 0; y < bgra.rows; ++y) {
    for (int x = 0; x < bgra.cols; ++x) {
      const cv::Vec4b& p = bgra(y, x);
      result(y, x) = {linear[p[2]], linear[p[1]], linear[p[0]], static_cast<float>(p[3]) / 255};
    }
  }
  return result;
}

/// Gives uncovered pixels the mean colour of the covered ones around them, or of the whole image.
void FillHoles(cv::Mat4f* image) {
  cv::Mat4f weighted(image->size());
  for (int y = 0; y < image->rows; ++y) {
    for (int x = 0; x < image->cols; ++x) {
      const cv::Vec4f& p = (*image)(y, x);
      weighted(y, x) = {p[0] * p[3], p[1] * p[3], p[2] * p[3], p[3]};
    }
  }
  const cv::Scalar sum = cv::sum(weighted);
  cv::Mat4f around;
  cv::boxFilter(weighted, around, -1, {3, 3});
  for (int y = 0; y < image->rows; ++y) {
    for (int x = 0; x < image->cols; ++x) {
      cv::Vec4f& p = (*image)(y, x);
      if (p[3] >= 0.5F) continue;
      const cv::Vec4f near = around(y, x);
      constexpr float kLeast = 0.05F;  // half an opaque neighbour
      for (int k = 0; k < 3; ++k) {
        if (near[3] > kLeast) {
          p[k] = near[k] / near[3];
        } else if (sum[3] > 0) {
          p[k] = static_cast<float>(sum[k] / sum[3]);
        }
      }
    }
  }
}

}  // namespace

std::string LowerExtension(const std::filesystem::path& path) {
  return LowerCase(path.extension().string());
}

ImageTexture MakeTexture(const cv::Mat& image, const std::string& name, Alpha alpha) {
  cv::Mat4f texels = ToLinear(ToBgra(image, name, alpha));
  const bool has_holes = std::any_of(texels.begin(), texels.end(),
                                     [](const cv::Vec4f& texel) { return texel[3] < 0.5F; });
  if (has_holes) FillHoles(&texels);
  const cv::Size size(TextureSide(texels.cols), TextureSide(texels.rows));
  if (size != texels.size()) {
    const bool shrinks = size.area() < texels.size().area();
    cv::resize(texels, texels, size, 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
  }
  std::vector<Rgba> rows;
  rows.reserve(texels.total());
  for (int row = texels.rows - 1; row >= 0; --row) {
    for (int column = 0; column < texels.cols; ++column) {
      const cv::Vec4f& texel = texels(row, column);
      rows.push_back({texel[0], texel[1], texel[2], texel[3]});
    }
  }
  return {Texture(size.width, size.height, std::move(rows)), has_holes};
}

ImageTexture ReadTexture(const std::filesystem::path& path, Alpha alpha) {
  const std::string extension = LowerExtension(path);
  for (const char* sgi : {".rgb", ".rgba", ".sgi", ".bw"}) {
    if (extension == sgi) return MakeTexture(ReadSgiImage(path), path.string(), alpha);
  }
  if (extension == ".tga") return MakeTexture(ReadTgaImage(path), path.string(), alpha);
  cv::Mat image;
  try {
    image = cv::imread(path.string(), cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {  // larger than OpenCV allows
  }
  if (image.empty()) throw UserError(path.string() + ": cannot be read as an image");
  return MakeTexture(image, path.string(), alpha);
}

}  // namespace orb360::town
