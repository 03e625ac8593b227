#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/orb360/commands.h"
#include "slam/depth/dense_ground.h"
#include "slam/io/atomic_file.h"
#include "slam/io/full_sphere.h"
#include "slam/io/image_file.h"
#include "slam/io/json_text.h"
#include "slam/io/sparse_file.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/models/default_weights.h>
#include <orb360/slam/depth/depth_completer.h>
#include <orb360/slam/io/depth_image.h>

namespace orb360 {
namespace {

struct CompleteOptions {
  std::string image;
  std::string sparse;
  std::string weights;
  std::string out;
  int threads = 0;  // 0: as many as the machine has
  DeviceOptions device;
  bool json = false;
};

/// Ranges with their confidence, CV_32F, and the image of them where the file contains it.
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
  // A depth image contains no confidences, so all points have the same.
  cv::Mat(range > 0).convertTo(confidence, CV_32F, 1.0 / 255.0);
  return {{}, {range, confidence}};
}

cv::Mat ReadImage(const std::string& path) {
  const LoadedImage loaded = LoadImage(path);
  if (loaded.image.empty()) throw UserError(path + ": " + loaded.problem);
  return loaded.image;
}

/// Returns "DIR/NAME_WHAT.png" for "DIR/NAME.png".
std::filesystem::path Beside(const std::filesystem::path& depth, const char* what) {
  std::filesystem::path name = depth.stem();
  name += what;
  name += ".png";
  return depth.parent_path() / name;
}

/// The network, prepared again whenever the size of the images changes.
class Completer {
 public:
  explicit Completer(const CompleteOptions& options)
      : options_(options), device_(options.device.Open()) {
    if (!device_.passed_over.empty()) {
      std::cerr << "orb360: warning: " << PassedOverWarning(device_) << '\n';
    }
  }

  DenseDepth Complete(const cv::Mat& image, const SparseDepth& sparse) {
    if (!completer_ || completer_->camera().width() != image.cols ||
        completer_->camera().height() != image.rows) {
      Prepare(image.size());
    }
    DenseDepth dense = completer_->Complete(image, sparse);
    if (!completer_->device_failure().empty() && device_.backend != nullptr) {
      std::cerr << "orb360: warning: " << completer_->device_failure() << '\n';
      device_ = {.precision = device_.precision};
    }
    return dense;
  }
  /// Returns the name of the processor that completed the last image.
  const std::string& device() const { return completer_->device(); }
  /// Returns in which type its convolutions multiplied.
  std::string precision() const { return completer_->precision(); }

 private:
  void Prepare(cv::Size size) {
    const int threads = options_.threads > 0
                            ? options_.threads
                            : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    completer_.reset();
    completer_.emplace(options_.weights,
                       DepthCompleterOptions{.size = size, .threads = threads, .device = device_});
  }

  const CompleteOptions options_;
  nn::Device device_;
  std::optional<DepthCompleter> completer_;
};

/// Completes one sparse input, writes the result to `out` and returns a description of it.
nlohmann::json CompleteOne(const CompleteOptions& options, const std::filesystem::path& sparse_path,
                           const std::filesystem::path& out, Completer* completer) {
  const SparseInput sparse = ReadSparse(sparse_path);
  if (options.image.empty() && sparse.image.empty()) {
    throw UserError(sparse_path.string() + ": has no image; give one with --image");
  }
  const cv::Mat image = options.image.empty() ? sparse.image : ReadImage(options.image);
  const cv::Size size = image.size();
  if (sparse.depth.range.size() != size) {
    throw UserError(sparse_path.string() + ": is " + ToString(sparse.depth.range.size()) +
                    ", but the image is " + ToString(size) + "; both must have one size");
  }
  if (options.image.empty()) {
    RequireFullSphere(sparse_path.string(), size);
  } else {
    RequireFullSphere(options.image, size);
  }
  const DenseDepth dense = completer->Complete(image, sparse.depth);
  const auto write_fraction = [&](const char* what, const cv::Mat& fraction) {
    const std::filesystem::path path = Beside(out, what);
    WriteFractionImage(path, fraction);
    return path.string();
  };
  WriteDepthImage(out, dense.range);
  nlohmann::json result = {{"sparse", sparse_path.string()},
                           {"depth", out.string()},
                           {"confidence", write_fraction("_confidence", dense.confidence)},
                           {"device", completer->device()},
                           {"precision", completer->precision()}};
  if (!dense.ground.empty()) result["ground"] = write_fraction("_ground", dense.ground);
  if (dense.log_camera_height) {
    result["camera_height_guess"] = std::exp(*dense.log_camera_height);
  }
  if (const auto ground = FindGround(dense, Eigen::Vector3d::UnitZ(), {})) {
    result["camera_height"] = std::exp(ground->log_height);
    result["camera_height_log_sigma"] = ground->sigma;
  }
  return result;
}

/// Returns the files of `run --save-sparse` in a folder, ordered by name.
std::vector<std::filesystem::path> SparseFiles(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".h5") files.push_back(entry.path());
  }
  if (files.empty()) {
    throw UserError(folder.string() + ": has no .h5 file as `orb360 run --save-sparse` writes it");
  }
  std::ranges::sort(files);
  return files;
}

int Complete(const CompleteOptions& options) {
  const bool is_folder = std::filesystem::is_directory(options.sparse);
  if (is_folder && !options.image.empty()) {
    throw UserError("--image is for one file: those of a folder have images of their own");
  }
  Completer completer(options);
  nlohmann::json results = nlohmann::json::array();
  if (is_folder) {
    const std::filesystem::path out = options.out;
    std::error_code error;
    std::filesystem::create_directories(out, error);
    if (error) throw UserError(options.out + ": cannot be created: " + error.message());
    for (const std::filesystem::path& path : SparseFiles(options.sparse)) {
      std::filesystem::path name = path.stem();
      name += ".png";
      results.push_back(CompleteOne(options, path, out / name, &completer));
    }
  } else {
    results.push_back(CompleteOne(options, options.sparse, options.out, &completer));
  }
  if (options.json) {
    std::cout << ToJsonText(results, 2) << '\n';
    return EXIT_SUCCESS;
  }
  for (const nlohmann::json& result : results) {
    std::cout << "wrote " << result["depth"].get<std::string>() << " and "
              << result["confidence"].get<std::string>();
    if (result.contains("ground")) {
      std::cout << " and " << result["ground"].get<std::string>();
    }
    std::cout << '\n';
  }
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
                   "16-bit PNG of metres * 256, 0 for none, or HDF5 of `run --save-sparse`; or a "
                   "folder of such HDF5 files, which are all completed")
      ->required();
  command->add_option("--weights", options->weights,
                      "Network [the one that comes with the program]");
  command
      ->add_option("--out", options->out,
                   "Depth as PNG of metres * 256; beside it go the confidence as "
                   "NAME_confidence.png and the probability of the ground as NAME_ground.png, both "
                   "times 65535; for a folder, a folder")
      ->required();
  command->add_flag(
      "--json", options->json,
      "Print what was written, and the height of the camera over the ground: from the "
      "plane through the depth there, and as the network guesses it");
  command->add_option("--threads", options->threads, "0: as many as the machine has")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  AddDeviceOptions(command, &options->device);
  command->callback([options, chosen] {
    *chosen = [options] {
      if (options->weights.empty()) options->weights = nn::DefaultWeights().string();
      return Complete(*options);
    };
  });
}

}  // namespace orb360
