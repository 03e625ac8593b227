#include "apps/town/sequence/exr_image.h"

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

#include "slam/io/atomic_file.h"

namespace orb360::town {
namespace {

using namespace std::string_view_literals;

/// Writes the numbers of the format, lowest byte first.
class ByteWriter {
 public:
  void Add(std::string_view bytes) { bytes_ += bytes; }
  void Add(uint64_t number, int size) {
    for (int i = 0; i < size; ++i) bytes_ += static_cast<char>(number >> (8 * i) & 255U);
  }
  void Add(int number) { Add(static_cast<uint32_t>(number), 4); }
  void Add(float number) { Add(std::bit_cast<uint32_t>(number), 4); }
  void BeginAttribute(std::string_view name_and_type, int size) {
    Add(name_and_type);
    Add(size);
  }
  void AddBox(std::string_view name, int width, int height) {
    Add(name);
    BeginAttribute("box2i\0"sv, 16);
    for (const int bound : {0, 0, width - 1, height - 1}) Add(bound);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace

void WriteExrImage(const std::filesystem::path& path, const cv::Mat1f& image) {
  constexpr int kFloat = 2;  // type of a channel
  ByteWriter file;
  file.Add("\x76\x2f\x31\x01"sv);
  file.Add(2);  // version, and no flags: scan lines, one part
  file.BeginAttribute("channels\0chlist\0"sv, 19);
  file.Add("Y\0"sv);
  for (const int number : {kFloat, 0, 1, 1}) file.Add(number);  // linear; every pixel has it
  file.Add("\0"sv);
  file.BeginAttribute("compression\0compression\0"sv, 1);
  file.Add("\0"sv);
  file.AddBox("dataWindow\0"sv, image.cols, image.rows);
  file.AddBox("displayWindow\0"sv, image.cols, image.rows);
  file.BeginAttribute("lineOrder\0lineOrder\0"sv, 1);
  file.Add("\0"sv);  // from the top
  file.BeginAttribute("pixelAspectRatio\0float\0"sv, 4);
  file.Add(1.0F);
  file.BeginAttribute("screenWindowCenter\0v2f\0"sv, 8);
  file.Add(0.0F);
  file.Add(0.0F);
  file.BeginAttribute("screenWindowWidth\0float\0"sv, 4);
  file.Add(1.0F);
  file.Add("\0"sv);

  // The offset of each line, then the lines: their number, their size in bytes, their pixels.
  const auto line_size = static_cast<uint64_t>(image.cols) * 4;
  const uint64_t first = file.bytes().size() + 8 * static_cast<uint64_t>(image.rows);
  for (int row = 0; row < image.rows; ++row)
    file.Add(first + static_cast<uint64_t>(row) * (8 + line_size), 8);
  for (int row = 0; row < image.rows; ++row) {
    file.Add(row);
    file.Add(line_size, 4);
    for (int column = 0; column < image.cols; ++column) file.Add(image(row, column));
  }
  WriteFileAtomically(path, file.bytes());
}

}  // namespace orb360::town
