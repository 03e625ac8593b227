#include <algorithm>
#include <exception>
#include <filesystem>
#include <functional>
#include <thread>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "slam/io/bounded_queue.h"
#include "slam/io/dataset.h"
#include "slam/io/file_extension.h"
#include "slam/io/folder_source.h"
#include "slam/io/full_sphere.h"
#include "slam/io/image_file.h"
#include "slam/io/lenses/dual_fisheye_images.h"
#include "slam/io/lenses/dual_fisheye_video.h"
#include "slam/io/lenses/lens_video_source.h"
#include "slam/io/video/video_source.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/sequence.h>

namespace orb360 {
namespace {

/// Number of frames that are decoded ahead: enough to bridge the work on a keyframe, and 50 MB of
/// 4K images.
constexpr size_t kFramesAhead = 4;

/// Number of frames, among `count` source frames, that start, stride and max_frames select.
int SelectedCount(int count, const SequenceOptions& options) {
  const int strided = count <= options.start ? 0 : (count - options.start - 1) / options.stride + 1;
  return options.max_frames > 0 ? std::min(strided, options.max_frames) : strided;
}

cv::Mat Resized(const cv::Mat& image, cv::Size size) {
  if (image.size() == size) return image;
  const bool shrinks = size.width <= image.cols && size.height <= image.rows;
  cv::Mat resized;
  cv::resize(image, resized, size, 0.0, 0.0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
  return resized;
}

std::unique_ptr<FrameSource> OpenSource(const std::string& input, const std::string& lens) {
  if (!std::filesystem::exists(input)) throw UserError(input + ": no such file or folder");
  if (!lens.empty() && std::filesystem::is_directory(input)) {
    return OpenDualFisheyeImages(input, FindLensCalibration(lens));
  }
  if (IsDataset(input)) {
    const Dataset dataset = OpenDataset(input);
    if (!std::filesystem::is_directory(dataset.images())) {
      throw UserError(input + ": has a sequence.yaml but no folder rgb/ with images");
    }
    return std::make_unique<FolderSource>(dataset.images(), dataset.images().string(),
                                          dataset.frame_rate, dataset.camera_height);
  }
  if (std::filesystem::is_directory(input)) return std::make_unique<FolderSource>(input, input);
  if (IsImageFileName(input)) {
    throw UserError(input + ": is a single image; give a video or a folder of images");
  }
  if (!lens.empty()) return OpenDualFisheyeVideo(input, FindLensCalibration(lens));
  if (LowerCaseExtension(input) == ".360") return OpenEacVideo(input);
  const bool is_insta360 = LowerCaseExtension(input) == ".insv";
  if (is_insta360 || LowerCaseExtension(input) == ".osv") {
    throw UserError(input +
                    ": is a raw recording of two fisheye lenses; give their calibration with "
                    "--lens, such as --lens " +
                    (is_insta360 ? "insta360" : "dji-osmo360") +
                    ", or export it as equirectangular video");
  }
  return std::make_unique<VideoSource>(input);
}

}  // namespace

class Sequence::Decoder {
 public:
  /// One item that the decoding thread hands over.
  struct Step {
    std::optional<Frame> frame;
    std::vector<std::string> warnings;
    std::exception_ptr error;
  };

  /// `image_size`: of the frames that it gives.
  Decoder(std::unique_ptr<FrameSource> source, const SequenceOptions& options, cv::Size image_size)
      : source_(std::move(source)),
        options_(options),
        image_size_(image_size),
        queue_(kFramesAhead),
        thread_([this] { DecodeAhead(); }) {}
  ~Decoder() {
    queue_.Close();
    thread_.join();
  }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  /// Waits for the next item; nullopt at the end.
  std::optional<Step> Next() { return queue_.Pop(); }

 private:
  void DecodeAhead();
  bool DecodeAll();
  bool DecodeOnly();
  bool Push(Frame frame);

