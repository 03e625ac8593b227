#include "slam/pipeline/background_job.h"

#include <future>
#include <stdexcept>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

TEST(BackgroundJob, IsDueAtItsFrameOrWhenTooFewLandmarksAreTracked) {
  BackgroundJob<int> job([] { return 7; }, {.num_frames = 10, .min_inliers = 150});
  EXPECT_FALSE(job.IsDue(9, 150));
  EXPECT_TRUE(job.IsDue(10, 150));
  EXPECT_TRUE(job.IsDue(9, 149));
  EXPECT_EQ(job.Take(), 7);
}

TEST(BackgroundJob, BeingDoneDoesNotMakeItDue) {
  std::promise<void> may_end;
  BackgroundJob<int> job(
      [end = may_end.get_future()] {
        end.wait();
        return 7;
      },
      {.num_frames = 10});
  EXPECT_TRUE(job.IsRunning());
  EXPECT_FALSE(job.IsDue(9, 0));
  EXPECT_TRUE(job.IsDue(10, 0));
  may_end.set_value();
  EXPECT_EQ(job.Take(), 7);
}

TEST(BackgroundJob, PassesOnWhatItsWorkThrows) {
  BackgroundJob<int> job([]() -> int { throw std::runtime_error("lost"); }, {});
  EXPECT_THROW(job.Take(), std::runtime_error);
}

}  // namespace
}  // namespace orb360
