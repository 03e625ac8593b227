#include "apps/town/import/tga_image.h"

#include "apps/town/import/file_bytes.h"

namespace orb360::town {
namespace {

constexpr size_t kHeaderSize = 18;
constexpr size_t kLargestSide = 16384;  // pixels; a damaged size must not take all memory

cv::Vec4b Pixel(const FileBytes& file, size_t offset, size_t bytes) {
  const auto p = file.From(offset, bytes);
  if (bytes == 1) return {p[0], p[0], p[0], 255};
  return {p[0], p[1], p[2], bytes == 4 ? p[3] : uint8_t{255}};
}

}  // namespace

cv::Mat4b ReadTgaImage(const std::filesystem::path& path) {
  const FileBytes file(path);
  const uint32_t kind = file.Word(2, 1);
  const bool is_packed = kind == 10 || kind == 11;
  const bool is_grey = kind == 3 || kind == 11;
  const size_t width = file.Word(12, 2);
  const size_t height = file.Word(14, 2);
  const size_t bits = file.Word(16, 1);
  const bool is_known =
      is_grey ? bits == 8 : (kind == 2 || kind == 10) && (bits == 24 || bits == 32);
  if (!is_known) file.Refuse("is of a kind of TGA image that is not read: save it as PNG");
  if (width == 0 || height == 0 || width > kLargestSide || height > kLargestSide)
    file.Refuse("has a size that is not read");
  const size_t bytes = bits / 8;
  // A table of colours may be present, though it is not used.
  const size_t table = file.Word(1, 1) == 1 ? file.Word(5, 2) * ((file.Word(7, 1) + 7) / 8) : 0;
  size_t in = kHeaderSize + file.Word(0, 1) + table;
  const size_t count = width * height;
  // Checks the least length before memory is allocated; a run holds at most 128 pixels.
  file.From(in, is_packed ? (count + 127) / 128 * (1 + bytes) : count * bytes);

  cv::Mat4b image(static_cast<int>(height), static_cast<int>(width));
  const uint32_t descriptor = file.Word(17, 1);
  const bool from_top = (descriptor & 32U) != 0;
  const bool from_right = (descriptor & 16U) != 0;
  size_t out = 0;
  while (out < count) {
    size_t run = 1;
    bool repeats = false;
    if (is_packed) {
      const uint8_t code = file.Byte(in++);
      run = (code & 127U) + 1;
      repeats = (code & 128U) != 0;
      if (run > count - out) file.Refuse("is damaged: a run of pixels does not fit");
    }
    for (size_t i = 0; i < run; ++i, ++out) {
      const size_t x = from_right ? width - 1 - out % width : out % width;
      const size_t y = from_top ? out / width : height - 1 - out / width;
      image(static_cast<int>(y), static_cast<int>(x)) = Pixel(file, in, bytes);
      if (!repeats || i + 1 == run) in += bytes;
    }
  }
  return image;
}

}  // namespace orb360::town
