// Frames in, poses out: track INPUT TRAJECTORY
#include <cstdio>
#include <optional>
#include <vector>

#include <orb360/nn/base/check.h>
#include <orb360/slam/io/sequence.h>
#include <orb360/slam/io/trajectory.h>
#include <orb360/slam/pipeline/options.h>
#include <orb360/slam/pipeline/system.h>

int main(int argc, char** argv) try {
  if (argc != 3) return std::fputs("usage: track INPUT TRAJECTORY\n", stderr), 2;
  const auto sequence = orb360::OpenSequence(argv[1], {});  // a video or a folder of images
  const cv::Size size = sequence->image_size();
  orb360::Options options;
  options.scale.camera_height = sequence->camera_height().value_or(0);  // metres; 0: not known
  orb360::System system(orb360::EquirectangularCamera(size.width, size.height), options, {});
  while (const std::optional<orb360::Frame> frame = sequence->Next()) {
    const orb360::FrameReport report = system.Process(*frame);
    if (!report.world_from_camera) continue;  // not initialized yet, or lost
    const Eigen::Vector3d& p = report.world_from_camera->translation;  // as known at this frame
    std::printf("%.3f s: %.2f %.2f %.2f\n", frame->timestamp, p.x(), p.y(), p.z());
  }
  const orb360::Reconstruction result = system.Finish();  // with the final poses
  if (result.frames.empty()) throw orb360::UserError("no pose was found");
  std::vector<orb360::StampedPose> poses;
  for (const orb360::FramePose& frame : result.frames) {
    poses.push_back({frame.timestamp, frame.world_from_camera});
  }
  orb360::WriteTrajectory(argv[2], poses,
                          orb360::FileWorldFromMap(poses.front().world_from_camera, result.up));
} catch (const orb360::UserError& error) {
  return std::fprintf(stderr, "track: %s\n", error.what()), 1;
}
