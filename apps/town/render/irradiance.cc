#include "apps/town/render/irradiance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "apps/town/render/lookout.h"

namespace orb360::town {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kFar = 200;            // metres
constexpr float kFinest = 0.04F;       // metres; nearer vertices with one normal share their light
constexpr int kLampSamples = 2;        // along each side
constexpr int kWindowSamples = 3;      // likewise; windows are larger and their light is sharper
constexpr int kFirstDirections = 32;   // of the first reflection
constexpr int kSecondDirections = 64;  // of the second
constexpr int kRounds = 3;             // of Spread: it reaches so many edges
constexpr float kNegligible = 3e-4F;   // of the light of one lamp; lamps give a floor 0.03 or more

/// A place at which light is computed.
struct Place {
  Vector3f point;
  Vector3f normal;
};

struct Places {
  std::vector<Place> all;
  std::vector<uint32_t> of_vertex;  // the place of each
};

/// Returns the places of a mesh. Each lies slightly off its surface and towards the inside of the
/// triangles around it, so that it is not in the wall next to it.
Places FindPlaces(const Mesh& mesh) {
  constexpr float kInward = 0.06F;  // metres
  constexpr float kOff = 0.015F;    // metres
  using Key = std::array<int, 6>;
  std::vector<std::pair<Key, uint32_t>> order;
  order.reserve(mesh.positions.size());
  for (uint32_t i = 0; i < mesh.positions.size(); ++i) {
    const Eigen::Vector3i cell = (mesh.positions[i] / kFinest).array().round().cast<int>();
    const auto& n = mesh.vertices[i].normal;
    order.push_back({{cell.x(), cell.y(), cell.z(), n.x(), n.y(), n.z()}, i});
  }
  std::sort(order.begin(), order.end());
  Places places;
  places.of_vertex.resize(mesh.positions.size());
  for (size_t i = 0; i < order.size(); ++i) {
    const uint32_t vertex = order[i].second;
    if (i == 0 || order[i].first != order[i - 1].first) {
      places.all.push_back(
          {mesh.positions[vertex], mesh.vertices[vertex].normal.cast<float>().normalized()});
    }
    places.of_vertex[vertex] = static_cast<uint32_t>(places.all.size() - 1);
  }
  std::vector<Vector3f> inward(places.all.size(), Vector3f::Zero());
  std::vector<float> shortest(places.all.size(), kInward / 0.3F);
  for (const Triangle& triangle : mesh.triangles) {
    const auto& [a, b, c] = triangle.vertices;
    const Vector3f centre = (mesh.positions[a] + mesh.positions[b] + mesh.positions[c]) / 3;
    for (const uint32_t vertex : triangle.vertices) {
      const uint32_t place = places.of_vertex[vertex];
      const Vector3f way = centre - mesh.positions[vertex];
      inward[place] += way.normalized();
      shortest[place] = std::min(shortest[place], way.norm());
    }
  }
  for (size_t i = 0; i < places.all.size(); ++i) {
    constexpr float kOneSided = 0.4F;  // sums of unit vectors all around are shorter
    Place& place = places.all[i];
    place.point += kOff * place.normal;
    if (inward[i].norm() > kOneSided) place.point += 0.3F * shortest[i] * inward[i].normalized();
  }
  return places;
}

/// Shadow rays whose contributions are summed where nothing is in the way.
class ShadowSum {
 public:
  explicit ShadowSum(const RayScene& scene) : scene_(&scene) {}

  void Add(const Vector3f& from, const Vector3f& way, const Vector3f& light) {
    SetRay(rays_, count_, from, way, 0.999F);
    light_[static_cast<size_t>(count_)] = light;
    if (++count_ == kPacket) Trace();
  }
  const Vector3f& Finish() {
    if (count_ > 0) Trace();
    return sum_;
  }

 private:
  void Trace() {
    alignas(64) std::array<int, kPacket> valid;
    for (int lane = 0; lane < kPacket; ++lane) {
      valid[static_cast<size_t>(lane)] = lane < count_ ? -1 : 0;
      if (lane >= count_) SetRay(rays_, lane, Vector3f::Zero(), Vector3f::UnitZ(), -1);
    }
    scene_->Occluded(valid.data(), &rays_, Coherence::kSpread);
    for (int lane = 0; lane < count_; ++lane) {
      if (rays_.tfar[lane] >= 0) sum_ += light_[static_cast<size_t>(lane)];
    }
    count_ = 0;
  }

