#include "slam/depth/surface_nets.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

// Cells along a side of a block, whose corners fit into the cache.
constexpr int kBlock = 32;
// A block also needs the vertices of the cells before it, and so the corners around those.
constexpr int kCorners = kBlock + 2;

struct Corner {
  float weight = 0;
  float distance = 0;  // Weighted sum, in cells.
  std::array<float, 3> normal{};
  std::array<float, 3> rgb{};
  int count = 0;  // Number of points.
};

// Its place in its cell is rounded, not its place in the cube, so that it bears on a corner by the
// same number in every cube.
struct Point {
  CellIndex cell;            // From the first cell of the cube.
  Eigen::Vector3f fraction;  // Place in the cell, in cells.
  Eigen::Vector3f normal;
  std::array<std::uint8_t, 3> rgb;
  float weight;
};

CellIndex operator+(const CellIndex& a, const CellIndex& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

/// The corners and cells of one block. Indices of both begin one cell before the block.
class Block {
 public:
  Block(const CellIndex& first, const SurfaceNetsOptions& options)
      : first_(first), options_(options), corners_(Volume()), is_near_(Volume(), 0) {}

  void Add(const Point& point);
  /// Appends the vertices of the block's cells and the triangles across the edges that begin at
  /// their first corners. Indices of cells are from the cube's first one.
  void Extract(SurfacePart* part) const;

 private:
  static size_t Volume() { return static_cast<size_t>(kCorners) * kCorners * kCorners; }
  static size_t At(int x, int y, int z) {
    return (static_cast<size_t>(z) * kCorners + static_cast<size_t>(y)) * kCorners +
           static_cast<size_t>(x);
  }
  static size_t At(const CellIndex& cell) { return At(cell[0], cell[1], cell[2]); }
  bool IsKnown(const Corner& corner) const { return corner.count >= options_.min_points; }
  std::optional<SurfacePoint> VertexOf(const CellIndex& cell) const;

  const CellIndex first_;
  const SurfaceNetsOptions& options_;
  std::vector<Corner> corners_;
  std::vector<std::uint8_t> is_near_;  // By cell: whether a point is near it.
};

void Block::Add(const Point& point) {
  const auto radius = static_cast<float>(options_.radius);
  const int reach = static_cast<int>(std::ceil(options_.radius));
  const int gap = options_.max_gap;
  // Indices from the first corner of the block.
  const CellIndex cell = {point.cell[0] - first_[0] + 1, point.cell[1] - first_[1] + 1,
                          point.cell[2] - first_[2] + 1};
  const auto for_range = [&cell](int before, int after, const auto& visit) {
    for (int z = std::max(0, cell[2] - before); z <= std::min(kCorners - 1, cell[2] + after); ++z) {
      for (int y = std::max(0, cell[1] - before); y <= std::min(kCorners - 1, cell[1] + after);
           ++y) {
        for (int x = std::max(0, cell[0] - before); x <= std::min(kCorners - 1, cell[0] + after);
             ++x) {
          visit(x, y, z);
        }
      }
    }
  };
  for_range(gap, gap, [&](int x, int y, int z) { is_near_[At(x, y, z)] = 1; });
  for_range(reach, reach + 1, [&](int x, int y, int z) {
    const Eigen::Vector3f from_point =
        Eigen::Vector3f(static_cast<float>(x - cell[0]), static_cast<float>(y - cell[1]),
                        static_cast<float>(z - cell[2])) -
        point.fraction;
    const float squared = from_point.squaredNorm() / (radius * radius);
    if (squared >= 1) return;
    const float weight = point.weight * (1 - squared) * (1 - squared);
    Corner& corner = corners_[At(x, y, z)];
    corner.weight += weight;
    corner.distance += weight * point.normal.dot(from_point);
    for (int i = 0; i < 3; ++i) {
      corner.normal[i] += weight * point.normal[i];
      corner.rgb[i] += weight * static_cast<float>(point.rgb[i]);
    }
    ++corner.count;
  });
}

std::optional<SurfacePoint> Block::VertexOf(const CellIndex& cell) const {
  if (is_near_[At(cell)] == 0) return std::nullopt;
  std::array<const Corner*, 8> corners{};
  std::array<float, 8> distances{};
  int num_inside = 0;
  for (int i = 0; i < 8; ++i) {
    corners[i] = &corners_[At(cell + CellIndex{i & 1, i >> 1 & 1, i >> 2})];
    if (!IsKnown(*corners[i])) return std::nullopt;
    distances[i] = corners[i]->distance / corners[i]->weight;
    num_inside += distances[i] < 0;
  }
  if (num_inside == 0 || num_inside == 8) return std::nullopt;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  int count = 0;
  for (int i = 0; i < 8; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const int j = i | 1 << axis;
      if (j == i || (distances[i] < 0) == (distances[j] < 0)) continue;
      Eigen::Vector3f place(static_cast<float>(i & 1), static_cast<float>(i >> 1 & 1),
                            static_cast<float>(i >> 2));
      place[axis] = distances[i] / (distances[i] - distances[j]);
      sum += place;
      ++count;
    }
  }
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  Eigen::Vector3f rgb = Eigen::Vector3f::Zero();
  float weight = 0;
  for (const Corner* corner : corners) {
    weight += corner->weight;
    normal += Eigen::Map<const Eigen::Vector3f>(corner->normal.data());
    rgb += Eigen::Map<const Eigen::Vector3f>(corner->rgb.data());
  }
  SurfacePoint vertex;
  vertex.position = sum / static_cast<float>(count);  // In the cell.
  for (int axis = 0; axis < 3; ++axis) {
    vertex.rgb[axis] = static_cast<std::uint8_t>(std::lround(rgb[axis] / weight));
  }
  vertex.normal = normal.normalized();
  vertex.confidence = 1;
  return vertex;
}

