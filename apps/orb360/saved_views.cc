#include "apps/orb360/saved_views.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <system_error>

#include <nlohmann/json.hpp>

#include "slam/io/atomic_file.h"
#include "slam/io/output_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr const char* kFileName = "views.json";
constexpr int kVersion = 3;

nlohmann::json ToJson(const DenseView& view) {
  const Eigen::Vector3d& p = view.world_from_camera.translation;
  const Eigen::Quaterniond& q = view.world_from_camera.rotation;
  return {{"frame", view.frame_index},
          {"position", {p.x(), p.y(), p.z()}},
          {"orientation", {q.x(), q.y(), q.z(), q.w()}},
          {"neighbours", view.neighbours}};
}

DenseView FromJson(const nlohmann::json& json) {
  DenseView view;
  view.frame_index = json.at("frame").get<int>();
  const auto p = json.at("position").get<std::array<double, 3>>();
  const auto q = json.at("orientation").get<std::array<double, 4>>();
  view.world_from_camera.translation = {p[0], p[1], p[2]};
  view.world_from_camera.rotation = Eigen::Quaterniond(q[3], q[0], q[1], q[2]);
  view.neighbours = json.at("neighbours").get<std::vector<size_t>>();
  return view;
}

/// Whether fusion can use the views.
bool AreSound(const std::vector<DenseView>& views) {
  for (size_t i = 0; i < views.size(); ++i) {
    const DenseView& view = views[i];
    if (i > 0 && view.frame_index <= views[i - 1].frame_index) return false;
    if (!view.world_from_camera.translation.allFinite()) return false;
    if (!(std::abs(view.world_from_camera.rotation.norm() - 1) < 1e-6)) return false;
    for (const size_t neighbour : view.neighbours) {
      if (neighbour >= views.size() || neighbour == i) return false;
    }
  }
  return true;
}

}  // namespace

void SaveViews(const std::filesystem::path& folder, const DepthMapStore& store,
               const SavedViews& saved) {
  std::error_code error;
  std::filesystem::remove_all(folder, error);
  if (!error) std::filesystem::create_directories(folder, error);
  if (error) ThrowWriteError(folder, error.value());
  nlohmann::json views = nlohmann::json::array();
  for (const DenseView& view : saved.views) {
    store.CopyTo(view.frame_index, folder);
    views.push_back(ToJson(view));
  }
  // It is written last, so that the folder is either complete or has no such file.
  WriteFileAtomically(folder / kFileName, nlohmann::json{{"version", kVersion},
                                                         {"is_metric", saved.is_metric},
                                                         {"views", std::move(views)}}
                                                  .dump(1) +
                                              "\n");
}

SavedViews LoadViews(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / kFileName;
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) {
    throw UserError(path.string() +
                    ": cannot be opened; `orb360 run --save-views` writes it at the end of a run");
  }
  SavedViews saved;
  try {
    const nlohmann::json json = nlohmann::json::parse(file);
    if (json.at("version").get<int>() != kVersion) {
      throw UserError(path.string() + ": was written by another version of orb360; run it again");
    }
    saved.is_metric = json.at("is_metric").get<bool>();
    for (const nlohmann::json& view : json.at("views")) saved.views.push_back(FromJson(view));
  } catch (const nlohmann::json::exception&) {
    throw UserError(path.string() + ": is damaged; run `orb360 run --save-views` again");
  }
  if (!AreSound(saved.views)) {
    throw UserError(path.string() + ": is damaged; run `orb360 run --save-views` again");
  }
  return saved;
}

std::vector<int> FramesWithDepth(const std::filesystem::path& folder, const SparseModel& model) {
  constexpr double kSamePlace = 1e-6;  // of the distance from the origin: what rounding does
  std::vector<int> frames;
  for (const DenseView& view : LoadViews(folder).views) {
    const auto frame =
        std::ranges::lower_bound(model.frames, view.frame_index, {}, &PosedFrame::index);
    if (frame == model.frames.end() || frame->index != view.frame_index) continue;
    const Eigen::Vector3d& place = frame->world_from_optical.translation;
    if ((place - view.world_from_camera.translation).norm() < kSamePlace * (1 + place.norm())) {
      frames.push_back(view.frame_index);
    }
  }
  return frames;
}

}  // namespace orb360
