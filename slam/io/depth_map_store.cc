#include "slam/io/depth_map_store.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <zstd.h>

#include "slam/io/output_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr double kStepsPerUnit = 1024.0;  // of the natural logarithm
constexpr int kCodeOfOne = 32 * 1024;     // The middle: any unit of length has room.
constexpr int kMaxCode = 65535;
constexpr int kColorQuality = 95;  // of JPEG
constexpr int kZstdLevel = 1;      // the fastest
constexpr size_t kPlanes = 4;      // of one byte: low and high one of ranges, confidence, source

struct Header {
  std::uint32_t width;
  std::uint32_t height;
  std::uint32_t packed_bytes;  // of what Pack makes; the colours as JPEG follow
  std::uint32_t color_bytes;
};

struct CodedDepth {
  cv::Mat ranges;       // CV_16UC1: codes, 0 for none
  cv::Mat confidences;  // CV_8UC1: in 1/255; those of ranges are not 0
  cv::Mat sources;      // CV_8UC1: of RangeSource
};

cv::Mat IsPositive(const cv::Mat& values) {
  return (values > 0.0f) & (values <= std::numeric_limits<float>::max());
}

CodedDepth Encode(const cv::Mat& range, const cv::Mat& confidence, const cv::Mat& source) {
  const cv::Mat known = IsPositive(range) & IsPositive(confidence);
  const cv::Mat unknown = ~known;
  CodedDepth coded;
  cv::Mat logarithms(range.size(), CV_32FC1, 1.0f);
  range.copyTo(logarithms, known);
  cv::log(logarithms, logarithms);
  logarithms.convertTo(coded.ranges, CV_16U, kStepsPerUnit, kCodeOfOne);
  coded.ranges = cv::max(coded.ranges, 1);
  coded.ranges.setTo(0, unknown);
  confidence.convertTo(coded.confidences, CV_8U, 255.0);
  coded.confidences = cv::max(coded.confidences, 1);
  coded.confidences.setTo(0, unknown);
  coded.sources = source.empty() ? cv::Mat::zeros(range.size(), CV_8U) : source.clone();
  coded.sources.setTo(0, unknown);
  return coded;
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

/// Stores the differences between neighbours in a row, most of which are small. The sign is moved
/// to the lowest bit, so that the upper bytes are similar and compress well in a plane of their
/// own.
std::string Pack(const CodedDepth& coded) {
  const size_t pixels = coded.ranges.total();
  std::string planes(kPlanes * pixels, '\0');
  char* low = planes.data();
  char* high = low + pixels;
  char* level = high + pixels;
  char* known_by = level + pixels;
  for (int row = 0; row < coded.ranges.rows; ++row) {
    const std::uint16_t* code = coded.ranges.ptr<std::uint16_t>(row);
    const std::uint8_t* confidence = coded.confidences.ptr<std::uint8_t>(row);
    const std::uint8_t* source = coded.sources.ptr<std::uint8_t>(row);
    known_by = std::copy_n(source, coded.sources.cols, known_by);
    std::uint16_t left = 0;
    std::uint8_t left_confidence = 0;
    for (int column = 0; column < coded.ranges.cols; ++column) {
      const auto difference = static_cast<std::int16_t>(code[column] - left);
      const auto folded = static_cast<std::uint16_t>((difference << 1) ^ (difference >> 15));
      *low++ = static_cast<char>(folded & 0xff);
      *high++ = static_cast<char>(folded >> 8);
      *level++ = static_cast<char>(confidence[column] - left_confidence);
      left = code[column];
      left_confidence = confidence[column];
    }
  }
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(),
                                                                     &ZSTD_freeCCtx);
  ORB360_CHECK(context != nullptr);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kZstdLevel);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  std::string packed(ZSTD_compressBound(planes.size()), '\0');
  const size_t bytes =
      ZSTD_compress2(context.get(), packed.data(), packed.size(), planes.data(), planes.size());
  ORB360_CHECK(!ZSTD_isError(bytes), ZSTD_getErrorName(bytes));
  packed.resize(bytes);
  return packed;
}

/// Inverts Pack. Returns images without pixels if the data are damaged.
CodedDepth Unpack(std::string_view packed, int width, int height) {
  const size_t pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  std::string planes(kPlanes * pixels, '\0');
  if (ZSTD_decompress(planes.data(), planes.size(), packed.data(), packed.size()) !=
      planes.size()) {
    return {};
  }
  const char* low = planes.data();
  const char* high = low + pixels;
  const char* level = high + pixels;
  const char* known_by = level + pixels;
  CodedDepth coded{cv::Mat(height, width, CV_16UC1), cv::Mat(height, width, CV_8UC1),
                   cv::Mat(height, width, CV_8UC1)};
  std::copy_n(known_by, pixels, coded.sources.ptr<char>());
  for (int row = 0; row < height; ++row) {
    std::uint16_t* code = coded.ranges.ptr<std::uint16_t>(row);
    std::uint8_t* confidence = coded.confidences.ptr<std::uint8_t>(row);
    std::uint16_t left = 0;
    std::uint8_t left_confidence = 0;
    for (int column = 0; column < width; ++column) {
      const int folded = static_cast<std::uint8_t>(*low++) | static_cast<std::uint8_t>(*high++)
                                                                 << 8;
      left = static_cast<std::uint16_t>(left + ((folded >> 1) ^ -(folded & 1)));
      left_confidence = static_cast<std::uint8_t>(left_confidence + *level++);
      code[column] = left;
      confidence[column] = left_confidence;
    }
  }
  return coded;
}

