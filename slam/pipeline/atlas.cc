#include "slam/pipeline/atlas.h"

#include <numeric>
#include <utility>

#include <orb360/nn/base/check.h>

namespace orb360 {

Atlas::Atlas(LoopDetector places) : maps_(1), grounds_(1), places_(std::move(places)) {}

Map& Atlas::map() {
  ORB360_CHECK(!is_lent());
  return maps_.back();
}

const Map& Atlas::map() const {
  ORB360_CHECK(!is_lent());
  return maps_.back();
}

LoopDetector& Atlas::places() {
  ORB360_CHECK(!is_lent());
  return *places_;
}

ActiveMap Atlas::Lend() {
  ORB360_CHECK(!is_lent());
  ActiveMap active{std::exchange(maps_.back(), Map()), std::move(*places_)};
  places_.reset();
  return active;
}

void Atlas::Return(ActiveMap active) {
  ORB360_CHECK(is_lent());
  maps_.back() = std::move(active.map);
  places_ = std::move(active.places);
}

void Atlas::Apply(const MapUpdate& update) {
  ORB360_CHECK(!is_lent());
  if (!update.corrections.empty()) {
    ScaleAnchors(present_number(), update.corrections);
    if (found_loop) Rescale(update.corrections, &*found_loop);
  }
  if (update.renumbering) RenumberMaps(*update.renumbering);
}

MapUpdate Atlas::SwitchTo(int finished, KeyframeId reference) {
  const int present = present_number();
  ORB360_CHECK(!is_lent() && finished >= 0 && finished < present, finished, present);
  maps_.back().ForgetImages(0);
  std::swap(maps_.back(), maps_[finished]);
  std::swap(grounds_.back(), grounds_[finished]);
  MapRenumbering renumbering{.number_of = std::vector<int>(maps_.size())};
  std::iota(renumbering.number_of.begin(), renumbering.number_of.end(), 0);
  std::swap(renumbering.number_of[finished], renumbering.number_of[present]);
  return {.reference = reference, .renumbering = std::move(renumbering)};
}

void Atlas::Begin(Map map) {
  ORB360_CHECK(!is_lent());
  if (maps_.back().num_keyframes() > 0) {
    maps_.back().ForgetImages(0);
    maps_.emplace_back();
    grounds_.emplace_back();
  }
  maps_.back() = std::move(map);
}

void Atlas::Finish() {
  maps_.back().ForgetImages(0);
  if (maps_.back().num_keyframes() > 0) return;
  std::erase_if(anchors_, [this](const auto& a) { return a.second.map == present_number(); });
  maps_.pop_back();
  grounds_.pop_back();
}

void Atlas::ChangeUnit(int number, double factor) {
  Map& map = maps_[number];
  ScaleAnchors(number, RescaleMap(factor, map.KeyframeIds().front(), &map).corrections);
}

std::optional<KnownGround> Atlas::ReliableGround() const {
  return ground() && !ground()->is_rough ? ground() : std::nullopt;
}

void Atlas::Anchor(int frame_index, FrameAnchor anchor) {
  anchors_[frame_index] = std::move(anchor);
}

void Atlas::ScaleAnchors(int number, std::span<const Similarity3> corrections) {
  for (auto& [index, anchor] : anchors_) {
    if (anchor.map != number) continue;
    const double scale = corrections[anchor.reference].scale;
    anchor.reference_from_camera.translation *= scale;
    anchor.unit_scale *= scale;
  }
}

void Atlas::RenumberMaps(const MapRenumbering& renumbering) {
  const int present = present_number();
  for (auto& [index, anchor] : anchors_) Renumber(renumbering, &anchor);
  places_->Renumber(renumbering.number_of, renumbering.shifted, renumbering.keyframe_shift);
  for (int number = present - 1; number >= 0; --number) {
    if (renumbering.number_of[number] != renumbering.number_of[present]) continue;
    // It has become part of the present map, whose unit is now that of the older one.
    if (!grounds_[number]) grounds_.back().reset();
    maps_.erase(maps_.begin() + number);
    grounds_.erase(grounds_.begin() + number);
  }
}

}  // namespace orb360