  const RayScene* scene_;
  RTCRay16 rays_;
  std::array<Vector3f, kPacket> light_;
  int count_ = 0;
  Vector3f sum_ = Vector3f::Zero();
};

/// Returns what lies beyond a window in a direction, without detail.
Vector3f Outside(const Light& light, const Vector3f& direction) {
  const float up = std::clamp(4 * direction.z() + 0.5F, 0.0F, 1.0F);
  const Vector3f sky =
      light.horizon + std::max(direction.z(), 0.0F) * (light.zenith - light.horizon);
  return (1 - up) * light.ground + up * sky;
}

/// Returns the light of all lamps at a place, over pi.
Vector3f DirectLight(const RayScene& scene, const Light& light, const std::vector<Lamp>& lamps,
                     const Place& place) {
  ShadowSum sum(scene);
  for (const Lamp& lamp : lamps) {
    const Vector3f across = lamp.first_side.cross(lamp.second_side);
    const float area = across.norm();
    const Vector3f facing = across / area;
    const Vector3f to_centre = lamp.Centre() - place.point;
    const float extent = (lamp.first_side.norm() + lamp.second_side.norm()) / 2;
    if (-facing.dot(to_centre) < -1e-3F || place.normal.dot(to_centre) < -extent) continue;
    const float brightness =
        lamp.is_window ? (light.horizon + light.ground).maxCoeff() : lamp.radiance.maxCoeff();
    const int along = lamp.is_window ? kWindowSamples : kLampSamples;
    const float piece = area / static_cast<float>(along * along);
    if (brightness * area / (kPi * to_centre.squaredNorm() + area) < kNegligible) continue;
    for (int i = 0; i < along; ++i) {
      for (int k = 0; k < along; ++k) {
        const auto part = static_cast<float>(along);
        const Vector3f at = lamp.corner + (static_cast<float>(i) + 0.5F) / part * lamp.first_side +
                            (static_cast<float>(k) + 0.5F) / part * lamp.second_side;
        const Vector3f way = at - place.point;
        const float distance = way.norm();
        const float here = place.normal.dot(way) / distance;
        const float there = -facing.dot(way) / distance;
        if (here <= 0 || there <= 0) continue;
        // A disc of the piece's area, seen along its axis, has exactly this form factor.
        const float form = here * there * piece / (kPi * distance * distance + piece);
        const Vector3f radiance = lamp.is_window ? Outside(light, way / distance) : lamp.radiance;
        sum.Add(place.point, way, form * radiance);
      }
    }
  }
  return sum.Finish();
}

Vector3f SunLight(const RayScene& scene, const Light& light, const Place& place) {
  const float cosine = place.normal.dot(light.to_sun);
  if (cosine <= 0 || light.sun.maxCoeff() <= 0) return Vector3f::Zero();
  ShadowSum sum(scene);
  sum.Add(place.point, 1000 * light.to_sun, cosine * light.sun);
  return sum.Finish();
}

/// What surfaces throw back: the mean colour of each material, and the light at each vertex.
struct Surfaces {
  const Mesh* mesh;
  std::vector<Vector3f> albedo;  // by material; black for lamps, whose light comes directly
  std::vector<Vector3f> light;   // by vertex, times its tint

