#include "slam/io/range_store.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "nn/base/check.h"
#include "slam/io/output_file.h"

namespace orb360 {
namespace {

constexpr double kStepsPerUnit = 1024.0;  // of the natural logarithm
constexpr int kCodeOfOne = 32 * 1024;     // The middle: any unit of length has room.
constexpr int kMaxCode = 65535;
constexpr int kColorQuality = 95;  // of JPEG

/// Lengths of the three encoded images that follow.
using Header = std::array<std::uint32_t, 3>;

/// Code of a range; 0 for none.
std::uint16_t Encode(float range) {
  const double code = std::round(std::log(static_cast<double>(range)) * kStepsPerUnit) + kCodeOfOne;
  return static_cast<std::uint16_t>(std::clamp(code, 1.0, static_cast<double>(kMaxCode)));
}

const std::vector<float>& RangeOfCode() {
  static const std::vector<float> table = [] {
    std::vector<float> ranges(kMaxCode + 1, 0.0f);
    for (int code = 1; code <= kMaxCode; ++code) {
      ranges[static_cast<size_t>(code)] =
          static_cast<float>(std::exp((code - kCodeOfOne) / kStepsPerUnit));
    }
    return ranges;
  }();
  return table;
}

bool IsPositive(float value) { return value > 0.0f && std::isfinite(value); }

/// 1/255 is the least confidence of a pixel with a range.
std::uint8_t EncodeConfidence(float confidence) {
  return static_cast<std::uint8_t>(std::clamp(std::round(confidence * 255.0f), 1.0f, 255.0f));
}

cv::Mat Decode(std::string_view data, int type) {
  const cv::Mat bytes(1, static_cast<int>(data.size()), CV_8UC1, const_cast<char*>(data.data()));
  cv::Mat image;
  try {
    if (!data.empty()) image = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    image.release();
  }
  return image.type() == type ? image : cv::Mat();
}

}  // namespace

RangeStore::RangeStore(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  std::filesystem::remove_all(folder_, error);
  if (!error) std::filesystem::create_directories(folder_, error);
  if (error) ThrowWriteError(folder_, error.value());
}

RangeStore::~RangeStore() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::filesystem::path RangeStore::PathOf(int frame_index) const {
  return folder_ / std::to_string(frame_index);
}

void RangeStore::Put(int frame_index, const DenseDepth& depth) const {
  const cv::Size size = depth.range.size();
  ORB360_CHECK(depth.range.type() == CV_32FC1 && depth.confidence.type() == CV_32FC1 &&
                   depth.color.type() == CV_8UC3,
               depth.range.type(), depth.confidence.type(), depth.color.type());
  ORB360_CHECK(!size.empty() && depth.confidence.size() == size && depth.color.size() == size, size,
               depth.confidence.size(), depth.color.size());
  cv::Mat codes(size, CV_16UC1);
  cv::Mat confidences(size, CV_8UC1);
  for (int row = 0; row < size.height; ++row) {
    const float* range = depth.range.ptr<float>(row);
    const float* confidence = depth.confidence.ptr<float>(row);
    std::uint16_t* code = codes.ptr<std::uint16_t>(row);
    std::uint8_t* level = confidences.ptr<std::uint8_t>(row);
    for (int column = 0; column < size.width; ++column) {
      const bool is_known = IsPositive(range[column]) && IsPositive(confidence[column]);
      code[column] = is_known ? Encode(range[column]) : std::uint16_t{0};
      level[column] = is_known ? EncodeConfidence(confidence[column]) : std::uint8_t{0};
    }
  }
  std::array<std::vector<unsigned char>, 3> images;
  cv::imencode(".png", codes, images[0]);
  cv::imencode(".png", confidences, images[1]);
  cv::imencode(".jpg", depth.color, images[2], {cv::IMWRITE_JPEG_QUALITY, kColorQuality});
  Header header{};
  for (size_t i = 0; i < images.size(); ++i) {
    header[i] = static_cast<std::uint32_t>(images[i].size());
  }
  // Nobody needs these files after a crash: no waiting for the disk.
  OutputFile file(PathOf(frame_index));
  file.Write({reinterpret_cast<const char*>(header.data()), sizeof header});
  for (const std::vector<unsigned char>& image : images) {
    file.Write({reinterpret_cast<const char*>(image.data()), image.size()});
  }
}

bool RangeStore::Contains(int frame_index) const {
  return std::filesystem::exists(PathOf(frame_index));
}

DenseDepth RangeStore::Get(int frame_index) const {
  const std::filesystem::path path = PathOf(frame_index);
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const auto damaged = [&path] {
    return UserError(path.string() +
                     ": is damaged or gone; keep the folder as it is until the run has ended");
  };
  Header header{};
  if (bytes.size() < sizeof header) throw damaged();
  std::memcpy(header.data(), bytes.data(), sizeof header);
  std::string_view rest = std::string_view(bytes).substr(sizeof header);
  if (std::uint64_t{header[0]} + header[1] + header[2] != rest.size()) throw damaged();
  const auto next = [&rest, &header](size_t i, int type) {
    const cv::Mat image = Decode(rest.substr(0, header[i]), type);
    rest.remove_prefix(header[i]);
    return image;
  };
  const cv::Mat codes = next(0, CV_16UC1);
  const cv::Mat confidences = next(1, CV_8UC1);
  DenseDepth depth;
  depth.color = next(2, CV_8UC3);
  if (codes.empty() || confidences.size() != codes.size() || depth.color.size() != codes.size()) {
    throw damaged();
  }
  depth.range.create(codes.size(), CV_32FC1);
  const std::vector<float>& ranges = RangeOfCode();
  for (int row = 0; row < codes.rows; ++row) {
    const std::uint16_t* code = codes.ptr<std::uint16_t>(row);
    std::transform(code, code + codes.cols, depth.range.ptr<float>(row),
                   [&ranges](std::uint16_t c) { return ranges[c]; });
  }
  confidences.convertTo(depth.confidence, CV_32F, 1.0 / 255.0);
  return depth;
}

}  // namespace orb360
