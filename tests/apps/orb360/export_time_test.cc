#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "slam/io/ply.h"
#include "slam/io/sparse_model_file.h"
#include "tests/apps/orb360/run_fixture.h"
#include "tests/slam/io/synthetic_model.h"

namespace orb360 {
namespace {

/// How long 3,000 keyframes with 3,000,000 observations take without images, and a dense cloud of
/// ten million points, and how much memory.
TEST(ExportSlow, ThreeThousandKeyframesTakeLessThanAMinuteAndBoundedMemory) {
  const TempFolder folder;
  const SparseModel model = MakeSyntheticModel({4500, 170, 2048});
  size_t observations = 0;
  for (const PosedFrame& frame : model.frames) observations += frame.observations.size();
  EXPECT_GT(observations, 3'000'000u);
  WriteSparseModel(folder / "reconstruction.h5", model);
  WriteText(folder / "summary.json", "{\"input\": \"none\"}");
  SurfacePlyWriter cloud(folder / "cloud.ply", 0.05);
  std::vector<SurfacePoint> points(1'000'000);
  for (int piece = 0; piece < 10; ++piece) {
    for (size_t i = 0; i < points.size(); ++i) {
      points[i].position = {0.001F * static_cast<float>(i), static_cast<float>(piece), 2};
    }
    cloud.Append(points);
  }
  cloud.Commit();
  std::printf("reconstruction.h5: %.0f MB, %zu points, %zu observations\n",
              1e-6 * std::filesystem::file_size(folder / "reconstruction.h5"), model.points.size(),
              observations);
  for (const char* format :
       {"tum", "kitti", "euroc", "opensfm", "nerfstudio", "colmap", "colmap-rig", "las", "mcap"}) {
    const std::filesystem::path out = folder / format;
    std::vector<std::string> arguments = {"export", folder.path(), "--to", format, "--out", out};
    const bool is_scene =
        format[0] == 'c' || format[0] == 'n' || format[0] == 'o' || format[0] == 'm';
    if (is_scene) arguments.insert(arguments.end(), {"--images", "none"});
    const auto start = std::chrono::steady_clock::now();
    const ProgramResult result = RunOrb360(arguments);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("%s: %.1f s, %.0f MB\n", format, seconds, result.peak_memory_mb);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_LT(seconds, 60) << format;
    EXPECT_LT(result.peak_memory_mb, 1024) << format;
    std::filesystem::remove_all(out);
  }
}

}  // namespace
}  // namespace orb360
