#pragma once

#include <array>
#include <deque>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <embree3/rtcore.h>

#include "apps/town/world/scenery.h"

namespace orb360::town {

/// Whether the rays of a packet keep together (from one eye, towards the sun) or spread out.
enum class Coherence { kTogether, kSpread };

/// Number of rays traced together.
inline constexpr int kPacket = 16;

/// Fills one lane of a packet.
inline void SetRay(RTCRay16& rays, int lane, const Vector3f& origin, const Vector3f& direction,
                   float far) {
  rays.org_x[lane] = origin.x();
  rays.org_y[lane] = origin.y();
  rays.org_z[lane] = origin.z();
  rays.dir_x[lane] = direction.x();
  rays.dir_y[lane] = direction.y();
  rays.dir_z[lane] = direction.z();
  rays.tnear[lane] = 0;
  rays.tfar[lane] = far;
  rays.time[lane] = 0;
  rays.mask[lane] = ~0U;
  rays.id[lane] = 0;
  rays.flags[lane] = 0;
}

/// A handle of Embree's, released with its owner.
template <typename T, void (*Release)(T)>
class EmbreeHandle {
 public:
  EmbreeHandle() = default;
  explicit EmbreeHandle(T handle) : handle_(handle) {}
  EmbreeHandle(EmbreeHandle&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  EmbreeHandle& operator=(EmbreeHandle&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~EmbreeHandle() {
    if (handle_ != nullptr) Release(handle_);
  }
  T get() const { return handle_; }

 private:
  T handle_ = nullptr;
};
using Device = EmbreeHandle<RTCDevice, rtcReleaseDevice>;
using Scene = EmbreeHandle<RTCScene, rtcReleaseScene>;

/// What a ray hit: a triangle of a mesh, and the instance that placed the mesh, if any.
struct SurfaceHit {
  const Mesh* mesh;
  const Instance* instance;  ///< null for a mesh that is part of the world itself
  const Triangle* triangle;
};

/// The fixed mesh of a scenery and its instances of models as two ray-tracing structures. Keeps
/// pointers to what it was made from. Building uses one thread, so that the structure (and the
/// order in which surfaces at equal distances are found) is always the same.
///
/// Two, because Embree's frustum traversal of coherent packets is fast in plain meshes and very
/// slow through instances, which are traversed ray by ray.
class RayScene {
 public:
  explicit RayScene(const Scenery& scenery);

  /// Nearest hits of a packet; lanes with valid[i] == 0 are left alone.
  void Intersect(const int* valid, RTCRayHit16* rays) const;
  /// tfar becomes -infinity in the lanes whose ray meets anything.
  void Occluded(const int* valid, RTCRay16* rays, Coherence coherence = Coherence::kTogether) const;
  /// As Occluded, for spread rays in a model's own frame and with the model alone.
  void OccludedByModel(uint32_t model, const int* valid, RTCRay16* rays) const;

 private:
  friend class FrameScene;

  /// The triangles of a mesh from `first` on that are one geometry.
  struct Part {
    const Palette* palette;
    const Mesh* mesh;
    size_t first;
  };
  /// A mesh's opaque part and its part with cut-outs, by Embree's geomID.
  using Parts = std::array<Part, 2>;

  Scene NewScene(RTCBuildQuality quality) const;
  void AttachMesh(RTCScene scene, const Parts& parts) const;
  /// A committed scene of instances whose ids count from `first_id`.
  Scene MakeInstanceScene(std::span<const Instance> instances, size_t first_id,
                          RTCBuildQuality quality) const;
  static void RejectCutouts(const RTCFilterFunctionNArguments* arguments);

  const Scenery* scenery_;
  Device device_;
  std::unique_ptr<Parts> fixed_parts_;  // Embree holds the addresses
  std::deque<Parts> model_parts_;       // likewise
  std::vector<Scene> model_scenes_;
  Scene fixed_scene_;
  Scene instance_scene_;
};

/// The scenery together with what moves through it at one moment. The RayScene must outlive it.
class FrameScene {
 public:
  FrameScene(const RayScene& fixed, std::vector<Instance> moving);

  /// As RayScene's.
  void Intersect(const int* valid, RTCRayHit16* rays) const;
  void Occluded(const int* valid, RTCRay16* rays) const;

  /// The surface in one lane of a packet which hit (geomID is not invalid).
  SurfaceHit Resolve(const RTCHit16& hit, int lane) const;

  /// Numbers for masks: nothing, the fixed mesh, then the scenery's instances, then what moves.
  static constexpr uint16_t kNothing = 0;
  static constexpr uint16_t kFixed = 1;
  uint16_t ObjectId(const RTCHit16& hit, int lane) const;
  /// The first number of a moving object.
  uint16_t first_moving_id() const;

 private:
  const RayScene* fixed_;
  std::vector<Instance> moving_;
  Scene moving_scene_;  // empty where nothing moves
};

}  // namespace orb360::town
