#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace orb360::town {

/// Builds the bytes of a small map of Quake 3.
class QuakeBspBuilder {
 public:
  std::string entities;
  std::string light_pages;

  int AddShader(const std::string& name, int flags = 0, int contents = 0) {
    std::string record = name;
    record.resize(64, '\0');
    shaders_ += record + Int(flags) + Int(contents);
    return shader_count_++;
  }
  int AddVertex(const Eigen::Vector3f& position, const Eigen::Vector2f& uv,
                const Eigen::Vector2f& light_uv, const Eigen::Vector3f& normal,
                const std::array<uint8_t, 3>& colour = {255, 255, 255}) {
    for (const float x : position) vertices_ += Float(x);
    for (const float x : uv) vertices_ += Float(x);
    for (const float x : light_uv) vertices_ += Float(x);
    for (const float x : normal) vertices_ += Float(x);
    for (const uint8_t x : colour) vertices_ += static_cast<char>(x);
    vertices_ += '\xff';
    return vertex_count_++;
  }
  /// Adds a face of the kinds 1 (polygon) or 3 (mesh).
  void AddFace(int kind, int shader, int first_vertex, int count, const std::vector<int>& corners,
               int light_page) {
    const int first = index_count_;
    for (const int corner : corners) indices_ += Int(corner);
    index_count_ += static_cast<int>(corners.size());
    faces_ += Face(kind, shader, first_vertex, count, first, static_cast<int>(corners.size()),
                   light_page, 0, 0);
    ++face_count_;
  }
  void AddPatch(int shader, int first_vertex, int width, int height, int light_page) {
    faces_ += Face(2, shader, first_vertex, width * height, 0, 0, light_page, width, height);
    ++face_count_;
  }
  /// Ends a model with the faces that were added since the last one.
  void EndModel() {
    models_ += std::string(24, '\0') + Int(model_begin_) + Int(face_count_ - model_begin_) +
               Int(0) + Int(0);
    model_begin_ = face_count_;
  }
  /// Adds a rectangle that faces `normal`, with corners clockwise from its front.
  void AddQuad(int shader, const std::array<Eigen::Vector3f, 4>& corners,
               const Eigen::Vector3f& normal, int light_page) {
    const std::array<Eigen::Vector2f, 4> uv = {{{0.F, 0.F}, {1.F, 0.F}, {1.F, 1.F}, {0.F, 1.F}}};
    const int first = vertex_count_;
    for (size_t i = 0; i < 4; ++i) AddVertex(corners[i], uv[i], uv[i], normal);
    AddFace(1, shader, first, 4, {0, 1, 2, 0, 2, 3}, light_page);
  }

  std::string Bytes() const {
    std::array<std::string, 17> lumps;
    lumps[0] = entities;
    lumps[1] = shaders_;
    lumps[7] = models_;
    lumps[10] = vertices_;
    lumps[11] = indices_;
    lumps[13] = faces_;
    lumps[14] = light_pages;
    std::string header = "IBSP" + Int(46);
    std::string body;
    for (const std::string& lump : lumps) {
      header += Int(static_cast<int>(8 + 8 * lumps.size() + body.size()));
      header += Int(static_cast<int>(lump.size()));
      body += lump;
    }
    return header + body;
  }

  static std::string Int(int value) {
    std::string bytes;
    for (int i = 0; i < 4; ++i)
      bytes += static_cast<char>(static_cast<uint32_t>(value) >> (8 * i) & 255U);
    return bytes;
  }
  static std::string Float(float value) { return Int(std::bit_cast<int>(value)); }

 private:
  static std::string Face(int kind, int shader, int first_vertex, int count, int first_index,
                          int index_count, int light_page, int width, int height) {
    std::string record = Int(shader) + Int(-1) + Int(kind) + Int(first_vertex) + Int(count) +
                         Int(first_index) + Int(index_count) + Int(light_page);
    record.resize(96, '\0');
    return record + Int(width) + Int(height);
  }

  std::string shaders_, models_, vertices_, indices_, faces_;
  int shader_count_ = 0, vertex_count_ = 0, index_count_ = 0, face_count_ = 0, model_begin_ = 0;
};

}  // namespace orb360::town
