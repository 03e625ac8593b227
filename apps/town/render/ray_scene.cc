#include "apps/town/render/ray_scene.h"

#include <algorithm>

#include "slam/check.h"

namespace orb360::town {
namespace {

RTCIntersectContext MakeContext(Coherence coherence) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = coherence == Coherence::kTogether ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                                    : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

/// Occlusion of the lanes that are still open.
void OccludedByInstances(RTCScene scene, const int* valid, RTCRay16* rays) {
  alignas(64) std::array<int, kPacket> open;
  bool any_open = false;
  for (int lane = 0; lane < kPacket; ++lane) {
    const bool is_open = valid[lane] != 0 && rays->tfar[lane] >= 0;
    open[static_cast<size_t>(lane)] = is_open ? -1 : 0;
    any_open |= is_open;
  }
  if (!any_open) return;
  RTCIntersectContext context = MakeContext(Coherence::kSpread);
  rtcOccluded16(open.data(), scene, &context, rays);
}

}  // namespace

RayScene::RayScene(const Scenery& scenery)
    : scenery_(&scenery), device_(rtcNewDevice("threads=1")) {
  ORB360_CHECK(device_.get() != nullptr, rtcGetDeviceError(nullptr));
  ORB360_CHECK(scenery.instances.size() < 60000, scenery.instances.size());  // masks have 16 bits
  const auto parts_of = [&scenery](const Mesh& mesh) {
    return Parts{{{&scenery.palette, &mesh, 0}, {&scenery.palette, &mesh, mesh.opaque_count}}};
  };
  fixed_scene_ = NewScene(RTC_BUILD_QUALITY_HIGH);
  fixed_parts_ = std::make_unique<Parts>(parts_of(scenery.fixed));
  AttachMesh(fixed_scene_.get(), *fixed_parts_);
  rtcCommitScene(fixed_scene_.get());
  for (const Mesh& model : scenery.models) {
    model_parts_.push_back(parts_of(model));
    model_scenes_.push_back(NewScene(RTC_BUILD_QUALITY_HIGH));
    AttachMesh(model_scenes_.back().get(), model_parts_.back());
    rtcCommitScene(model_scenes_.back().get());
  }
  instance_scene_ = MakeInstanceScene(scenery.instances, 0, RTC_BUILD_QUALITY_HIGH);
  ORB360_CHECK(rtcGetDeviceError(device_.get()) == RTC_ERROR_NONE);
}

Scene RayScene::NewScene(RTCBuildQuality quality) const {
  Scene scene(rtcNewScene(device_.get()));
  rtcSetSceneBuildQuality(scene.get(), quality);
  return scene;
}

Scene RayScene::MakeInstanceScene(std::span<const Instance> instances, size_t first_id,
                                  RTCBuildQuality quality) const {
  Scene scene = NewScene(quality);
  for (size_t i = 0; i < instances.size(); ++i) {
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, model_scenes_[instances[i].model].get());
    const Eigen::Matrix<float, 3, 4> transform =
        instances[i].world_from_model.matrix().topRows<3>();
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, transform.data());
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene.get(), geometry, static_cast<unsigned>(first_id + i));
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene.get());
  return scene;
}

void RayScene::AttachMesh(RTCScene scene, const Parts& parts) const {
  const Mesh& mesh = *parts[0].mesh;
  const std::array<size_t, 3> bounds = {0, mesh.opaque_count, mesh.triangles.size()};
  for (unsigned part = 0; part < 2; ++part) {
    const size_t count = bounds[part + 1] - bounds[part];
    if (count == 0) continue;
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* positions = static_cast<Vector3f*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(Vector3f), mesh.positions.size()));
    std::copy(mesh.positions.begin(), mesh.positions.end(), positions);
    auto* indices = static_cast<std::array<uint32_t, 3>*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), count));
    for (size_t i = 0; i < count; ++i) indices[i] = mesh.triangles[bounds[part] + i].vertices;
    if (part == 1) {
      rtcSetGeometryUserData(geometry, const_cast<Part*>(&parts[1]));
      rtcSetGeometryIntersectFilterFunction(geometry, &RayScene::RejectCutouts);
      rtcSetGeometryOccludedFilterFunction(geometry, &RayScene::RejectCutouts);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, part);
    rtcReleaseGeometry(geometry);
  }
}

