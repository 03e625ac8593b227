#include "slam/io/export/las_writer.h"

#include <bit>
#include <cmath>
#include <string_view>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

static_assert(std::endian::native == std::endian::little, "LAS files are little endian");

constexpr std::uint16_t kHeaderBytes = 375;
constexpr std::uint32_t kRecordHeaderBytes = 54;  // of a variable length record
constexpr std::uint8_t kPointFormat = 7;
constexpr std::uint16_t kPointBytes = 36;
constexpr std::uint16_t kDescriptorBytes = 192;  // of one attribute in the extra bytes
/// Coordinate systems are WKT. The specification wants the bit in every file of the point formats 6
/// to 10, also where there is no coordinate system.
constexpr std::uint16_t kWktEncoding = 1 << 4;
constexpr int kReturns = 15;  // counts in the header
constexpr double kMaxSteps = 2147483647;

/// Returns 10^exponent with one rounding at most.
double PowerOfTen(int exponent) {
  double power = 1;
  for (int i = 0; i < std::abs(exponent); ++i) power *= 10;
  return exponent < 0 ? 1 / power : power;
}

std::int32_t Quantize(double coordinate, double offset, double scale) {
  return static_cast<std::int32_t>(std::llround((coordinate - offset) / scale));
}

/// Text in a field of fixed size, with zeros behind.
void WriteText(std::string_view text, size_t size, ChunkedFile* file) {
  ORB360_CHECK(text.size() <= size, text);
  file->Write(std::string(text).append(size - text.size(), '\0'));
}

void WriteZeros(size_t count, ChunkedFile* file) { WriteText("", count, file); }

void WriteRecordHeader(std::string_view user, std::uint16_t id, size_t size,
                       std::string_view description, ChunkedFile* file) {
  constexpr size_t kMaxBytes = 65535;
  ORB360_CHECK(size <= kMaxBytes, description, size);
  file->WriteBinary<std::uint16_t>(0);
  WriteText(user, 16, file);
  file->WriteBinary<std::uint16_t>(id);
  file->WriteBinary<std::uint16_t>(static_cast<std::uint16_t>(size));
  WriteText(description, 32, file);
}

void WriteWkt(const std::string& wkt, ChunkedFile* file) {
  WriteRecordHeader("LASF_Projection", 2112, wkt.size() + 1, "OGC WKT coordinate system", file);
  WriteText(wkt, wkt.size() + 1, file);
}

/// Describes the extra bytes of a point: one float.
void WriteConfidenceDescriptor(ChunkedFile* file) {
  constexpr std::uint8_t kFloat = 9;
  WriteRecordHeader("LASF_Spec", 4, kDescriptorBytes, "Extra bytes", file);
  file->WriteBinary<std::uint16_t>(0);
  file->WriteBinary<std::uint8_t>(kFloat);
  file->WriteBinary<std::uint8_t>(0);  // There are no limits, and neither scale nor offset.
  WriteText("confidence", 32, file);
  WriteZeros(4 + 5 * 24, file);
  WriteText("1/c - 1: expected error, voxels", 32, file);
}

}  // namespace

LasQuantization QuantizationOf(const Eigen::AlignedBox3d& bounds) {
  ORB360_CHECK(!bounds.isEmpty() && bounds.min().allFinite() && bounds.max().allFinite());
  LasQuantization quantization;
  quantization.offset = bounds.center().array().round();
  const double extent = bounds.sizes().maxCoeff();
  constexpr double kMinSteps = 1e4;
  constexpr int kFinest = -9;  // With 0.5 between centre and offset still in 32 bits.
  int exponent = -3;
  while (extent > 0 && exponent > kFinest && extent < kMinSteps * PowerOfTen(exponent)) --exponent;
  // From the rounded offset the bounds are up to half a unit farther than half the extent.
  while (extent / 2 + 1 > kMaxSteps * PowerOfTen(exponent)) ++exponent;
  quantization.scale = PowerOfTen(exponent);
  return quantization;
}

