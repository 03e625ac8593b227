#include "slam/depth/voxel_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <hwy/cache_control.h>

#include "nn/base/statistics.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

// A key contains three indices of 21 bits, each shifted to be positive. The highest bit is set, so
// that no key is 0.
constexpr int kIndexBits = 21;
constexpr std::int64_t kIndexOffset = std::int64_t{1} << (kIndexBits - 1);
constexpr std::uint64_t kIndexMask = (std::uint64_t{1} << kIndexBits) - 1;
constexpr std::uint64_t kUsed = std::uint64_t{1} << 63;
constexpr size_t kFirstCapacity = size_t{1} << 16;

std::uint64_t MakeKey(const std::array<std::int64_t, 3>& index) {
  std::uint64_t key = kUsed;
  for (int axis = 0; axis < 3; ++axis) {
    key |= static_cast<std::uint64_t>(index[static_cast<size_t>(axis)] + kIndexOffset)
           << (kIndexBits * axis);
  }
  return key;
}

Eigen::Vector3d CentreOf(std::uint64_t key) {
  Eigen::Vector3d centre;
  for (int axis = 0; axis < 3; ++axis) {
    const auto index = static_cast<std::int64_t>((key >> (kIndexBits * axis)) & kIndexMask);
    centre[axis] = static_cast<double>(index - kIndexOffset) + 0.5;
  }
  return centre;
}

/// A hash by which neighbouring keys lie far apart (the finalizer of SplitMix64).
std::uint64_t Hash(std::uint64_t key) {
  key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9u;
  key = (key ^ (key >> 27)) * 0x94d049bb133111ebu;
  return key ^ (key >> 31);
}

Eigen::Map<Eigen::Vector3f> Sum(std::array<float, 3>& sum) {
  return Eigen::Map<Eigen::Vector3f>(sum.data());
}
Eigen::Map<const Eigen::Vector3f> Sum(const std::array<float, 3>& sum) {
  return Eigen::Map<const Eigen::Vector3f>(sum.data());
}

/// Returns the contribution of a sample to its voxel, without a key if the sample is too far away.
Voxel PartOf(const VoxelSample& sample, double voxel_size, int view) {
  ORB360_CHECK(sample.error > 0, sample.error);
  const Eigen::Vector3d in_voxels = sample.position / voxel_size;
  std::array<std::int64_t, 3> index{};
  for (int axis = 0; axis < 3; ++axis) {
    const double whole = std::floor(in_voxels[axis]);
    if (!(std::abs(whole) < static_cast<double>(kIndexOffset - 1))) return {};
    index[static_cast<size_t>(axis)] = static_cast<std::int64_t>(whole);
  }
  Voxel part;
  part.key = MakeKey(index);
  const auto size = static_cast<float>(voxel_size);
  part.information = part.best = size * size / (sample.error * sample.error);
  Sum(part.offset) = part.information * (in_voxels - CentreOf(part.key)).cast<float>();
  Sum(part.normal) = part.information * sample.normal;
  Sum(part.rgb) = part.information * Eigen::Vector3f(sample.rgb[0], sample.rgb[1], sample.rgb[2]);
  part.last_view = view;
  return part;
}

}  // namespace

Voxel& Voxel::operator+=(const Voxel& other) {
  information += other.information;
  best = std::max(best, other.best);
  Sum(offset) += Sum(other.offset);
  Sum(normal) += Sum(other.normal);
  Sum(rgb) += Sum(other.rgb);
  last_view = std::max(last_view, other.last_view);
  return *this;
}

Voxel& VoxelGrid::Find(std::uint64_t key) {
  size_t slot = Hash(key) & (slots_.size() - 1);
  while (slots_[slot].key != 0 && slots_[slot].key != key) slot = (slot + 1) & (slots_.size() - 1);
  return slots_[slot];
}

