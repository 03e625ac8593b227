#include "apps/town/render/ray_directions.h"

namespace orb360::town {

static_assert(RayDirections::kSquare * RayDirections::kSquare == kLanes);

RayDirections::RayDirections(int width, int height, bool normalizes)
    : width_(width), height_(height), normalizes_(normalizes) {}

void RayDirections::AddSample(const std::function<Eigen::Vector3d(int)>& column,
                              const std::function<Row(int)>& row) {
  Columns& columns = columns_.emplace_back();
  for (int i = 0; i < width_ + kSquare; ++i) {
    const Eigen::Vector3d direction = column(i);
    columns.x.push_back(static_cast<float>(direction.x()));
    columns.y.push_back(static_cast<float>(direction.y()));
    columns.z.push_back(static_cast<float>(direction.z()));
  }
  std::vector<Row>& rows = rows_.emplace_back();
  for (int i = -1; i < height_ + kSquare; ++i) rows.push_back(row(i));
}

RayDirections RayDirections::OfPanorama(const EquirectangularCamera& camera,
                                        const Eigen::Quaterniond& world_from_camera,
                                        Pattern pattern) {
  // A bearing is cos(latitude) times the bearing at its longitude on the horizon, plus
  // sin(latitude) times the upward axis. This also holds beyond the poles.
  RayDirections rays(camera.width(), camera.height(), false);
  rays.upward_ = (world_from_camera * Eigen::Vector3d::UnitZ()).cast<float>();
  for (const auto& [x, y] : pattern) {
    rays.AddSample(
        [&, x = x](int column) -> Eigen::Vector3d {
          return world_from_camera * camera.Bearing({column + x, camera.cy()});
        },
        [&, y = y](int row) {
          const Eigen::Vector3d bearing = camera.Bearing({camera.cx(), row + y});
          return Row{static_cast<float>(-bearing.x()), static_cast<float>(bearing.z())};
        });
  }
  return rays;
}

RayDirections RayDirections::OfCubeFace(int size, const Eigen::Quaterniond& world_from_face,
                                        Pattern pattern) {
  RayDirections rays(size, size, true);
  rays.upward_ = (world_from_face * Eigen::Vector3d::UnitZ()).cast<float>();
  for (const auto& [x, y] : pattern) {
    rays.AddSample(
        [&, x = x](int column) -> Eigen::Vector3d {
          return world_from_face * Eigen::Vector3d(-1, 2 * (column + x) / size - 1, 0);
        },
        [&, y = y](int row) {
          return Row{1, static_cast<float>(1 - 2 * (row + y) / size)};
        });
  }
  return rays;
}

void RayDirections::OfSquare(int left, int top, size_t sample, Lanes3* directions) const {
  using Four = Eigen::Array<float, kSquare, 1>;
  using All = Eigen::Array<float, kLanes, 1>;
  const Columns& columns = columns_[sample];
  for (int y = 0; y < kSquare; ++y) {
    const Row& row = rows_[sample][static_cast<size_t>(top + y + 1)];
    const auto fill = [&](const std::vector<float>& column, float upward, Lanes* lanes) {
      Eigen::Map<Four>(lanes->data() + kSquare * y) =
          row.along * Eigen::Map<const Four>(column.data() + left) + row.up * upward;
    };
    fill(columns.x, upward_.x(), &directions->x);
    fill(columns.y, upward_.y(), &directions->y);
    fill(columns.z, upward_.z(), &directions->z);
  }
  if (!normalizes_) return;
  Eigen::Map<All, Eigen::Aligned64> x(directions->x.data());
  Eigen::Map<All, Eigen::Aligned64> y(directions->y.data());
  Eigen::Map<All, Eigen::Aligned64> z(directions->z.data());
  const All length = (x * x + y * y + z * z).sqrt();
  x /= length;
  y /= length;
  z /= length;
}

}  // namespace orb360::town