  Vector3f Radiance(const Triangle& triangle, float b, float c) const {
    return albedo[triangle.material].cwiseProduct((1 - b - c) * light[triangle.vertices[0]] +
                                                  b * light[triangle.vertices[1]] +
                                                  c * light[triangle.vertices[2]]);
  }
};

std::vector<Vector3f> MeanColours(const Palette& palette) {
  std::vector<Vector3f> colours;
  for (const Material& material : palette.all) {
    const Rgba mean = palette.textures[material.texture].Sample(0, 0, 30);
    colours.push_back(material.finish == Finish::kLamp ? Vector3f(Vector3f::Zero())
                                                       : Vector3f(mean.r, mean.g, mean.b));
  }
  return colours;
}

void SetLight(const Places& places, const std::vector<Vector3f>& light, Surfaces* surfaces) {
  for (uint32_t i = 0; i < places.of_vertex.size(); ++i) {
    const auto& tint = surfaces->mesh->vertices[i].tint;
    const Vector3f root = Vector3f(tint[0], tint[1], tint[2]) / 255;
    surfaces->light[i] = root.cwiseProduct(root).cwiseProduct(light[places.of_vertex[i]]);
  }
}

/// What a place sees around it.
struct Surround {
  Vector3f light = Vector3f::Zero();  ///< thrown back to it, over pi
  bool is_buried = false;             ///< it lies in something solid: it sees backs of faces
};

Surround LookAround(const FrameScene& scene, const Surfaces& surfaces,
                    const std::vector<Vector3f>& pattern, const Place& place) {
  constexpr size_t kBuried = 4;  // buried if more than a quarter of the rays hit backs
  const Vector3f x = place.normal.unitOrthogonal();
  const Vector3f y = place.normal.cross(x);
  Surround surround;
  size_t backs = 0;
  for (size_t first = 0; first < pattern.size(); first += kPacket) {
    RTCRayHit16 rays;
    alignas(64) std::array<int, kPacket> valid;
    valid.fill(-1);
    std::array<Vector3f, kPacket> directions;
    for (int lane = 0; lane < kPacket; ++lane) {
      const Vector3f& d = pattern[first + static_cast<size_t>(lane)];
      directions[static_cast<size_t>(lane)] = d.x() * x + d.y() * y + d.z() * place.normal;
      SetRay(rays.ray, lane, place.point, directions[static_cast<size_t>(lane)], kFar);
      rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    scene.Intersect(valid.data(), &rays);
    for (int lane = 0; lane < kPacket; ++lane) {
      if (rays.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
      const SurfaceHit hit = scene.Resolve(rays.hit, lane);
      if (hit.mesh != surfaces.mesh || hit.instance != nullptr) continue;
      const auto& normal = hit.mesh->vertices[hit.triangle->vertices[0]].normal;
      if (normal.cast<float>().dot(directions[static_cast<size_t>(lane)]) > 0)
        ++backs;
      else
        surround.light += surfaces.Radiance(*hit.triangle, rays.hit.u[lane], rays.hit.v[lane]);
    }
  }
  surround.light /= static_cast<float>(pattern.size());
  surround.is_buried = kBuried * backs > pattern.size();
  return surround;
}

/// Passes light on between places that a triangle joins: buried ones take that of their neighbours,
/// round by round; the others are smoothed half way towards them if `smooths`.
void Spread(const Mesh& mesh, const Places& places, std::vector<uint8_t> is_buried, int rounds,
            bool smooths, std::vector<Vector3f>* light) {
  std::vector<Vector3f> sums(light->size());
  std::vector<int> counts(light->size());
  for (int round = 0; round < rounds; ++round) {
    std::fill(sums.begin(), sums.end(), Vector3f::Zero());
    std::fill(counts.begin(), counts.end(), 0);
    for (const Triangle& triangle : mesh.triangles) {
      for (size_t corner = 0; corner < 3; ++corner) {
        const uint32_t from = places.of_vertex[triangle.vertices[corner]];
        const uint32_t to = places.of_vertex[triangle.vertices[(corner + 1) % 3]];
        for (const auto& [a, b] : {std::pair(from, to), std::pair(to, from)}) {
          if (is_buried[a] != 0) continue;
          sums[b] += (*light)[a];
          ++counts[b];
        }
      }
    }
    for (size_t i = 0; i < light->size(); ++i) {
      if (counts[i] == 0) continue;
      const Vector3f mean = sums[i] / static_cast<float>(counts[i]);
      if (is_buried[i] != 0)
        (*light)[i] = mean;
      else if (smooths)
        (*light)[i] = 0.5F * ((*light)[i] + mean);
      is_buried[i] = 0;
    }
  }
}

/// Lets the faces of lamps shine with the radiance of the lamp next to them.
void LightLamps(const Scenery& scenery, Mesh* mesh) {
  for (const Triangle& triangle : mesh->triangles) {
    if (scenery.palette[triangle.material].finish != Finish::kLamp) continue;
    for (const uint32_t vertex : triangle.vertices) {
      float nearest = 1;  // metres; lamps farther away are not its own
      mesh->irradiance[vertex].setZero();
      for (const Lamp& lamp : scenery.lamps) {
        const float distance = (lamp.Centre() - mesh->positions[vertex]).norm();
        if (lamp.is_window || distance >= nearest) continue;
        nearest = distance;
        mesh->irradiance[vertex] = lamp.radiance;
      }
    }
  }
}

}  // namespace

void BakeIrradiance(const RayScene& scene, const Light& light, Scenery* scenery) {
  Mesh& mesh = scenery->fixed;
  const Places places = FindPlaces(mesh);
  const FrameScene still(scene, {});
  const size_t count = places.all.size();
  std::vector<Vector3f> direct(count);
  std::vector<Vector3f> sunlit(count);
#pragma omp parallel for schedule(dynamic, 64)
  for (size_t i = 0; i < count; ++i) {
    direct[i] = DirectLight(scene, light, scenery->lamps, places.all[i]);
    sunlit[i] = direct[i] + SunLight(scene, light, places.all[i]);
  }
  Surfaces surfaces{&mesh, MeanColours(scenery->palette),
                    std::vector<Vector3f>(mesh.vertices.size())};
  SetLight(places, sunlit, &surfaces);
  std::vector<Vector3f> reflected(count);
  std::vector<uint8_t> is_buried(count);
  for (const int directions : {kFirstDirections, kSecondDirections}) {
    const std::vector<Vector3f> pattern = CosineDirections(directions);
#pragma omp parallel for schedule(dynamic, 64)
    for (size_t i = 0; i < count; ++i) {
      const Surround surround = LookAround(still, surfaces, pattern, places.all[i]);
      reflected[i] = surround.light;
      is_buried[i] = surround.is_buried ? 1 : 0;
    }
    Spread(mesh, places, is_buried, kRounds, true, &reflected);
    std::vector<Vector3f> all = sunlit;
    Spread(mesh, places, is_buried, kRounds, false, &all);
    for (size_t i = 0; i < count; ++i) all[i] += reflected[i];
    SetLight(places, all, &surfaces);
  }
  Spread(mesh, places, is_buried, kRounds, false, &direct);
  mesh.irradiance.resize(mesh.vertices.size());
  for (uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    const uint32_t place = places.of_vertex[i];
    mesh.irradiance[i] = direct[place] + reflected[place];
  }
  LightLamps(*scenery, &mesh);
}

}  // namespace orb360::town
