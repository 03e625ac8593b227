#include "slam/io/export/frame_selection.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/slam/geometry/random_geometry.h"

namespace orb360 {
namespace {

/// Frames at these places on a line, and a keyframe at the start that sees points at a range of 10.
SparseModel Line(const std::vector<double>& places) {
  SparseModel model{64, 32, {}, {}};
  for (size_t i = 0; i < places.size(); ++i) {
    PosedFrame frame;
    frame.index = static_cast<int>(i);
    frame.timestamp = 0.1 * static_cast<double>(i);
    frame.world_from_optical.translation = {places[i], 0, 0};
    model.frames.push_back(frame);
  }
  for (int p = 0; p < 5; ++p) {
    model.points.push_back({{places[0], 6.0, 8.0}, {}});
    model.frames[0].observations.push_back({{1, 1}, p});
  }
  model.frames[0].is_keyframe = true;
  return model;
}

std::vector<size_t> Selected(const std::vector<bool>& is_selected) {
  std::vector<size_t> frames;
  for (size_t f = 0; f < is_selected.size(); ++f) {
    if (is_selected[f]) frames.push_back(f);
  }
  return frames;
}

TEST(FrameSelection, TheRangeOfTheSurroundingsIsThatOfTheNearestKeyframe) {
  SparseModel model = Line({0, 0, 0, 0, 0, 0, 0, 0});
  model.points.push_back({{0, 0, 3.0}, {}});
  model.frames[6].observations.push_back({{1, 1}, 5});
  const std::vector<double> ranges = SurroundingRanges(model);
  EXPECT_EQ(ranges, (std::vector<double>{10, 10, 10, 10, 3, 3, 3, 3}));
  model.frames[0].observations.clear();
  model.frames[6].observations.clear();
  EXPECT_EQ(SurroundingRanges(model), std::vector<double>(8, 1.0));
}

// A walk with changing speed and random sharpness; the distance wanted is 10 * 0.1 = 1.
TEST(FrameSelection, LeavesNoGapKeepsTheLeastMotionAndTakesTheSharpest) {
  RandomGeometry random(11);
  std::vector<double> places;
  std::vector<double> sharpness;
  double place = 0;
  for (int i = 0; i < 2000; ++i) {
    places.push_back(place);
    place += random.Uniform(0, 0.2);
    sharpness.push_back(random.Uniform(1, 10));
  }
  const SparseModel model = Line(places);
  const std::vector<size_t> selected = Selected(SelectSharpest(model, sharpness, 0.1));
  EXPECT_LT(places[selected.front()], 0.5);
  EXPECT_LT(places.back() - places[selected.back()], 0.5);
  for (size_t i = 1; i < selected.size(); ++i) {
    const double from = places[selected[i - 1]];
    const double step = places[selected[i]] - from;
    EXPECT_GE(step, 0.5);
    EXPECT_LE(step, 1.5);
    for (size_t f = selected[i - 1] + 1; f < places.size(); ++f) {
      if (places[f] - from >= 0.5 && places[f] - from <= 1.5) {
        EXPECT_LE(sharpness[f], sharpness[selected[i]]);
      }
    }
  }
  const auto median = [&](std::vector<size_t> frames) {
    std::vector<double> values;
    for (const size_t f : frames) values.push_back(sharpness[f]);
    std::ranges::nth_element(values, values.begin() + static_cast<long>(values.size() / 2));
    return values[values.size() / 2];
  };
  std::vector<size_t> uniform;
  for (size_t i = 0; i < selected.size(); ++i)
    uniform.push_back(i * places.size() / selected.size());
  EXPECT_GT(median(selected), 1.3 * median(uniform));
}

TEST(FrameSelection, AFastDriveKeepsEveryFrameHoweverBlurred) {
  const SparseModel model = Line({0, 5, 10, 15, 20});
  EXPECT_EQ(Selected(SelectSharpest(model, std::vector<double>{9, 1, 9, 1, 9}, 0.1)).size(), 5u);
}

TEST(FrameSelection, ACameraThatStandsGivesItsSharpestFrame) {
  const SparseModel model = Line({0, 0.01, 0, 0.02, 0});
  EXPECT_EQ(Selected(SelectSharpest(model, std::vector<double>{1, 2, 9, 3, 1}, 0.1)),
            std::vector<size_t>{2});
}

}  // namespace
}  // namespace orb360