void Block::Extract(SurfacePart* part) const {
  std::vector<std::uint8_t> has_vertex(Volume(), 0);
  for (int z = 0; z <= kBlock; ++z) {
    for (int y = 0; y <= kBlock; ++y) {
      for (int x = 0; x <= kBlock; ++x) {
        const std::optional<SurfacePoint> vertex = VertexOf({x, y, z});
        if (!vertex) continue;
        has_vertex[At(x, y, z)] = 1;
        if (x == 0 || y == 0 || z == 0) continue;  // It belongs to another block.
        part->vertices.push_back(*vertex);
        part->cells.push_back(first_ + CellIndex{x - 1, y - 1, z - 1});
      }
    }
  }
  for (int z = 1; z <= kBlock; ++z) {
    for (int y = 1; y <= kBlock; ++y) {
      for (int x = 1; x <= kBlock; ++x) {
        const CellIndex cell{x, y, z};
        if (has_vertex[At(cell)] == 0) continue;
        const bool is_inside = corners_[At(cell)].distance < 0;
        for (int axis = 0; axis < 3; ++axis) {
          CellIndex end = cell;
          ++end[axis];
          if ((corners_[At(end)].distance < 0) == is_inside) continue;
          // The four cells around the edge, counterclockwise as seen from its end.
          std::array<CellIndex, 4> around{cell, cell, cell, cell};
          --around[1][(axis + 1) % 3];
          --around[2][(axis + 1) % 3];
          --around[2][(axis + 2) % 3];
          --around[3][(axis + 2) % 3];
          if (std::ranges::any_of(around, [&](const CellIndex& c) { return !has_vertex[At(c)]; })) {
            continue;
          }
          if (!is_inside) std::swap(around[1], around[3]);
          for (CellIndex& c : around) c = c + first_ + CellIndex{-1, -1, -1};
          part->triangles.push_back({around[0], around[1], around[2]});
          part->triangles.push_back({around[0], around[2], around[3]});
        }
      }
    }
  }
}

}  // namespace

int SurfaceMargin(const SurfaceNetsOptions& options) {
  // The corners of the cells before the cube are one cell outside it.
  return 1 + static_cast<int>(std::ceil(std::max<double>(options.radius, options.max_gap)));
}

SurfacePart ExtractSurface(std::span<const SurfacePoint> points, const CellIndex& first, int side,
                           double cell_size, const SurfaceNetsOptions& options, int num_threads) {
  ORB360_CHECK(side > 0 && side % kBlock == 0, side);
  ORB360_CHECK(cell_size > 0 && options.radius > 0 && options.min_points > 0 &&
                   options.max_gap >= 0 && options.max_gap <= 2,
               cell_size, options.radius, options.min_points, options.max_gap);
  const int num_blocks = side / kBlock;
  const int margin = SurfaceMargin(options);
  // The points that bear on each block, in the order of `points`.
  std::vector<std::vector<Point>> points_of(static_cast<size_t>(num_blocks) * num_blocks *
                                            num_blocks);
  for (const SurfacePoint& point : points) {
    const Eigen::Vector3d place = point.position.cast<double>() / cell_size;
    // The expected distance from the surface, in voxels of the cloud.
    const float error = std::max(0.1F, 1 / std::max(point.confidence, 1e-3F) - 1);
    Point added{{}, {}, point.normal, point.rgb, 1 / (error * error)};
    CellIndex low;
    CellIndex high;
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = std::floor(place[axis]);
      const double index = cell - first[axis];
      ORB360_CHECK(index >= -margin && index < side + margin, point.position.transpose(), side);
      added.cell[axis] = static_cast<std::int32_t>(index);
      added.fraction[axis] = static_cast<float>(place[axis] - cell);
      // Blocks begin at multiples of their size.
      low[axis] = std::max(0, (added.cell[axis] - margin + kBlock) / kBlock - 1);
      high[axis] = std::min(num_blocks - 1, (added.cell[axis] + margin) / kBlock);
    }
    for (int z = low[2]; z <= high[2]; ++z) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int x = low[0]; x <= high[0]; ++x) {
          points_of[(static_cast<size_t>(z) * num_blocks + y) * num_blocks + x].push_back(added);
        }
      }
    }
  }
  std::vector<SurfacePart> parts(points_of.size());
#pragma omp parallel for schedule(dynamic) num_threads(num_threads)
  for (size_t b = 0; b < points_of.size(); ++b) {
    if (points_of[b].empty()) continue;
    const auto index = static_cast<std::int32_t>(b);
    Block block({kBlock * (index % num_blocks), kBlock * (index / num_blocks % num_blocks),
                 kBlock * (index / (num_blocks * num_blocks))},
                options);
    for (const Point& point : points_of[b]) block.Add(point);
    block.Extract(&parts[b]);
  }
  SurfacePart whole;
  for (const SurfacePart& part : parts) {
    for (size_t i = 0; i < part.vertices.size(); ++i) {
      const CellIndex cell = part.cells[i] + first;
      SurfacePoint vertex = part.vertices[i];
      vertex.position = (cell_size * (vertex.position.cast<double>() +
                                      Eigen::Vector3d(cell[0], cell[1], cell[2])))
                            .cast<float>();
      whole.vertices.push_back(vertex);
      whole.cells.push_back(cell);
    }
    for (const std::array<CellIndex, 3>& triangle : part.triangles) {
      whole.triangles.push_back({triangle[0] + first, triangle[1] + first, triangle[2] + first});
    }
  }
  return whole;
}

}  // namespace orb360
