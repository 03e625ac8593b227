#pragma once

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

namespace orb360::town {

/// Returns "a/b.png" for "A/b.PNG"; letters outside of ASCII stay as they are.
inline std::string LowerCase(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(c < 128 ? std::tolower(c) : c); });
  return lower;
}

}  // namespace orb360::town
