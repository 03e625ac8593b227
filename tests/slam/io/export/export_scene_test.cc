#include "slam/io/export/export_scene.h"

#include <gtest/gtest.h>

#include "tests/slam/io/synthetic_model.h"

namespace orb360 {
namespace {

TEST(ExportScene, NamesOfImagesTellViewAndFrame) {
  ExportScene scene;
  PosedFrame frame;
  frame.index = 42;
  const View panorama = PanoramaView(64, 32).front();
  EXPECT_EQ(ImageName(scene, frame, panorama), "000042.jpg");
  EXPECT_EQ(MaskName("000042.jpg"), "000042.jpg.png");
  scene.extension = ".png";
  EXPECT_EQ(ImageName(scene, frame, CubeViews(64, 1.7)[4]), "up/000042.png");
  EXPECT_EQ(DepthName(frame, CubeViews(64, 1.7)[4]), "up/000042.png");
}

TEST(ExportScene, TheLargestMapIsTheOneWithMostKeyframes) {
  SparseModel model = MakeSyntheticModel({9, 4});  // keyframes 0, 1, 3, 4, 6, 7
  for (const size_t f : {4, 6, 7, 8}) model.frames[f].map = 1;
  EXPECT_EQ(LargestMap(model), 0);  // three keyframes each, and more frames
  model.frames[3].map = 1;
  EXPECT_EQ(LargestMap(model), 1);
}

TEST(ExportScene, KeptFramesKeepTheirPointsAndNoOther) {
  const SparseModel model = MakeSyntheticModel({12, 5});
  std::vector<bool> is_kept(12, false);
  is_kept[7] = is_kept[10] = true;
  const SparseModel kept = KeepFrames(model, is_kept);
  ASSERT_EQ(kept.frames.size(), 2u);
  EXPECT_EQ(kept.frames[1].index, 10);
  std::vector<int> observed(kept.points.size(), 0);
  for (size_t f = 0; f < 2; ++f) {
    const PosedFrame& was = model.frames[f == 0 ? 7 : 10];
    const PosedFrame& is = kept.frames[f];
    ASSERT_EQ(is.observations.size(), was.observations.size());
    for (size_t o = 0; o < was.observations.size(); ++o) {
      const auto point = static_cast<size_t>(is.observations[o].point);
      ASSERT_LT(point, kept.points.size());
      ++observed[point];
      EXPECT_EQ(is.observations[o].pixel, was.observations[o].pixel);
      EXPECT_EQ(kept.points[point].position,
                model.points[static_cast<size_t>(was.observations[o].point)].position);
    }
  }
  EXPECT_EQ(std::ranges::count(observed, 0), 0);
  EXPECT_LT(kept.points.size(), model.points.size());
}

}  // namespace
}  // namespace orb360
