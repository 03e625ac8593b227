#include "slam/io/export/pose_text.h"

#include <charconv>

namespace orb360 {

void AppendNumbers(std::span<const double> numbers, char separator, std::string* text) {
  std::array<char, 32> buffer;
  for (const double number : numbers) {
    // Adding zero turns -0 into 0.
    const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number + 0.0);
    *text += separator;
    text->append(buffer.data(), result.ptr);
  }
}

void AppendInteger(std::uint64_t number, char separator, std::string* text) {
  *text += separator;
  *text += std::to_string(number);
}

}  // namespace orb360
