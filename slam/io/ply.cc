#include "slam/io/ply.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>

#include "nn/base/number_text.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY files are written byte by byte");

constexpr std::string_view kHeaderBegin = "ply\nformat binary_little_endian 1.0\nelement vertex ";
constexpr std::string_view kHeaderEnd =
    "\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
constexpr size_t kPointBytes = 3 * sizeof(float) + 3;

constexpr std::string_view kSurfaceProperties =
    "\nproperty float x\nproperty float y\nproperty float z\n"
    "property float nx\nproperty float ny\nproperty float nz\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    "property float confidence\nend_header\n";
constexpr std::string_view kVoxelComment =
    "comment confidence c: 1/c - 1 is the error to be expected, in voxels of ";
constexpr size_t kSurfaceBytes = 7 * sizeof(float) + 3;
/// Size of the header's beginning. It has room for the comment and any number of points, so that
/// all headers have the same length.
constexpr size_t kSurfaceBeginBytes = 160;

/// Clouds may be larger than the available memory, so they are written in pieces.
constexpr size_t kChunkBytes = size_t{1} << 20;

UserError NotOurs(const std::filesystem::path& path) {
  return UserError(path.string() +
                   ": is not a cloud that orb360 wrote, or is damaged; run `orb360 run` again");
}

/// The point that is stored in kPointBytes bytes.
SurfacePoint ColoredPointAt(const char* bytes) {
  SurfacePoint point;
  std::memcpy(point.position.data(), bytes, 3 * sizeof(float));
  std::memcpy(point.rgb.data(), bytes + 3 * sizeof(float), point.rgb.size());
  return point;
}

/// The point that is stored in kSurfaceBytes bytes.
SurfacePoint SurfacePointAt(const char* bytes) {
  SurfacePoint point;
  std::memcpy(point.position.data(), bytes, 3 * sizeof(float));
  std::memcpy(point.normal.data(), bytes + 3 * sizeof(float), 3 * sizeof(float));
  std::memcpy(point.rgb.data(), bytes + 6 * sizeof(float), 3);
  std::memcpy(&point.confidence, bytes + 6 * sizeof(float) + 3, sizeof(float));
  return point;
}

std::string ReadBytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {(std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>()};
}

}  // namespace

void WritePly(const std::filesystem::path& path, std::span<const ColoredPoint> points,
              const Rigid3& file_world_from_map) {
  AtomicFile file(path);
  std::string buffer(kHeaderBegin);
  buffer += std::to_string(points.size());
  buffer += kHeaderEnd;
  for (const ColoredPoint& point : points) {
    const Eigen::Vector3f position =
        (file_world_from_map * point.position.cast<double>()).cast<float>();
    buffer.append(reinterpret_cast<const char*>(position.data()), 3 * sizeof(float));
    buffer.append(reinterpret_cast<const char*>(point.rgb.data()), point.rgb.size());
    if (buffer.size() >= kChunkBytes) {
      file.Write(buffer);
      buffer.clear();
    }
  }
  file.Write(buffer);
  file.Commit();
}

std::vector<ColoredPoint> ReadPly(const std::filesystem::path& path) {
  const std::string bytes = ReadBytes(path);
  std::string_view data = bytes;
  const size_t end = data.find(kHeaderEnd);
  std::optional<size_t> count;
  if (data.starts_with(kHeaderBegin) && end != std::string_view::npos) {
    count = ParseNumber<size_t>(data.substr(kHeaderBegin.size(), end - kHeaderBegin.size()));
    data.remove_prefix(end + kHeaderEnd.size());
  }
  if (!count || data.size() % kPointBytes != 0 || *count != data.size() / kPointBytes) {
    throw NotOurs(path);
  }
  std::vector<ColoredPoint> points(*count);
  for (ColoredPoint& point : points) {
    std::memcpy(point.position.data(), data.data(), 3 * sizeof(float));
    std::memcpy(point.rgb.data(), data.data() + 3 * sizeof(float), point.rgb.size());
    data.remove_prefix(kPointBytes);
  }
  return points;
}

SurfacePlyWriter::SurfacePlyWriter(const std::filesystem::path& path, double voxel_size)
    : voxel_size_(voxel_size), file_(path) {
  file_.Write(Header());
}

std::string SurfacePlyWriter::Header() const {
  std::string comment(kVoxelComment);
  comment += ToText(static_cast<float>(voxel_size_));
  std::string element = "\nelement vertex ";
  element += std::to_string(num_points_);
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  ORB360_CHECK(header.size() + comment.size() + element.size() <= kSurfaceBeginBytes, comment);
  comment.resize(kSurfaceBeginBytes - header.size() - element.size(), ' ');
  header += comment;
  header += element;
  header += kSurfaceProperties;
  return header;
}

