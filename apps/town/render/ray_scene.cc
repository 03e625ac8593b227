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

}  // namespace

RayScene::RayScene(const Town& town) : town_(&town), device_(rtcNewDevice("threads=1")) {
  ORB360_CHECK(device_.get() != nullptr, rtcGetDeviceError(nullptr));
  const auto parts_of = [&town](const Mesh& mesh) {
    return Parts{{{&town.materials, &mesh, 0}, {&town.materials, &mesh, mesh.opaque_count}}};
  };
  const auto new_scene = [this] {
    Scene scene(rtcNewScene(device_.get()));
    rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
    return scene;
  };
  fixed_scene_ = new_scene();
  fixed_parts_ = std::make_unique<Parts>(parts_of(town.fixed));
  AttachMesh(fixed_scene_.get(), *fixed_parts_);
  rtcCommitScene(fixed_scene_.get());
  instance_scene_ = new_scene();
  model_parts_.reserve(town.models.size());
  for (const Mesh& model : town.models) {
    model_parts_.push_back(parts_of(model));
    model_scenes_.push_back(new_scene());
    AttachMesh(model_scenes_.back().get(), model_parts_.back());
    rtcCommitScene(model_scenes_.back().get());
  }
  for (size_t i = 0; i < town.instances.size(); ++i) {
    const Instance& instance = town.instances[i];
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, model_scenes_[instance.model].get());
    const Eigen::Matrix<float, 3, 4> transform = instance.world_from_model.matrix().topRows<3>();
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, transform.data());
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(instance_scene_.get(), geometry, static_cast<unsigned>(i));
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(instance_scene_.get());
  ORB360_CHECK(rtcGetDeviceError(device_.get()) == RTC_ERROR_NONE);
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
    const Material& material = (*part.materials)[triangle.material];
    const float coverage = part.materials->textures[material.texture].Coverage(
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
  alignas(64) std::array<int, kPacket> open;
  bool any_open = false;
  for (int lane = 0; lane < kPacket; ++lane) {
    const bool is_open = valid[lane] != 0 && rays->tfar[lane] >= 0;
    open[static_cast<size_t>(lane)] = is_open ? -1 : 0;
    any_open |= is_open;
  }
  if (!any_open) return;
  RTCIntersectContext spread = MakeContext(Coherence::kSpread);
  rtcOccluded16(open.data(), instance_scene_.get(), &spread, rays);
}

void RayScene::OccludedByModel(uint32_t model, const int* valid, RTCRay16* rays) const {
  RTCIntersectContext context = MakeContext(Coherence::kSpread);
  rtcOccluded16(valid, model_scenes_[model].get(), &context, rays);
}

SurfaceHit RayScene::Resolve(const RTCHit16& hit, int lane) const {
  const unsigned instance_id = hit.instID[0][lane];
  const Instance* instance = nullptr;
  const Parts* parts = fixed_parts_.get();
  if (instance_id != RTC_INVALID_GEOMETRY_ID) {
    instance = &town_->instances[instance_id];
    parts = &model_parts_[instance->model];
  }
  const Part& part = (*parts)[hit.geomID[lane]];
  return {part.mesh, instance, &part.mesh->triangles[part.first + hit.primID[lane]]};
}

}  // namespace orb360::town
