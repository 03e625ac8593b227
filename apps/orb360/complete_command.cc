#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/orb360/commands.h"
#include "nn/base/check.h"
#include "nn/graph/network_file.h"
#include "nn/models/depth_completion.h"
#include "slam/io/atomic_file.h"
#include "slam/io/depth_image.h"
#include "slam/io/image_file.h"
#include "slam/io/sparse_file.h"

namespace orb360 {
namespace {

struct CompleteOptions {
  std::string image;
  std::string sparse;
  std::string weights;
  std::string out;
  int threads = 0;  // 0: as many as the machine has
  bool uses_bfloat16 = false;
};

/// Ranges with their confidence, CV_32F; the picture they belong to where the file has it.
struct SparseInput {
  cv::Mat image;
  SparseDepth depth;
};

SparseInput ReadSparse(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) throw UserError(path.string() + ": no such file");
  if (path.extension() == ".h5") {
    const SparseSample sample = ReadSparseSample(path);
    return {sample.image, sample.sparse};
  }
  const cv::Mat range = ReadDepthImage(path);
  cv::Mat confidence;
  // A depth image has no confidences: every point counts the same.
  cv::Mat(range > 0).convertTo(confidence, CV_32F, 1.0 / 255.0);
  return {{}, {range, confidence}};
}

cv::Mat ReadPicture(const std::string& path) {
  const LoadedImage loaded = LoadImage(path);
  if (loaded.image.empty()) throw UserError(path + ": " + loaded.problem);
  return loaded.image;
}

std::string ToText(const cv::Size& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

std::filesystem::path ConfidencePath(const std::filesystem::path& depth) {
  std::filesystem::path name = depth.stem();
  name += "_confidence.png";
  return depth.parent_path() / name;
}

/// 16-bit PNG of confidence * 65535.
void WriteConfidenceImage(const std::filesystem::path& path, const cv::Mat& confidence) {
  constexpr double kOne = 65535;
  cv::Mat units;
  confidence.convertTo(units, CV_16U, kOne);  // rounds, and keeps what is outside 0..1 inside
  std::vector<unsigned char> png;
  cv::imencode(".png", units, png);
  WriteFileAtomically(path, {reinterpret_cast<const char*>(png.data()), png.size()});
}

template <typename T>
std::span<const T> PixelsOf(const cv::Mat& image) {
  ORB360_CHECK(image.isContinuous());
  return {image.ptr<T>(), image.total() * static_cast<std::size_t>(image.channels())};
}

int Complete(const CompleteOptions& options) {
  const SparseInput sparse = ReadSparse(options.sparse);
  if (options.image.empty() && sparse.image.empty()) {
    throw UserError(options.sparse + ": has no picture; give one with --image");
  }
  const cv::Mat image = options.image.empty() ? sparse.image : ReadPicture(options.image);
  const cv::Size size = image.size();
  if (sparse.depth.range.size() != size) {
    throw UserError(options.sparse + ": is " + ToText(sparse.depth.range.size()) +
                    ", but the image is " + ToText(size) + "; both must have one size");
  }
  const int threads = options.threads > 0
                          ? options.threads
                          : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const nn::DepthCompletion model(
      nn::ReadNetwork(options.weights), {size.height, size.width},
      {.threads = threads,
       .precision = options.uses_bfloat16 ? nn::DataType::kBFloat16 : nn::DataType::kFloat});
  nn::DepthCompletion::Workspace workspace(model);
  cv::Mat rgb;
  cv::cvtColor(image, rgb, cv::COLOR_BGR2RGB);
  nn::DensePicture dense =
      model.Complete({PixelsOf<unsigned char>(rgb), PixelsOf<float>(sparse.depth.range),
                      PixelsOf<float>(sparse.depth.confidence)},
                     &workspace);
  const std::filesystem::path confidence = ConfidencePath(options.out);
  WriteDepthImage(options.out, cv::Mat(size, CV_32F, dense.depth.data()));
  WriteConfidenceImage(confidence, cv::Mat(size, CV_32F, dense.confidence.data()));
  std::cout << "wrote " << options.out << " and " << confidence.string() << '\n';
  return EXIT_SUCCESS;
}

}  // namespace

void AddCompleteCommand(CLI::App* app, Command* chosen) {
  CLI::App* command =
      app->add_subcommand("complete", "Make the sparse depth of a panorama dense with a network");
  const auto options = std::make_shared<CompleteOptions>();
  command->add_option("--image", options->image,
                      "Panorama; may be left out where --sparse contains it");
  command
      ->add_option("--sparse", options->sparse,
                   "16-bit PNG of metres * 256, 0 for none, or HDF5 of `run --save-sparse`")
      ->required();
  command->add_option("--weights", options->weights, "Network")->required();
  command
      ->add_option("--out", options->out,
                   "Depth as PNG of metres * 256; the confidence goes beside it as "
                   "NAME_confidence.png, times 65535")
      ->required();
  command->add_option("--threads", options->threads, "0: as many as the machine has")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_flag("--bfloat16", options->uses_bfloat16,
                    "Convolve in bfloat16: faster and less exact, on processors that have it");
  command->callback([options, chosen] { *chosen = [options] { return Complete(*options); }; });
}

}  // namespace orb360