void SurfacePlyWriter::Append(std::span<const SurfacePoint> points) {
  std::string buffer;
  for (const SurfacePoint& point : points) {
    buffer.append(reinterpret_cast<const char*>(point.position.data()), 3 * sizeof(float));
    buffer.append(reinterpret_cast<const char*>(point.normal.data()), 3 * sizeof(float));
    buffer.append(reinterpret_cast<const char*>(point.rgb.data()), point.rgb.size());
    buffer.append(reinterpret_cast<const char*>(&point.confidence), sizeof(float));
    if (buffer.size() >= kChunkBytes) {
      file_.Write(buffer);
      buffer.clear();
    }
  }
  file_.Write(buffer);
  num_points_ += points.size();
}

void SurfacePlyWriter::Commit() {
  file_.Overwrite(0, Header());
  file_.Commit();
}

bool IsSurfacePly(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string begin(kSurfaceBeginBytes + kSurfaceProperties.size(), '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return file && begin.ends_with(kSurfaceProperties);
}

std::optional<double> VoxelSizeOf(const std::filesystem::path& path) {
  if (!IsSurfacePly(path)) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  std::string begin(kSurfaceBeginBytes, '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  const size_t at = begin.find(kVoxelComment);
  if (at == std::string::npos) return std::nullopt;
  const std::string text = begin.substr(at + kVoxelComment.size());
  return ParseNumber<double>(text.substr(0, text.find_first_of(" \n")));
}

std::vector<SurfacePoint> ReadSurfacePly(const std::filesystem::path& path) {
  const std::string bytes = ReadBytes(path);
  std::string_view data = bytes;
  constexpr std::string_view kElement = "\nelement vertex ";
  const size_t properties = data.find(kSurfaceProperties);
  const size_t element = data.find(kElement);
  std::optional<size_t> count;
  if (data.starts_with("ply\n") && properties != std::string_view::npos && element < properties) {
    const size_t number = element + kElement.size();
    count = ParseNumber<size_t>(data.substr(number, properties - number));
    data.remove_prefix(properties + kSurfaceProperties.size());
  }
  if (!count || data.size() % kSurfaceBytes != 0 || *count != data.size() / kSurfaceBytes) {
    throw NotOurs(path);
  }
  std::vector<SurfacePoint> points(*count);
  for (SurfacePoint& point : points) {
    point = SurfacePointAt(data.data());
    data.remove_prefix(kSurfaceBytes);
  }
  return points;
}

void ReadCloudPoints(const std::filesystem::path& path,
                     const std::function<void(const SurfacePoint&)>& take) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path)) {
    throw UserError(path.string() +
                    ": cannot be opened as a cloud; `orb360 run` and `orb360 fuse` make one");
  }
  constexpr size_t kMaxHeaderBytes = 4096;
  std::string begin(kMaxHeaderBytes, '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<size_t>(file.gcount()));
  const bool is_surface = begin.find(kSurfaceProperties) != std::string::npos;
  const std::string_view properties = is_surface ? kSurfaceProperties : kHeaderEnd;
  constexpr std::string_view kElement = "\nelement vertex ";
  const size_t end = begin.find(properties);
  const size_t element = begin.find(kElement);
  if (!begin.starts_with("ply\n") || end == std::string::npos || element > end) throw NotOurs(path);
  const size_t number = element + kElement.size();
  const auto count =
      ParseNumber<size_t>(std::string_view(begin).substr(number, end - std::min(end, number)));
  const size_t header = end + properties.size();
  const size_t point_bytes = is_surface ? kSurfaceBytes : kPointBytes;
  const std::uintmax_t bytes = std::filesystem::file_size(path) - header;
  if (!count || bytes % point_bytes != 0 || *count != bytes / point_bytes) throw NotOurs(path);
  file.clear();
  file.seekg(static_cast<std::streamoff>(header));
  std::string piece(kChunkBytes / point_bytes * point_bytes, '\0');
  for (std::uintmax_t left = bytes; left > 0;) {
    piece.resize(std::min<std::uintmax_t>(left, piece.size()));
    if (!file.read(piece.data(), static_cast<std::streamsize>(piece.size()))) throw NotOurs(path);
    left -= piece.size();
    for (size_t at = 0; at < piece.size(); at += point_bytes) {
      take(is_surface ? SurfacePointAt(piece.data() + at) : ColoredPointAt(piece.data() + at));
    }
  }
}

}  // namespace orb360