  const std::unique_ptr<FrameSource> source_;
  const SequenceOptions options_;
  const cv::Size image_size_;
  BoundedQueue<Step> queue_;
  std::thread thread_;  // the last member, because it uses the others
};

void Sequence::Decoder::DecodeAhead() {
  Step last;
  try {
    if (!(options_.only.empty() ? DecodeAll() : DecodeOnly())) return;
  } catch (...) {
    last.error = std::current_exception();
  }
  last.warnings = source_->TakeWarnings();
  queue_.Push(std::move(last));
  queue_.Close();
}

/// Pushes every selected frame. Returns false when the queue has been closed.
bool Sequence::Decoder::DecodeAll() {
  for (int i = 0; i < options_.start; ++i) {
    if (!source_->Skip()) return true;
  }
  for (int given = 0; options_.max_frames == 0 || given < options_.max_frames;) {
    std::optional<Frame> frame = source_->Read();
    if (!frame) return true;
    if (!frame->image.empty()) {
      if (!Push(std::move(*frame))) return false;
      ++given;
    }
    for (int i = 1; i < options_.stride; ++i) {
      if (!source_->Skip()) return true;
    }
  }
  return true;
}

/// Pushes the frames that were asked for one by one. Returns false when the queue has been closed.
bool Sequence::Decoder::DecodeOnly() {
  int next = 0;
  for (const int index : options_.only) {
    for (; next < index; ++next) {
      if (!source_->Skip()) return true;
    }
    std::optional<Frame> frame = source_->Read();
    if (!frame) return true;
    ++next;
    if (!frame->image.empty() && !Push(std::move(*frame))) return false;
  }
  return true;
}

/// Hands over a frame. Returns false when the queue has been closed.
bool Sequence::Decoder::Push(Frame frame) {
  frame.image = Resized(frame.image, image_size_);
  if (options_.fps > 0.0) frame.timestamp = frame.index / options_.fps;
  return queue_.Push({std::move(frame), source_->TakeWarnings(), nullptr});
}

Sequence::Sequence(std::unique_ptr<FrameSource> source, const SequenceOptions& options)
    : options_(options), name_(source->info().name), camera_height_(source->info().camera_height) {
  ORB360_CHECK(
      options.fps >= 0.0 && options.stride >= 1 && options.start >= 0 && options.max_frames >= 0 &&
          std::ranges::adjacent_find(options.only, std::greater_equal()) == options.only.end(),
      options.fps, options.stride, options.start, options.max_frames, options.resize);
  const SourceInfo& info = source->info();
  RequireFullSphere(name_, info.image_size);
  image_size_ = options.resize.empty() ? info.image_size : options.resize;
  frame_rate_ = options.fps > 0.0 ? options.fps : info.frame_rate;
  if (!info.coverage.empty()) {
    // What interpolation mixes with the black around the image is left out as well.
    coverage_ = Resized(info.coverage, image_size_) == 255;
  }
  if (info.frame_count) frame_count_ = SelectedCount(*info.frame_count, options);
  if (!options.only.empty()) frame_count_ = static_cast<int>(options.only.size());
  decoder_ = std::make_unique<Decoder>(std::move(source), options, image_size_);
}

Sequence::~Sequence() = default;

std::optional<Frame> Sequence::Next() {
  std::optional<Decoder::Step> step = decoder_->Next();
  if (!step) return std::nullopt;
  warnings_.insert(warnings_.end(), step->warnings.begin(), step->warnings.end());
  if (step->error) std::rethrow_exception(step->error);
  if (step->frame) {
    has_given_frame_ = true;
  } else if (!has_given_frame_) {
    throw UserError(options_.start == 0
                        ? name_ + ": no frame of it can be decoded"
                        : name_ + ": has no frame " + std::to_string(options_.start) +
                              " or later to start at");
  }
  return step->frame;
}

std::unique_ptr<Sequence> OpenSequence(const std::string& input, const SequenceOptions& options) {
  return std::make_unique<Sequence>(OpenSource(input, options.lens), options);
}

}  // namespace orb360
