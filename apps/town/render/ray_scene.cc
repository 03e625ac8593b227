#include "apps/town/render/ray_scene.h"

#include <algorithm>

#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

RTCIntersectContext MakeContext(Coherence coherence) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = coherence == Coherence::kTogether ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                                    : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

}  // namespace

RayScene::RayScene(const Scenery& scenery)
    : scenery_(&scenery), device_(rtcNewDevice("threads=1")) {
  ORB360_CHECK(device_.get() != nullptr, rtcGetDeviceError(nullptr));
  ORB360_CHECK(scenery.instances.size() < 60000, scenery.instances.size());  // masks have 16 bits
  const auto collect_cutouts = [&](const Mesh& mesh) {
    std::vector<Cutout>& cutouts = cutouts_[&mesh];
    for (size_t i = mesh.opaque_count; i < mesh.triangles.size(); ++i) {
      const Triangle& triangle = mesh.triangles[i];
      const auto uv = [&](size_t corner) {
        const Vertex& vertex = mesh.vertices[triangle.vertices[corner]];
        return Vector2f(vertex.u, vertex.v);
      };
      cutouts.push_back({uv(0), uv(1) - uv(0), uv(2) - uv(0),
                         &scenery.palette.textures[scenery.palette[triangle.material].texture]});
    }
  };
  collect_cutouts(scenery.fixed);
  for (const Mesh& model : scenery.models) {
    collect_cutouts(model);
    model_scenes_.push_back(NewScene(RTC_BUILD_QUALITY_HIGH));
    Attach(model_scenes_.back().get(), 0, {&model, nullptr});
    rtcCommitScene(model_scenes_.back().get());
  }
  placed_.push_back({&scenery.fixed, nullptr});
  for (const Instance& instance : scenery.instances)
    placed_.push_back({&scenery.models[instance.model], &instance});
  fixed_scene_ = NewScene(RTC_BUILD_QUALITY_HIGH);
  for (size_t i = 0; i < placed_.size(); ++i) Attach(fixed_scene_.get(), i, placed_[i]);
  rtcCommitScene(fixed_scene_.get());
  ORB360_CHECK(rtcGetDeviceError(device_.get()) == RTC_ERROR_NONE);
}

Scene RayScene::NewScene(RTCBuildQuality quality) const {
  Scene scene(rtcNewScene(device_.get()));
  rtcSetSceneBuildQuality(scene.get(), quality);
  return scene;
}

Scene RayScene::MakeInstanceScene(std::span<const Instance> instances) const {
  Scene scene = NewScene(RTC_BUILD_QUALITY_LOW);
  for (size_t i = 0; i < instances.size(); ++i) {
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, model_scenes_[instances[i].model].get());
    const Eigen::Matrix<float, 3, 4> transform =
        instances[i].world_from_model.matrix().topRows<3>();
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, transform.data());
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene.get(), geometry, static_cast<unsigned>(i));
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene.get());
  return scene;
}

void RayScene::Attach(RTCScene scene, size_t index, const Placed& placed) const {
  const Mesh& mesh = *placed.mesh;
  const Eigen::Isometry3f world_from_mesh = placed.instance != nullptr
                                                ? placed.instance->world_from_model
                                                : Eigen::Isometry3f::Identity();
  const std::array<size_t, 3> bounds = {0, mesh.opaque_count, mesh.triangles.size()};
  for (size_t part = 0; part < 2; ++part) {
    const size_t count = bounds[part + 1] - bounds[part];
    if (count == 0) continue;
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* positions = static_cast<Vector3f*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(Vector3f), mesh.positions.size()));
    std::transform(mesh.positions.begin(), mesh.positions.end(), positions,
                   [&](const Vector3f& p) -> Vector3f { return world_from_mesh * p; });
    auto* indices = static_cast<std::array<uint32_t, 3>*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), count));
    for (size_t i = 0; i < count; ++i) indices[i] = mesh.triangles[bounds[part] + i].vertices;
    if (part == 1) {
      rtcSetGeometryUserData(geometry, const_cast<Cutout*>(cutouts_.at(&mesh).data()));
      rtcSetGeometryIntersectFilterFunction(geometry, &RayScene::RejectCutouts);
      rtcSetGeometryOccludedFilterFunction(geometry, &RayScene::RejectCutouts);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, static_cast<unsigned>(2 * index + part));
    rtcReleaseGeometry(geometry);
  }
}