void RayScene::RejectCutouts(const RTCFilterFunctionNArguments* arguments) {
  const auto& part = *static_cast<const Part*>(arguments->geometryUserPtr);
  const unsigned count = arguments->N;
  for (unsigned i = 0; i < count; ++i) {
    if (arguments->valid[i] != -1) continue;
    const Triangle& triangle =
        part.mesh->triangles[part.first + RTCHitN_primID(arguments->hit, count, i)];
    const float u = RTCHitN_u(arguments->hit, count, i);
    const float v = RTCHitN_v(arguments->hit, count, i);
    const Vertex& a = part.mesh->vertices[triangle.vertices[0]];
    const Vertex& b = part.mesh->vertices[triangle.vertices[1]];
    const Vertex& c = part.mesh->vertices[triangle.vertices[2]];
    const Material& material = (*part.palette)[triangle.material];
    const float coverage = part.palette->textures[material.texture].Coverage(
        (1 - u - v) * a.u + u * b.u + v * c.u, (1 - u - v) * a.v + u * b.v + v * c.v);
    if (coverage < 0.5F) arguments->valid[i] = 0;
  }
}

void RayScene::Intersect(const int* valid, RTCRayHit16* rays) const {
  RTCIntersectContext together = MakeContext(Coherence::kTogether);
  rtcIntersect16(valid, fixed_scene_.get(), &together, rays);
  RTCIntersectContext spread = MakeContext(Coherence::kSpread);
  rtcIntersect16(valid, instance_scene_.get(), &spread, rays);
}

void RayScene::Occluded(const int* valid, RTCRay16* rays, Coherence coherence) const {
  RTCIntersectContext context = MakeContext(coherence);
  rtcOccluded16(valid, fixed_scene_.get(), &context, rays);
  OccludedByInstances(instance_scene_.get(), valid, rays);
}

void RayScene::OccludedByModel(uint32_t model, const int* valid, RTCRay16* rays) const {
  RTCIntersectContext context = MakeContext(Coherence::kSpread);
  rtcOccluded16(valid, model_scenes_[model].get(), &context, rays);
}

FrameScene::FrameScene(const RayScene& fixed, std::vector<Instance> moving)
    : fixed_(&fixed), moving_(std::move(moving)) {
  if (moving_.empty()) return;
  moving_scene_ =
      fixed.MakeInstanceScene(moving_, fixed.scenery_->instances.size(), RTC_BUILD_QUALITY_LOW);
}

void FrameScene::Intersect(const int* valid, RTCRayHit16* rays) const {
  fixed_->Intersect(valid, rays);
  if (moving_.empty()) return;
  RTCIntersectContext context = MakeContext(Coherence::kSpread);
  rtcIntersect16(valid, moving_scene_.get(), &context, rays);
}

void FrameScene::Occluded(const int* valid, RTCRay16* rays) const {
  fixed_->Occluded(valid, rays);
  if (!moving_.empty()) OccludedByInstances(moving_scene_.get(), valid, rays);
}

SurfaceHit FrameScene::Resolve(const RTCHit16& hit, int lane) const {
  const size_t id = hit.instID[0][lane];
  const Instance* instance = nullptr;
  const RayScene::Parts* parts = fixed_->fixed_parts_.get();
  if (hit.instID[0][lane] != RTC_INVALID_GEOMETRY_ID) {
    const std::vector<Instance>& fixed = fixed_->scenery_->instances;
    instance = id < fixed.size() ? &fixed[id] : &moving_[id - fixed.size()];
    parts = &fixed_->model_parts_[instance->model];
  }
  const RayScene::Part& part = (*parts)[hit.geomID[lane]];
  return {part.mesh, instance, &part.mesh->triangles[part.first + hit.primID[lane]]};
}

uint16_t FrameScene::ObjectId(const RTCHit16& hit, int lane) const {
  if (hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) return kNothing;
  if (hit.instID[0][lane] == RTC_INVALID_GEOMETRY_ID) return kFixed;
  return static_cast<uint16_t>(kFixed + 1 + hit.instID[0][lane]);
}

uint16_t FrameScene::first_moving_id() const {
  return static_cast<uint16_t>(kFixed + 1 + fixed_->scenery_->instances.size());
}

}  // namespace orb360::town
