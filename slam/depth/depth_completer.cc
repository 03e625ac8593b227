#include <cmath>
#include <span>
#include <string>
#include <utility>

#include <opencv2/imgproc.hpp>

#include <orb360/nn/base/check.h>
#include <orb360/nn/graph/network_file.h>
#include <orb360/nn/graph/precision.h>
#include <orb360/nn/models/depth_completion.h>
#include <orb360/slam/depth/depth_completer.h>

namespace orb360 {
namespace {

nn::DataType TypeOf(const nn::Graph& graph, const nn::Device& device) {
  return device.backend != nullptr ? nn::DataType::kFloat
                                   : nn::ChoosePrecision(device.precision, graph);
}

template <typename T>
std::span<const T> PixelsOf(const cv::Mat& image) {
  return {image.ptr<T>(), image.total() * static_cast<size_t>(image.channels())};
}

}  // namespace

struct DepthCompleter::Network {
  /// A network for one processor.
  struct Prepared {
    Prepared(const nn::Graph& graph, const DepthCompleterOptions& options)
        : type(TypeOf(graph, options.device)),
          model(graph, {options.size.height, options.size.width},
                {.threads = options.threads, .precision = type, .device = options.device}),
          workspace(model) {}

    nn::DataType type;
    nn::DepthCompletion model;
    nn::DepthCompletion::Workspace workspace;
  };

  Network(const std::filesystem::path& weights, DepthCompleterOptions how_to_run)
      : graph(nn::ReadNetwork(weights)), options(std::move(how_to_run)) {
    try {
      prepared = std::make_unique<Prepared>(graph, options);
    } catch (const nn::DeviceError& error) {
      LeaveDevice(error);
      PrepareCpu();
    }
    if (options.device.backend == nullptr) graph = {};
  }

  void LeaveDevice(const nn::DeviceError& error) {
    device_error = error.what();
    options.device = {.precision = options.device.precision};
    prepared.reset();
  }

  /// May throw and be called again, for the memory that is missing now may be there later.
  void PrepareCpu() {
    prepared = std::make_unique<Prepared>(graph, options);
    failure = device_error + "; the network runs on the CPU instead";
    graph = {};
  }

  nn::CompletionOutput Complete(const nn::CompletionInput& input) {
    if (options.device.backend != nullptr) {
      try {
        return prepared->model.Complete(input, &prepared->workspace);
      } catch (const nn::DeviceError& error) {
        LeaveDevice(error);
      }
    }
    if (prepared == nullptr) PrepareCpu();
    return prepared->model.Complete(input, &prepared->workspace);
  }

  nn::Graph graph;  ///< Kept as long as the CPU may have to go on.
  DepthCompleterOptions options;
  std::unique_ptr<Prepared> prepared;  ///< Null where the CPU has not taken over yet.
  std::string device_error;
  std::string failure;
};

DepthCompleter::DepthCompleter(const std::filesystem::path& weights,
                               const DepthCompleterOptions& options)
    : camera_(options.size.width, options.size.height),
      network_(std::make_unique<Network>(weights, options)) {}

DepthCompleter::~DepthCompleter() = default;

const std::string& DepthCompleter::device() const { return network_->options.device.name; }

std::string DepthCompleter::precision() const {
  return network_->prepared == nullptr ? "float" : nn::NameOf(network_->prepared->type);
}

const std::string& DepthCompleter::device_failure() const { return network_->failure; }

DenseDepth DepthCompleter::Complete(const cv::Mat& color, const SparseDepth& sparse) {
  const cv::Size size(camera_.width(), camera_.height());
  ORB360_CHECK(color.type() == CV_8UC3 && color.size() == size, color.cols, color.rows);
  ORB360_CHECK(sparse.range.size() == size && sparse.confidence.size() == size);
  cv::Mat rgb;
  cv::cvtColor(color, rgb, cv::COLOR_BGR2RGB);
  nn::CompletionOutput dense =
      network_->Complete({PixelsOf<unsigned char>(rgb), PixelsOf<float>(sparse.range),
                          PixelsOf<float>(sparse.confidence)});
  DenseDepth depth{cv::Mat(size, CV_32F, dense.depth.data()).clone(),
                   cv::Mat(size, CV_32F, dense.confidence.data()).clone(), color};
  if (!dense.ground.empty()) depth.ground = cv::Mat(size, CV_32F, dense.ground.data()).clone();
  if (dense.log_metric_scale) {
    depth.log_camera_height = std::log(dense.scale) - *dense.log_metric_scale;
  }
  return depth;
}

}  // namespace orb360