void RayScene::RejectCutouts(const RTCFilterFunctionNArguments* arguments) {
  const auto* cutouts = static_cast<const Cutout*>(arguments->geometryUserPtr);
  const unsigned count = arguments->N;
  for (unsigned i = 0; i < count; ++i) {
    if (arguments->valid[i] != -1) continue;
    const Cutout& cutout = cutouts[RTCHitN_primID(arguments->hit, count, i)];
    const Vector2f uv = cutout.uv + RTCHitN_u(arguments->hit, count, i) * cutout.to_second +
                        RTCHitN_v(arguments->hit, count, i) * cutout.to_third;
    if (!cutout.texture->Covers(uv.x(), uv.y())) arguments->valid[i] = 0;
  }
}

void RayScene::Intersect(const int* valid, RTCRayHit16* rays) const {
  RTCIntersectContext context = MakeContext(Coherence::kTogether);
  rtcIntersect16(valid, fixed_scene_.get(), &context, rays);
}

void RayScene::Occluded(const int* valid, RTCRay16* rays, Coherence coherence) const {
  RTCIntersectContext context = MakeContext(coherence);
  rtcOccluded16(valid, fixed_scene_.get(), &context, rays);
}

void RayScene::OccludedByModel(uint32_t model, const int* valid, RTCRay16* rays) const {
  RTCIntersectContext context = MakeContext(Coherence::kSpread);
  rtcOccluded16(valid, model_scenes_[model].get(), &context, rays);
}

float DistanceAlong(const RayScene& scene, const Vector3f& origin, const Vector3f& direction,
                    float far) {
  RTCRayHit16 rays{};
  // Where vectors are shorter than a packet, Embree traces all lanes with tnear <= tfar, whatever
  // `valid` says.
  std::ranges::fill(rays.ray.tfar, -1.0F);
  alignas(64) std::array<int, kPacket> valid{};
  valid[0] = -1;
  SetRay(rays.ray, 0, origin, direction, far);
  rays.hit.geomID[0] = RTC_INVALID_GEOMETRY_ID;
  scene.Intersect(valid.data(), &rays);
  return rays.ray.tfar[0];
}

FrameScene::FrameScene(const RayScene& fixed, std::vector<Instance> moving)
    : fixed_(&fixed), moving_(std::move(moving)) {
  if (!moving_.empty()) moving_scene_ = fixed.MakeInstanceScene(moving_);
}

void FrameScene::Intersect(const int* valid, RTCRayHit16* rays) const {
  fixed_->Intersect(valid, rays);
  if (moving_.empty()) return;
  RTCIntersectContext context = MakeContext(Coherence::kSpread);
  rtcIntersect16(valid, moving_scene_.get(), &context, rays);
}

void FrameScene::Occluded(const int* valid, RTCRay16* rays) const {
  fixed_->Occluded(valid, rays);
  if (moving_.empty()) return;
  alignas(64) std::array<int, kPacket> open;
  bool any_open = false;
  for (int lane = 0; lane < kPacket; ++lane) {
    const bool is_open = valid[lane] != 0 && rays->tfar[lane] >= 0;
    open[static_cast<size_t>(lane)] = is_open ? -1 : 0;
    any_open |= is_open;
  }
  if (!any_open) return;
  RTCIntersectContext context = MakeContext(Coherence::kSpread);
  rtcOccluded16(open.data(), moving_scene_.get(), &context, rays);
}

SurfaceHit FrameScene::Resolve(const RTCHit16& hit, int lane) const {
  const unsigned moving = hit.instID[0][lane];
  const RayScene::Placed placed =
      moving == RTC_INVALID_GEOMETRY_ID
          ? fixed_->placed_[hit.geomID[lane] / 2]
          : RayScene::Placed{&fixed_->scenery_->models[moving_[moving].model], &moving_[moving]};
  const size_t first = hit.geomID[lane] % 2 == 0 ? 0 : placed.mesh->opaque_count;
  return {placed.mesh, placed.instance, &placed.mesh->triangles[first + hit.primID[lane]]};
}

Vector3f FrameScene::GeometricNormal(const RTCHit16& hit, int lane) const {
  Vector3f normal(hit.Ng_x[lane], hit.Ng_y[lane], hit.Ng_z[lane]);
  const unsigned moving = hit.instID[0][lane];
  if (moving == RTC_INVALID_GEOMETRY_ID) return normal;
  return moving_[moving].world_from_model.linear() * normal;
}

uint16_t FrameScene::ObjectId(const RTCHit16& hit, int lane) const {
  if (hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) return kNothing;
  const unsigned moving = hit.instID[0][lane];
  return static_cast<uint16_t>(moving == RTC_INVALID_GEOMETRY_ID ? kFixed + hit.geomID[lane] / 2
                                                                 : first_moving_id() + moving);
}

uint16_t FrameScene::first_moving_id() const {
  return static_cast<uint16_t>(kFixed + fixed_->placed_.size());
}

}  // namespace orb360::town
