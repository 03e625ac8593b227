#include "slam/pipeline/pending_frames.h"

#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "slam/features/sphere_pyramid.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

PendingFrame FrameAt(int index) {
  return {.index = index, .timestamp = 0.1 * index, .features = std::make_shared<Features>()};
}

TEST(PendingFrames, TheNewestIsTheReferenceUntilItIsReplaced) {
  PendingFrames frames(10);
  EXPECT_THROW(frames.Reference(), ContractError);
  frames.Remember(FrameAt(3));
  EXPECT_EQ(frames.Reference().index, 3);
  frames.Remember(FrameAt(4));
  EXPECT_EQ(frames.Reference().index, 3);
  EXPECT_TRUE(frames.AdvanceReference());
  EXPECT_EQ(frames.Reference().index, 4);
  EXPECT_FALSE(frames.AdvanceReference());
  frames.Remember(FrameAt(5));
  frames.ResetReference();
  EXPECT_EQ(frames.Reference().index, 5);
}

TEST(PendingFrames, KeepsTheImagesOfTheReferenceAndOfTheNewest) {
  PendingFrames frames(10);
  const auto remember = [&](int index) {
    PendingFrame frame = FrameAt(index);
    frame.image = std::make_shared<const SpherePyramid>();
    frames.Remember(std::move(frame));
  };
  remember(1);
  EXPECT_EQ(frames.Reference().index, 1);
  for (const int index : {2, 3, 4}) remember(index);
  std::vector<int> with_image;
  for (const PendingFrame& frame : frames.TakeNewestFirst()) {
    if (frame.image) with_image.push_back(frame.index);
  }
  EXPECT_EQ(with_image, (std::vector<int>{4, 1}));
}

TEST(PendingFrames, ForgetsTheOldestButNeverTheReference) {
  PendingFrames frames(2);
  frames.Remember(FrameAt(0));
  EXPECT_EQ(frames.Reference().index, 0);
  for (int i = 1; i < 5; ++i) frames.Remember(FrameAt(i));
  const std::vector<PendingFrame> left = frames.TakeNewestFirst();
  ASSERT_EQ(left.size(), 2u);
  EXPECT_EQ(left[0].index, 4);
  EXPECT_EQ(left[1].index, 0);
  EXPECT_TRUE(frames.empty());
}

TEST(PendingFrames, KeepsHowAForgottenFrameWasTurned) {
  PendingFrames frames(1);
  frames.Remember(FrameAt(0));
  frames.Reference();
  PendingFrame turned = FrameAt(1);
  turned.turn = {.reference = 0, .reference_from_camera = Eigen::Quaterniond::Identity()};
  frames.Remember(turned);
  const std::vector<PendingFrame> left = frames.TakeNewestFirst();
  ASSERT_EQ(left.size(), 2u);
  EXPECT_EQ(left[0].features, nullptr);
  EXPECT_EQ(left[0].turn->reference, 0);
  EXPECT_NE(left[1].features, nullptr);
}

TEST(PendingFrames, AFrameThatBecameAKeyframeIsForgotten) {
  PendingFrames frames(10);
  for (int i = 0; i < 3; ++i) frames.Remember(FrameAt(i));
  frames.Forget(1);
  const std::vector<PendingFrame> left = frames.TakeNewestFirst();
  ASSERT_EQ(left.size(), 2u);
  EXPECT_EQ(left[0].index, 2);
  EXPECT_EQ(left[1].index, 0);
}

}  // namespace
}  // namespace orb360
