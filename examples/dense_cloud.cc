// A dense coloured cloud from a video or a folder of images: dense_cloud INPUT CLOUD.ply
#include <cstdio>
#include <filesystem>
#include <optional>
#include <thread>

#include <orb360/nn/base/check.h>
#include <orb360/nn/models/default_weights.h>
#include <orb360/slam/io/sequence.h>
#include <orb360/slam/io/trajectory.h>
#include <orb360/slam/pipeline/dense_fusion.h>
#include <orb360/slam/pipeline/options.h>
#include <orb360/slam/pipeline/system.h>

int main(int argc, char** argv) try {
  if (argc != 3) return std::fputs("usage: dense_cloud INPUT CLOUD.ply\n", stderr), 2;
  const auto sequence = orb360::OpenSequence(argv[1], {});
  const cv::Size size = sequence->image_size();
  orb360::Options options;
  options.num_threads = static_cast<int>(std::thread::hardware_concurrency());
  options.scale.camera_height = sequence->camera_height().value_or(0);  // metres; 0: not known
  orb360::System system(orb360::EquirectangularCamera(size.width, size.height), options, {});
  const std::filesystem::path depth = std::string(argv[2]) + ".depth";  // removed with the system
  system.EnableDepth(orb360::nn::DefaultWeights(), depth);
  while (const std::optional<orb360::Frame> frame = sequence->Next()) system.Process(*frame);
  const orb360::Reconstruction result = system.Finish();
  if (result.keyframes.empty()) throw orb360::UserError("nothing was tracked");
  system.ComputeDepth(result);
  const orb360::Rigid3 file_world_from_map =
      orb360::FileWorldFromMap(result.frames.front().world_from_camera, result.up);
  const orb360::DenseCloudSummary cloud = orb360::WriteDenseCloud(
      argv[2], result, *system.depth_maps(), file_world_from_map, options.num_threads);
  std::printf("%llu points from %d views\n", static_cast<unsigned long long>(cloud.points),
              cloud.fusion.views);
} catch (const orb360::UserError& error) {
  return std::fprintf(stderr, "dense_cloud: %s\n", error.what()), 1;
}
