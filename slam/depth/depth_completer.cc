#include <cmath>
#include <span>

#include <opencv2/imgproc.hpp>

#include <orb360/nn/base/check.h>
#include <orb360/nn/graph/network_file.h>
#include <orb360/nn/models/depth_completion.h>
#include <orb360/slam/depth/depth_completer.h>

namespace orb360 {
namespace {

nn::ExecutorOptions HowToRun(const DepthCompleterOptions& options) {
  return {.threads = options.threads,
          .precision = options.bfloat16 ? nn::DataType::kBFloat16 : nn::DataType::kFloat};
}

template <typename T>
std::span<const T> PixelsOf(const cv::Mat& image) {
  return {image.ptr<T>(), image.total() * static_cast<size_t>(image.channels())};
}

}  // namespace

struct DepthCompleter::Network {
  Network(const std::filesystem::path& weights, const DepthCompleterOptions& options)
      : model(nn::ReadNetwork(weights), {options.size.height, options.size.width},
              HowToRun(options)),
        workspace(model) {}

  nn::DepthCompletion model;
  nn::DepthCompletion::Workspace workspace;
};

DepthCompleter::DepthCompleter(const std::filesystem::path& weights,
                               const DepthCompleterOptions& options)
    : camera_(options.size.width, options.size.height),
      network_(std::make_unique<Network>(weights, options)) {}

DepthCompleter::~DepthCompleter() = default;

DenseDepth DepthCompleter::Complete(const cv::Mat& color, const SparseDepth& sparse) {
  const cv::Size size(camera_.width(), camera_.height());
  ORB360_CHECK(color.type() == CV_8UC3 && color.size() == size, color.cols, color.rows);
  ORB360_CHECK(sparse.range.size() == size && sparse.confidence.size() == size);
  cv::Mat rgb;
  cv::cvtColor(color, rgb, cv::COLOR_BGR2RGB);
  nn::CompletionOutput dense =
      network_->model.Complete({PixelsOf<unsigned char>(rgb), PixelsOf<float>(sparse.range),
                                PixelsOf<float>(sparse.confidence)},
                               &network_->workspace);
  DenseDepth depth{cv::Mat(size, CV_32F, dense.depth.data()).clone(),
                   cv::Mat(size, CV_32F, dense.confidence.data()).clone(), color};
  if (!dense.ground.empty()) depth.ground = cv::Mat(size, CV_32F, dense.ground.data()).clone();
  if (dense.log_metric_scale) {
    depth.log_camera_height = std::log(dense.scale) - *dense.log_metric_scale;
  }
  return depth;
}

}  // namespace orb360
