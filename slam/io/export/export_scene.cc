#include "slam/io/export/export_scene.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <utility>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

std::string FileName(const PosedFrame& frame, const View& view, const std::string& extension) {
  char number[16];
  std::snprintf(number, sizeof number, "%06d", frame.index);
  return (view.name.empty() ? "" : view.name + "/") + number + extension;
}

}  // namespace

std::string ImageName(const ExportScene& scene, const PosedFrame& frame, const View& view) {
  return FileName(frame, view, scene.extension);
}

std::string MaskName(const std::string& image_name) { return image_name + ".png"; }

std::string DepthName(const PosedFrame& frame, const View& view) {
  return FileName(frame, view, ".png");
}

int LargestMap(const SparseModel& model) {
  ORB360_CHECK(!model.frames.empty());
  std::map<int, std::pair<int, int>> sizes;  // keyframes and frames, by map
  for (const PosedFrame& frame : model.frames) {
    sizes[frame.map].first += frame.is_keyframe ? 1 : 0;
    ++sizes[frame.map].second;
  }
  return std::ranges::max_element(sizes, {}, [](const auto& map) { return map.second; })->first;
}

SparseModel KeepFrames(SparseModel model, const std::vector<bool>& is_kept) {
  ORB360_CHECK(is_kept.size() == model.frames.size(), is_kept.size(), model.frames.size());
  SparseModel kept{model.width, model.height, {}, {}};
  std::vector<int32_t> number(model.points.size(), -1);
  for (size_t f = 0; f < model.frames.size(); ++f) {
    if (!is_kept[f]) continue;
    for (const PointObservation& seen : model.frames[f].observations) {
      number[static_cast<size_t>(seen.point)] = 0;
    }
    kept.frames.push_back(std::move(model.frames[f]));
  }
  for (size_t p = 0; p < number.size(); ++p) {
    if (number[p] < 0) continue;
    number[p] = static_cast<int32_t>(kept.points.size());
    kept.points.push_back(model.points[p]);
  }
  for (PosedFrame& frame : kept.frames) {
    for (PointObservation& seen : frame.observations) {
      seen.point = number[static_cast<size_t>(seen.point)];
    }
  }
  return kept;
}

}  // namespace orb360
