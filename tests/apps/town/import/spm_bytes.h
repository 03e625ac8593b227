#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace orb360::town {

/// Appends a number as it lies in memory.
template <typename T>
void Append(T number, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(&number), sizeof number);
}

inline void AppendText(const std::string& text, std::string* bytes) {
  Append(static_cast<uint8_t>(text.size()), bytes);
  bytes->append(text);
}

inline void AppendHalf(float number, std::string* bytes) { Append(Eigen::half(number).x, bytes); }

/// Returns a static SPM file with normals and colours: a triangle with corners (1, 2, 3),
/// (1, 2, 4) and (1, 3, 3), normals along -x, texture coordinates (0, 0), (0.5, 0) and (0, 0.25)
/// with v downward, and the colours white, (255, 51, 0) and white.
inline std::string SpmTriangle(const std::string& texture, const std::string& second = "") {
  std::string bytes = "SP";
  Append<uint8_t>(1U << 3 | 2U, &bytes);
  Append<uint8_t>(1U | 2U, &bytes);
  for (int i = 0; i < 6; ++i) Append(0.0F, &bytes);
  Append<uint16_t>(1, &bytes);  // materials
  AppendText(texture, &bytes);
  AppendText(second, &bytes);
  Append<uint16_t>(1, &bytes);  // sectors
  Append<uint16_t>(1, &bytes);  // meshes
  Append<uint32_t>(3, &bytes);
  Append<uint32_t>(3, &bytes);
  Append<uint16_t>(0, &bytes);
  const std::array<std::array<float, 5>, 3> corners = {
      {{1, 2, 3, 0, 0}, {1, 2, 4, 0.5F, 0}, {1, 3, 3, 0, 0.25F}}};
  for (size_t i = 0; i < 3; ++i) {
    for (size_t axis = 0; axis < 3; ++axis) Append(corners[i][axis], &bytes);
    Append<uint32_t>(0x3ffU & static_cast<uint32_t>(-511), &bytes);
    if (i == 1) {
      for (const uint8_t byte : {7, 255, 51, 0}) Append(byte, &bytes);
    } else {
      Append<uint8_t>(128, &bytes);
    }
    if (texture.empty()) continue;
    for (size_t k = 3; k < 5; ++k) AppendHalf(corners[i][k], &bytes);
    if (second.empty()) continue;
    for (size_t k = 3; k < 5; ++k) AppendHalf(9, &bytes);
  }
  for (const uint8_t index : {0, 1, 2}) Append(index, &bytes);
  return bytes;
}

}  // namespace orb360::town
