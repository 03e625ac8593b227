#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace orb360::town {

/// Checks the width of a panorama, which is twice its height.
inline CLI::Validator EvenNumber() {
  const auto problem = [](const std::string& text) {
    const bool is_even = !text.empty() && (text.back() - '0') % 2 == 0;
    return is_even ? "" : text + " is odd, but panoramas are twice as wide as high";
  };
  return {problem, "EVEN"};
}

}  // namespace orb360::town
