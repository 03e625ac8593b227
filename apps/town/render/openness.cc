#include "apps/town/render/openness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "apps/town/render/lookout.h"

namespace orb360::town {
namespace {

constexpr int kDirections = 2 * kPacket;
constexpr float kFar = 120;  // metres; what is farther away takes next to nothing of the sky

/// Returns the fraction of the directions about `normal` in which `occluded` finds nothing.
template <typename Occluded>
float Openness(const Vector3f& point, const Vector3f& normal, const Occluded& occluded) {
  static const std::vector<Vector3f> kPattern = CosineDirections(kDirections);
  const Vector3f x = normal.unitOrthogonal();
  const Vector3f y = normal.cross(x);
  int open = 0;
  for (int first = 0; first < kDirections; first += kPacket) {
    RTCRay16 rays;
    alignas(64) std::array<int, kPacket> valid;
    valid.fill(-1);
    for (int lane = 0; lane < kPacket; ++lane) {
      const Vector3f& d = kPattern[static_cast<size_t>(first + lane)];
      SetRay(rays, lane, point, d.x() * x + d.y() * y + d.z() * normal, kFar);
    }
    occluded(valid.data(), &rays);
    for (int lane = 0; lane < kPacket; ++lane) open += rays.tfar[lane] >= 0 ? 1 : 0;
  }
  return static_cast<float>(open) / kDirections;
}

template <typename Occluded>
void BakeMesh(const Occluded& occluded, Mesh* mesh) {
  const std::vector<Vector3f> points = LookoutPoints(*mesh);
  // Neighbouring faces repeat their corners, so each place is examined once, to a quarter of a
  // metre.
  using Key = std::array<int, 6>;
  const auto key = [&](uint32_t i) -> Key {
    const Eigen::Vector3i place = (points[i] * 4).array().round().cast<int>();
    const auto& n = mesh->vertices[i].normal;
    return {place.x(), place.y(), place.z(), n.x(), n.y(), n.z()};
  };
  std::vector<std::pair<Key, uint32_t>> order;
  order.reserve(points.size());
  for (uint32_t i = 0; i < points.size(); ++i) order.emplace_back(key(i), i);
  std::sort(order.begin(), order.end());
  std::vector<size_t> starts;
  for (size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || order[i].first != order[i - 1].first) starts.push_back(i);
  }
#pragma omp parallel for schedule(dynamic, 64)
  for (size_t k = 0; k < starts.size(); ++k) {
    const uint32_t first = order[starts[k]].second;
    const Vector3f normal = mesh->vertices[first].normal.cast<float>().normalized();
    const float openness = Openness(points[first], normal, occluded);
    const size_t end = k + 1 < starts.size() ? starts[k + 1] : order.size();
    for (size_t i = starts[k]; i < end; ++i)
      mesh->vertices[order[i].second].openness = static_cast<uint8_t>(std::lround(255 * openness));
  }
}

}  // namespace

void BakeOpenness(const RayScene& scene, Scenery* scenery) {
  if (scenery->fixed.irradiance.empty()) {
    BakeMesh(
        [&](const int* valid, RTCRay16* rays) { scene.Occluded(valid, rays, Coherence::kSpread); },
        &scenery->fixed);
  }
  for (uint32_t i = 0; i < scenery->models.size(); ++i) {
    const auto occluded = [&](const int* valid, RTCRay16* rays) {
      scene.OccludedByModel(i, valid, rays);
      for (int lane = 0; lane < kPacket; ++lane) {
        const bool meets_ground =
            rays->dir_z[lane] < 0 && -rays->org_z[lane] / rays->dir_z[lane] < kFar;
        if (meets_ground) rays->tfar[lane] = -1;
      }
    };
    BakeMesh(occluded, &scenery->models[i]);
  }
#pragma omp parallel for schedule(dynamic, 16)
  for (size_t i = 0; i < scenery->instances.size(); ++i) {
    Instance& instance = scenery->instances[i];
    // The point is above the instance itself, so that it does not shade itself twice.
    const Vector3f top = instance.world_from_model.translation() + Vector3f(0, 0, instance.lookout);
    instance.openness = Openness(top, Vector3f::UnitZ(), [&](const int* valid, RTCRay16* rays) {
      scene.Occluded(valid, rays, Coherence::kSpread);
    });
  }
}

}  // namespace orb360::town