LasWriter::LasWriter(const std::filesystem::path& path, const LasDescription& description)
    : quantization_(QuantizationOf(description.bounds)),
      has_confidence_(description.has_confidence),
      num_missing_(description.num_points),
      file_(path) {
  std::uint32_t point_offset = kHeaderBytes;
  if (!description.wkt.empty()) {
    point_offset += kRecordHeaderBytes + static_cast<std::uint32_t>(description.wkt.size()) + 1;
  }
  if (has_confidence_) point_offset += kRecordHeaderBytes + kDescriptorBytes;
  WriteHeader(description, point_offset);
  if (!description.wkt.empty()) WriteWkt(description.wkt, &file_);
  if (has_confidence_) WriteConfidenceDescriptor(&file_);
}

void LasWriter::WriteHeader(const LasDescription& description, std::uint32_t point_offset) {
  const auto& [scale, offset] = quantization_;
  file_.Write("LASF");
  file_.WriteBinary<std::uint16_t>(0);  // number of the file in a project
  file_.WriteBinary<std::uint16_t>(kWktEncoding);
  WriteZeros(16, &file_);  // GUID of a project
  file_.WriteBinary<std::uint8_t>(1);
  file_.WriteBinary<std::uint8_t>(4);
  WriteText("OTHER", 32, &file_);  // what made the points, of the specification's list
  WriteText("orb360", 32, &file_);
  file_.WriteBinary<std::uint16_t>(0);  // day and
  file_.WriteBinary<std::uint16_t>(0);  // year
  file_.WriteBinary<std::uint16_t>(kHeaderBytes);
  file_.WriteBinary<std::uint32_t>(point_offset);
  file_.WriteBinary<std::uint32_t>((description.wkt.empty() ? 0 : 1) + (has_confidence_ ? 1 : 0));
  file_.WriteBinary<std::uint8_t>(kPointFormat);
  file_.WriteBinary<std::uint16_t>(kPointBytes + (has_confidence_ ? sizeof(float) : 0));
  WriteZeros(4 + 5 * 4,
             &file_);  // The counts of older versions are 0 in the point formats 6 to 10.
  for (int axis = 0; axis < 3; ++axis) file_.WriteBinary<double>(scale);
  for (int axis = 0; axis < 3; ++axis) file_.WriteBinary<double>(offset(axis));
  for (int axis = 0; axis < 3; ++axis) {
    for (const Eigen::Vector3d& corner : {description.bounds.max(), description.bounds.min()}) {
      // As the points are stored, so that a reader finds none outside.
      const std::int32_t stored = Quantize(corner(axis), offset(axis), scale);
      file_.WriteBinary<double>(stored * scale + offset(axis));
    }
  }
  WriteZeros(8 + 8 + 4, &file_);  // There is neither a waveform nor an extended record.
  file_.WriteBinary<std::uint64_t>(description.num_points);
  file_.WriteBinary<std::uint64_t>(description.num_points);  // all are first returns
  WriteZeros((kReturns - 1) * 8, &file_);
}

void LasWriter::Append(const Eigen::Vector3d& position, const std::array<std::uint8_t, 3>& rgb,
                       float confidence) {
  constexpr std::uint8_t kOnlyReturn = 1 | 1 << 4;  // the first of one
  constexpr std::uint16_t kTo16Bits = 257;          // 255 becomes 65535
  ORB360_CHECK(num_missing_ > 0);
  --num_missing_;
  for (int axis = 0; axis < 3; ++axis) {
    file_.WriteBinary(Quantize(position(axis), quantization_.offset(axis), quantization_.scale));
  }
  file_.WriteBinary<std::uint16_t>(0);  // intensity
  file_.WriteBinary<std::uint8_t>(kOnlyReturn);
  WriteZeros(1 + 1 + 1 + 2 + 2 + 8, &file_);  // flags, class, user data, angle, source, time
  for (const std::uint8_t channel : rgb) {
    file_.WriteBinary<std::uint16_t>(static_cast<std::uint16_t>(channel * kTo16Bits));
  }
  if (has_confidence_) file_.WriteBinary(confidence);
}

void LasWriter::Commit() {
  ORB360_CHECK(num_missing_ == 0, num_missing_);
  file_.Commit();
}

}  // namespace orb360
