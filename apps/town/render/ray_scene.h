#pragma once

#include <array>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <embree3/rtcore.h>

#include "apps/town/world/scenery.h"

namespace orb360::town {

/// Whether the rays of a packet stay together (from one eye, or towards the sun) or diverge.
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

/// A handle of Embree that is released with its owner.
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

/// A scenery as ray-tracing structures. What stands still is one plain scene, which Embree
/// traverses by the packet (through instances it traverses ray by ray, half as fast). Each model
/// has a scene of its own, for instances that move. Keeps pointers to its input. Building uses one
/// thread, so that the structure (and the order in which surfaces at equal distances are found) is
/// always the same.
class RayScene {
 public:
  explicit RayScene(const Scenery& scenery);

  /// Finds the nearest hits of a packet; lanes with valid[i] == 0 are not changed.
  void Intersect(const int* valid, RTCRayHit16* rays) const;
  /// Sets tfar to -infinity in the lanes whose ray hits anything.
  void Occluded(const int* valid, RTCRay16* rays, Coherence coherence = Coherence::kTogether) const;
  /// As Occluded, for diverging rays in a model's own frame and with that model only.
  void OccludedByModel(uint32_t model, const int* valid, RTCRay16* rays) const;

 private:
  friend class FrameScene;

  /// A triangle that exists only where its texture does: the texture coordinates of the first
  /// corner, and the differences from there to the second and the third.
  struct Cutout {
    Vector2f uv;
    Vector2f to_second;
    Vector2f to_third;
    const Texture* texture;
  };
  /// A mesh at a place. Its opaque part and its part with cut-outs are two geometries.
  struct Placed {
    const Mesh* mesh;
    const Instance* instance;  // null for the fixed mesh, and for models in their own frame
  };

  Scene NewScene(RTCBuildQuality quality) const;
  /// Attaches the two parts as geometries 2 * index and 2 * index + 1.
  void Attach(RTCScene scene, size_t index, const Placed& placed) const;
  /// Returns a committed scene of instances.
  Scene MakeInstanceScene(std::span<const Instance> instances) const;
  static void RejectCutouts(const RTCFilterFunctionNArguments* arguments);

  const Scenery* scenery_;
  Device device_;
  std::map<const Mesh*, std::vector<Cutout>> cutouts_;  // by mesh; Embree holds the addresses
  std::vector<Placed> placed_;                          // in fixed_scene_, by geomID / 2
  std::vector<Scene> model_scenes_;
  Scene fixed_scene_;
};

/// Returns the distance to the nearest surface in a direction of any length, in units of that
/// length; at most `far`.
float DistanceAlong(const RayScene& scene, const Vector3f& origin, const Vector3f& direction,
                    float far);

/// The scenery together with the objects that move through it at one moment. The RayScene must
/// outlive it.
class FrameScene {
 public:
  FrameScene(const RayScene& fixed, std::vector<Instance> moving);

  /// See RayScene::Intersect.
  void Intersect(const int* valid, RTCRayHit16* rays) const;
  void Occluded(const int* valid, RTCRay16* rays) const;

  /// Returns the surface in one lane of a packet that has a hit (geomID is not invalid).
  SurfaceHit Resolve(const RTCHit16& hit, int lane) const;
  /// Returns its normal in the world, of any length.
  Vector3f GeometricNormal(const RTCHit16& hit, int lane) const;

  /// Numbers for masks: nothing, the fixed mesh, the scenery's instances, then the moving objects.
  static constexpr uint16_t kNothing = 0;
  static constexpr uint16_t kFixed = 1;
  uint16_t ObjectId(const RTCHit16& hit, int lane) const;
  /// Returns the first number of a moving object.
  uint16_t first_moving_id() const;

 private:
  const RayScene* fixed_;
  std::vector<Instance> moving_;
  Scene moving_scene_;  // empty where nothing moves
};

}  // namespace orb360::town
