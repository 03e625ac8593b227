#include "tests/slam/optimization/libmv_problem.h"

#include <gtest/gtest.h>

#include "slam/optimization/bundle_adjustment.h"
#include "tests/slam/geometry/random_geometry.h"
#include "tests/slam/io/temp_folder.h"

namespace orb360 {
namespace {

const LibmvIntrinsics kIntrinsics{.focal_length = 1500,
                                  .principal_point = {960, 540},
                                  .k1 = -0.05,
                                  .k2 = 0.01,
                                  .k3 = -0.002,
                                  .p1 = 0.001,
                                  .p2 = -0.0005};

template <typename T>
void Append(T value, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(value));
}

void AppendReals(std::initializer_list<double> values, std::string* bytes) {
  for (const double value : values) Append(static_cast<float>(value), bytes);
}

TEST(LibmvIntrinsics, ABearingProjectsToItsMarker) {
  RandomGeometry random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector2d marker(random.Uniform(0, 1920), random.Uniform(0, 1080));
    const Eigen::Vector3d bearing = kIntrinsics.Bearing(marker, true);
    EXPECT_NEAR(bearing.norm(), 1, 1e-12);
    const Eigen::Vector2d found =
        kIntrinsics.focal_length * kIntrinsics.Distort(bearing.hnormalized()) +
        kIntrinsics.principal_point;
    EXPECT_LT((found - marker).norm(), 1e-9);
  }
}

// Two cameras, of which the second is rotated and moved, see one of two points.
TEST(LibmvProblem, HasWhatTheFileSays) {
  std::string bytes = "vP";
  AppendReals({1500, 960, 540, 0, 0, 0, 0, 0}, &bytes);
  const Eigen::Vector3d point(1, -2, 10);
  const Rigid3 camera_from_world{ExpSo3({0.1, -0.2, 0.3}), {0.5, 0.25, -1}};
  Append(int32_t{2}, &bytes);
  for (const auto& [image, pose] : {std::pair{3, Rigid3()}, {8, camera_from_world}}) {
    Append(int32_t{image}, &bytes);
    const Eigen::Matrix3d matrix = pose.rotation.toRotationMatrix();
    for (const double value : matrix.reshaped()) AppendReals({value}, &bytes);
    AppendReals({pose.translation.x(), pose.translation.y(), pose.translation.z()}, &bytes);
  }
  Append(int32_t{2}, &bytes);
  for (const int track : {4, 5}) {
    Append(int32_t{track}, &bytes);
    AppendReals({point.x(), point.y(), point.z()}, &bytes);
  }
  Append(int32_t{3}, &bytes);
  for (const auto& [image, pose] :
       {std::pair{3, Rigid3()}, {8, camera_from_world}, {9, Rigid3()}}) {  // no image 9
    const Eigen::Vector2d seen = (pose * point).hnormalized();
    Append(int32_t{image}, &bytes);
    Append(int32_t{5}, &bytes);
    AppendReals({1500 * seen.x() + 960, 1500 * seen.y() + 540}, &bytes);
  }
  const TempFolder folder;
  WriteText(folder / "problem.bin", bytes);
  const BundleProblem problem = ReadLibmvProblem(folder / "problem.bin");
  EXPECT_EQ(problem.pose_fixed, (std::vector<uint8_t>{1, 0}));
  ASSERT_EQ(problem.points.size(), 1u);
  ASSERT_EQ(problem.observations.size(), 2u);
  for (const BundleProblem::Observation& observation : problem.observations) {
    EXPECT_LT(SquaredResidual(problem, observation), 1e-6);  // floats: a thousandth of a pixel
    EXPECT_EQ(observation.sigma, 1.0 / 1500);
  }
  WriteText(folder / "short.bin", bytes.substr(0, bytes.size() - 1));
  EXPECT_THROW(ReadLibmvProblem(folder / "short.bin"), UserError);
  WriteText(folder / "other.bin", "P6 640 480");
  EXPECT_THROW(ReadLibmvProblem(folder / "other.bin"), UserError);
}

class LibmvProblemTest : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Problems, LibmvProblemTest, testing::ValuesIn(kLibmvProblems));

TEST_P(LibmvProblemTest, BothOptimizersComeToTheSameMinimum) {
  const std::filesystem::path file =
      std::filesystem::path(ORB360_SOURCE_DIR) / "../shared/data/libmv_ba" / GetParam();
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "there is no " << file;
  const BundleProblem problem = ReadLibmvProblem(file);
  for (const BundleLoss loss : {BundleLoss::kHuber, BundleLoss::kArctan}) {
    BundleOptions options{.max_iterations = 200, .loss = loss, .function_tolerance = 1e-9};
    BundleProblem own = problem;
    const SolverReport by_schur = SolveBundle(options, &own);
    options.optimizer = Optimizer::kCeres;
    BundleProblem other = problem;
    const SolverReport by_ceres = SolveBundle(options, &other);
    ASSERT_TRUE(by_schur.usable && by_ceres.usable);
    EXPECT_LT(by_schur.iterations, options.max_iterations);
    EXPECT_NEAR(by_schur.initial_cost, by_ceres.initial_cost, 1e-9 * by_ceres.initial_cost);
    EXPECT_LT(by_schur.final_cost, 0.999 * by_schur.initial_cost);
    EXPECT_NEAR(by_schur.final_cost, by_ceres.final_cost, 1e-6 * by_ceres.final_cost);
  }
}

}  // namespace
}  // namespace orb360
