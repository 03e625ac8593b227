#include "slam/io/ply.h"

#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>

#include "nn/base/check.h"
#include "slam/io/atomic_file.h"
#include "slam/io/number_text.h"

namespace orb360 {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY files are written byte by byte");

constexpr std::string_view kHeaderBegin = "ply\nformat binary_little_endian 1.0\nelement vertex ";
constexpr std::string_view kHeaderEnd =
    "\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
constexpr size_t kPointBytes = 3 * sizeof(float) + 3;

}  // namespace

void WritePly(const std::filesystem::path& path, std::span<const ColoredPoint> points,
              const Rigid3& file_world_from_map) {
  constexpr size_t kChunkBytes = size_t{1} << 20;  // Clouds may be larger than the memory left.
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
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  std::string_view data = bytes;
  const size_t end = data.find(kHeaderEnd);
  std::optional<size_t> count;
  if (data.starts_with(kHeaderBegin) && end != std::string_view::npos) {
    count = ParseNumber<size_t>(data.substr(kHeaderBegin.size(), end - kHeaderBegin.size()));
    data.remove_prefix(end + kHeaderEnd.size());
  }
  if (!count || data.size() % kPointBytes != 0 || *count != data.size() / kPointBytes) {
    throw UserError(path.string() + ": is not a cloud that orb360 wrote");
  }
  std::vector<ColoredPoint> points(*count);
  for (ColoredPoint& point : points) {
    std::memcpy(point.position.data(), data.data(), 3 * sizeof(float));
    std::memcpy(point.rgb.data(), data.data() + 3 * sizeof(float), point.rgb.size());
    data.remove_prefix(kPointBytes);
  }
  return points;
}

}  // namespace orb360
