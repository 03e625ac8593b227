#include "apps/orb360/sparse_output.h"

#include <cstdio>
#include <map>
#include <system_error>

#include "slam/io/output_file.h"
#include "slam/io/sparse_file.h"
#include <orb360/slam/depth/sparse_depth.h>

namespace orb360 {
namespace {

struct KeyframeOfMap {
  const Map* map;
  KeyframeId id;
};

void WriteSparseView(const std::filesystem::path& folder, const SparseSample& sample) {
  char name[32];
  std::snprintf(name, sizeof name, "%06d.h5", sample.frame_index);
  WriteSparseSample(folder / name, sample);
}

}  // namespace

std::filesystem::path MakeSparseFolder(const std::filesystem::path& folder) {
  std::filesystem::path sparse = folder / kSparseName;
  std::error_code error;
  std::filesystem::create_directories(sparse, error);
  if (error) ThrowWriteError(sparse, error.value());
  // Other frames get depth in another run; its files would be taken for those of this one.
  for (const auto& entry : std::filesystem::directory_iterator(sparse)) {
    if (entry.path().extension() == ".h5") std::filesystem::remove(entry.path(), error);
  }
  return sparse;
}

SparseSampleSink SparseWriter(const std::filesystem::path& folder, std::exception_ptr* failure) {
  const auto keep_failure = [failure] {
    if (!*failure) *failure = std::current_exception();
  };
  try {
    return [keep_failure, sparse = MakeSparseFolder(folder),
            has_failed = false](const SparseSample& sample) mutable {
      if (has_failed) return;
      try {
        WriteSparseView(sparse, sample);
      } catch (const std::exception&) {
        has_failed = true;
        keep_failure();
      }
    };
  } catch (const std::exception&) {
    keep_failure();
    return nullptr;
  }
}

void WriteSparseKeyframes(const std::filesystem::path& folder, std::span<const Map> maps,
                          Sequence* sequence) {
  // The keyframes by frame index. A frame is in one map only; frames of earlier runs have negative
  // indices.
  std::map<int, KeyframeOfMap> keyframes;
  for (const Map& map : maps) {
    for (const KeyframeId id : map.KeyframeIds()) {
      if (!map.keyframe(id).IsOfThisRun()) continue;
      keyframes.insert({map.keyframe(id).frame_index, {&map, id}});
    }
  }
  const cv::Size size = sequence->image_size();
  const EquirectangularCamera camera(size.width, size.height);
  for (auto next = keyframes.begin(); next != keyframes.end();) {
    const std::optional<Frame> frame = sequence->Next();
    if (!frame) break;
    if (frame->index != next->first) continue;
    const auto [map, id] = next->second;
    const Keyframe& keyframe = map->keyframe(id);
    WriteSparseView(
        folder, {frame->image, RenderSparseDepth(ProjectLandmarks(*map, id, camera, {}), camera),
                 frame->index, keyframe.timestamp, keyframe.world_from_camera});
    ++next;
  }
}

}  // namespace orb360