void VoxelGrid::Rebuild(std::span<const Voxel> voxels, size_t capacity) {
  slots_.assign(capacity, Voxel());
  for (const Voxel& voxel : voxels) Find(voxel.key) = voxel;
  count_ = voxels.size();
}

void VoxelGrid::Reserve(size_t more) {
  // The table is at most three quarters full, so that searches stay short.
  if (4 * (count_ + more) <= 3 * slots_.size()) return;
  std::vector<Voxel> voxels;
  voxels.reserve(count_);
  std::ranges::copy_if(slots_, std::back_inserter(voxels),
                       [](const Voxel& v) { return v.key != 0; });
  Rebuild(voxels, std::max(kFirstCapacity, 2 * slots_.size()));
}

void VoxelGrid::Add(std::span<const VoxelSample> samples, int view) {
  // Size of the batches. The table entries of a batch are prefetched while the rest of it is
  // prepared.
  constexpr size_t kBatch = 32;
  std::array<Voxel, kBatch> parts;
  for (size_t first = 0; first < samples.size(); first += kBatch) {
    const auto batch = samples.subspan(first, std::min(kBatch, samples.size() - first));
    Reserve(batch.size());
    for (size_t i = 0; i < batch.size(); ++i) {
      parts[i] = PartOf(batch[i], size_, view);
      const Voxel* slot = &slots_[Hash(parts[i].key) & (slots_.size() - 1)];
      hwy::Prefetch(&slot->key);
      hwy::Prefetch(&slot->last_view);  // perhaps in the next line of the cache
    }
    for (const Voxel& part : std::span(parts).first(batch.size())) {
      if (part.key == 0) continue;
      Voxel& voxel = Find(part.key);
      if (voxel.key == 0) {
        voxel = part;
        ++count_;
      } else {
        voxel += part;
      }
    }
  }
}

std::vector<Voxel> VoxelGrid::TakeOldest() {
  if (count_ == 0) return {};
  std::vector<std::int32_t> views;
  views.reserve(count_);
  for (const Voxel& voxel : slots_) {
    if (voxel.key != 0) views.push_back(voxel.last_view);
  }
  return Take(Median(views));
}

std::vector<Voxel> VoxelGrid::TakeAll() { return Take(std::numeric_limits<std::int32_t>::max()); }

/// Takes the voxels whose last view is not newer than `last_view`.
std::vector<Voxel> VoxelGrid::Take(int last_view) {
  std::vector<Voxel> taken;
  std::vector<Voxel> kept;
  for (const Voxel& voxel : slots_) {
    if (voxel.key != 0) (voxel.last_view <= last_view ? taken : kept).push_back(voxel);
  }
  Rebuild(kept, slots_.size());
  std::ranges::sort(taken, {}, &Voxel::key);
  return taken;
}

std::uint64_t VoxelTile(std::uint64_t key) {
  std::uint64_t tile = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint64_t index = (key >> (kIndexBits * axis)) & kIndexMask;
    tile |= (index / kTileVoxels) << (kIndexBits * axis);
  }
  return tile;
}

SurfacePoint MakeSurfacePoint(const Voxel& voxel, double voxel_size, double max_independent) {
  SurfacePoint point;
  const float inverse_information = 1.0f / voxel.information;
  const Eigen::Vector3d in_voxels =
      CentreOf(voxel.key) + (inverse_information * Sum(voxel.offset)).cast<double>();
  point.position = (voxel_size * in_voxels).cast<float>();
  point.normal = Sum(voxel.normal).normalized();
  for (int channel = 0; channel < 3; ++channel) {
    const float value =
        std::clamp(std::round(inverse_information * Sum(voxel.rgb)[channel]), 0.0f, 255.0f);
    point.rgb[static_cast<size_t>(channel)] = static_cast<std::uint8_t>(value);
  }
  const float error = 1.0f / std::sqrt(std::min(voxel.information,
                                                static_cast<float>(max_independent) * voxel.best));
  point.confidence = 1.0f / (1.0f + error);
  return point;
}

}  // namespace orb360
