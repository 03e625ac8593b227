// Completes one sparse depth image: complete IMAGE SPARSE.png DENSE.png
#include <cstdio>
#include <thread>

#include <opencv2/imgcodecs.hpp>

#include <orb360/nn/base/check.h>
#include <orb360/nn/models/default_weights.h>
#include <orb360/slam/depth/depth_completer.h>
#include <orb360/slam/io/depth_image.h>

int main(int argc, char** argv) try {
  if (argc != 4) return std::fputs("usage: complete IMAGE SPARSE.png DENSE.png\n", stderr), 2;
  const cv::Mat image = cv::imread(argv[1], cv::IMREAD_COLOR);  // equirectangular, BGR
  if (image.empty()) throw orb360::UserError(argv[1] + std::string(": is not an image"));
  orb360::SparseDepth sparse{orb360::ReadDepthImage(argv[2]), {}};  // metres; 0 where none is known
  if (sparse.range.size() != image.size()) {
    throw orb360::UserError("image and sparse depth must have the same size");
  }
  cv::Mat(sparse.range > 0).convertTo(sparse.confidence, CV_32F, 1.0 / 255);  // trust every point
  orb360::DepthCompleter completer(
      orb360::nn::DefaultWeights(),
      {.size = image.size(), .threads = static_cast<int>(std::thread::hardware_concurrency())});
  const orb360::DenseDepth dense = completer.Complete(image, sparse);
  orb360::WriteDepthImage(argv[3], dense.range);  // 16-bit PNG of metres * 256
} catch (const orb360::UserError& error) {
  return std::fprintf(stderr, "complete: %s\n", error.what()), 1;
}