UserError Damaged(const std::filesystem::path& path) {
  return UserError(path.string() + ": is damaged or gone; leave the folder as orb360 has made it");
}

struct StoredBytes {
  std::string bytes;
  Header header;

  std::string_view packed() const {
    return std::string_view(bytes).substr(sizeof header, header.packed_bytes);
  }
  std::string_view color() const {
    return std::string_view(bytes).substr(sizeof header + header.packed_bytes);
  }
};

StoredBytes ReadBytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  StoredBytes stored{{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()}, {}};
  if (stored.bytes.size() < sizeof(Header)) throw Damaged(path);
  std::memcpy(&stored.header, stored.bytes.data(), sizeof(Header));
  const std::uint64_t expected =
      sizeof(Header) + std::uint64_t{stored.header.packed_bytes} + stored.header.color_bytes;
  if (expected != stored.bytes.size()) throw Damaged(path);
  return stored;
}

cv::Mat DecodeColor(std::string_view jpeg) {
  const cv::Mat bytes(1, static_cast<int>(jpeg.size()), CV_8UC1, const_cast<char*>(jpeg.data()));
  try {
    return jpeg.empty() ? cv::Mat() : cv::imdecode(bytes, cv::IMREAD_COLOR);
  } catch (const cv::Exception&) {
    return {};
  }
}

}  // namespace

std::filesystem::path DepthMapStore::PathOf(int frame_index) const {
  return folder_ / std::to_string(frame_index);
}

void DepthMapStore::Put(int frame_index, const DenseDepth& depth) const {
  const cv::Mat& range = depth.range;
  const cv::Mat& confidence = depth.confidence;
  ORB360_CHECK(
      range.type() == CV_32FC1 && confidence.type() == CV_32FC1 && depth.color.type() == CV_8UC3,
      range.type(), confidence.type(), depth.color.type());
  ORB360_CHECK(depth.source.empty() ||
                   (depth.source.type() == CV_8UC1 && depth.source.size() == range.size()),
               depth.source.type(), depth.source.size());
  ORB360_CHECK(
      !range.empty() && confidence.size() == range.size() && depth.color.size() == range.size(),
      range.size(), confidence.size(), depth.color.size());
  std::vector<unsigned char> color;
  cv::imencode(".jpg", depth.color, color, {cv::IMWRITE_JPEG_QUALITY, kColorQuality});
  const std::string packed = Pack(Encode(range, confidence, depth.source));
  const Header header{
      static_cast<std::uint32_t>(range.cols), static_cast<std::uint32_t>(range.rows),
      static_cast<std::uint32_t>(packed.size()), static_cast<std::uint32_t>(color.size())};
  // These files are useless after a crash, so the disk is not synced.
  OutputFile file(PathOf(frame_index));
  file.Write({reinterpret_cast<const char*>(&header), sizeof header});
  file.Write(packed);
  file.Write({reinterpret_cast<const char*>(color.data()), color.size()});
}

void DepthMapStore::CopyTo(int frame_index, const std::filesystem::path& folder) const {
  const StoredBytes stored = ReadBytes(PathOf(frame_index));
  OutputFile(folder / std::to_string(frame_index)).Write(stored.bytes);
}

bool DepthMapStore::Contains(int frame_index) const {
  return std::filesystem::exists(PathOf(frame_index));
}

DenseDepth DepthMapStore::Get(int frame_index) const {
  const std::filesystem::path path = PathOf(frame_index);
  const StoredBytes stored = ReadBytes(path);
  DenseDepth depth;
  depth.color = DecodeColor(stored.color());
  const cv::Size size = depth.color.size();
  if (size.empty() || size != cv::Size(static_cast<int>(stored.header.width),
                                       static_cast<int>(stored.header.height))) {
    throw Damaged(path);
  }
  const auto [codes, confidences, sources] = Unpack(stored.packed(), size.width, size.height);
  if (codes.empty()) throw Damaged(path);
  depth.range.create(codes.size(), CV_32FC1);
  const std::vector<float>& ranges = RangeOfCode();
  for (int row = 0; row < codes.rows; ++row) {
    const std::uint16_t* code = codes.ptr<std::uint16_t>(row);
    std::transform(code, code + codes.cols, depth.range.ptr<float>(row),
                   [&ranges](std::uint16_t c) { return ranges[c]; });
  }
  confidences.convertTo(depth.confidence, CV_32F, 1.0 / 255.0);
  depth.source = sources;
  return depth;
}

}  // namespace orb360
