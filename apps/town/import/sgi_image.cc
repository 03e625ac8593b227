#include "apps/town/import/sgi_image.h"

#include <cstdint>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

constexpr size_t kHeaderSize = 512;
constexpr size_t kLargestSide = 16384;  // pixels; a damaged size must not take all memory

/// The bytes of a file; numbers are big-endian. Reading beyond the end throws.
class Bytes {
 public:
  explicit Bytes(const std::filesystem::path& path) : name_(path.string()) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw UserError(name_ + ": cannot be opened");
    bytes_.assign(std::istreambuf_iterator<char>(file), {});
  }

  [[noreturn]] void Refuse(const std::string& reason) const {
    throw UserError(name_ + ": " + reason);
  }
  std::span<const uint8_t> From(size_t offset, size_t count) const {
    if (offset > bytes_.size() || count > bytes_.size() - offset)
      Refuse("is damaged: the image ends too early");
    return {reinterpret_cast<const uint8_t*>(bytes_.data()) + offset, count};
  }
  uint32_t Number(size_t offset, size_t count) const {
    uint32_t number = 0;
    for (const uint8_t byte : From(offset, count)) number = number << 8 | byte;
    return number;
  }

 private:
  std::string name_;
  std::vector<char> bytes_;
};

/// Decodes one row of one channel from its runs: a byte with a count in its lower seven bits,
/// followed by that many bytes to copy (highest bit set) or by one to repeat. A count of 0 ends the
/// row.
void DecodeRow(const Bytes& file, size_t offset, size_t length, std::span<uint8_t> row) {
  const std::span<const uint8_t> packed = file.From(offset, length);
  size_t in = 0;
  size_t out = 0;
  while (out < row.size()) {
    if (in >= packed.size()) file.Refuse("is damaged: a row ends too early");
    const uint8_t code = packed[in++];
    const size_t count = code & 127U;
    const bool copies = (code & 128U) != 0;
    if (count == 0 || count > row.size() - out || in + (copies ? count : 1) > packed.size())
      file.Refuse("is damaged: a row does not fit");
    for (size_t i = 0; i < count; ++i) row[out++] = packed[in + (copies ? i : 0)];
    in += copies ? count : 1;
  }
}

}  // namespace

cv::Mat4b ReadSgiImage(const std::filesystem::path& path) {
  const Bytes file(path);
  constexpr uint32_t kMagic = 474;
  if (file.Number(0, 2) != kMagic) file.Refuse("is not an SGI image");
  const bool is_packed = file.Number(2, 1) == 1;
  if (file.Number(3, 1) != 1) file.Refuse("has more than 8 bits a channel, which is not read");
  const uint32_t dimensions = file.Number(4, 2);
  const size_t width = file.Number(6, 2);
  const size_t height = dimensions > 1 ? file.Number(8, 2) : 1;
  const size_t channels = dimensions > 2 ? file.Number(10, 2) : 1;
  if (width == 0 || height == 0 || width > kLargestSide || height > kLargestSide || channels == 0 ||
      channels > 4)
    file.Refuse("has a size or a number of channels that is not read");

  // Checks that the file contains the rows, or the tables of their positions, before memory is
  // allocated.
  file.From(kHeaderSize, channels * height * (is_packed ? 8 : width));
  std::vector<std::vector<uint8_t>> planes(channels, std::vector<uint8_t>(width * height));
  for (size_t channel = 0; channel < channels; ++channel) {
    for (size_t y = 0; y < height; ++y) {
      const size_t index = channel * height + y;
      const std::span<uint8_t> row(planes[channel].data() + y * width, width);
      if (is_packed) {
        // The tables contain the offsets of the rows, then their lengths.
        DecodeRow(file, file.Number(kHeaderSize + 4 * index, 4),
                  file.Number(kHeaderSize + 4 * (channels * height + index), 4), row);
      } else {
        const std::span<const uint8_t> bytes = file.From(kHeaderSize + index * width, width);
        std::copy(bytes.begin(), bytes.end(), row.begin());
      }
    }
  }
  const size_t green = channels >= 3 ? 1 : 0;
  const size_t blue = channels >= 3 ? 2 : 0;
  const bool has_alpha = channels == 2 || channels == 4;
  cv::Mat4b image(static_cast<int>(height), static_cast<int>(width));
  for (size_t y = 0; y < height; ++y) {
    for (size_t x = 0; x < width; ++x) {
      const size_t i = y * width + x;
      // The first row is the lowest one.
      image(static_cast<int>(height - 1 - y), static_cast<int>(x)) = {
          planes[blue][i], planes[green][i], planes[0][i],
          has_alpha ? planes[channels - 1][i] : uint8_t{255}};
    }
  }
  return image;
}

}  // namespace orb360::town
