#include <cstdio>
#include <filesystem>
#include <string>

#include "nn/models/default_weights.h"
#include "slam/io/frame_source.h"
#include "slam/pipeline/options.h"
#include "slam/pipeline/system.h"

// One black image: nothing to track, and the report says so.
int main() {
  orb360::System system(orb360::EquirectangularCamera(640, 320), orb360::Options(), cv::Mat());
  const orb360::FrameReport report =
      system.Process({0, 0.0, cv::Mat(320, 640, CV_8UC3, cv::Scalar(0, 0, 0))});
  if (report.world_from_camera || !system.Finish().frames.empty()) {
    std::puts("a pose was found in a black image");
    return 1;
  }
  // Installed beside the program.
  if (orb360::nn::DefaultWeights().string().find("share/orb360/weights") == std::string::npos) {
    std::puts("the installed weights were not found");
    return 1;
  }
  return 0;
}
