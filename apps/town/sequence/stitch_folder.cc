#include "apps/town/sequence/stitch_folder.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "apps/town/image/stitch.h"
#include "apps/town/sequence/sequence_writer.h"
#include "nn/base/number_text.h"
#include "slam/io/atomic_file.h"
#include "slam/io/dataset.h"
#include "slam/io/folder_source.h"
#include "slam/io/image_file.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/trajectory.h>

namespace orb360::town {
namespace {

constexpr const char* kDepthPrefix = "depth_";
constexpr const char* kObjectsPrefix = "objects_";

struct NaturalOrder {
  bool operator()(const std::string& a, const std::string& b) const { return NaturalLess(a, b); }
};
/// The files of the faces of each frame, by the name without extension.
using FaceFiles = std::array<std::filesystem::path, kCubeFaces>;
using FrameFiles = std::map<std::string, FaceFiles, NaturalOrder>;

std::filesystem::path FaceFolder(const std::filesystem::path& recording, const std::string& prefix,
                                 size_t face) {
  return recording / (prefix + std::string(kCubeFaceNames[face]));
}

/// Lists the images in the folders prefix + face name. Every face must have the same names.
FrameFiles ListFrames(const std::filesystem::path& recording, const std::string& prefix) {
  FrameFiles frames;
  for (size_t face = 0; face < kCubeFaces; ++face) {
    const std::filesystem::path folder = FaceFolder(recording, prefix, face);
    if (!std::filesystem::is_directory(folder)) {
      throw UserError(folder.string() +
                      ": no such folder; a recording has front, right, back, left, up and down");
    }
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (IsImageFileName(entry.path())) frames[entry.path().stem().string()][face] = entry.path();
    }
  }
  if (frames.empty())
    throw UserError(FaceFolder(recording, prefix, 0).string() + ": holds no images");
  for (const auto& [name, files] : frames) {
    for (size_t face = 0; face < kCubeFaces; ++face) {
      if (files[face].empty()) {
        throw UserError(FaceFolder(recording, prefix, face).string() + ": frame '" + name +
                        "' is missing, which other faces have");
      }
    }
  }
  return frames;
}

/// Returns the number in which a name ends.
std::optional<int64_t> NumberOf(const std::string& name) {
  return ParseNumber<int64_t>(
      std::string_view(name).substr(name.find_last_not_of("0123456789") + 1));
}

/// The times of frames follow from their order only, so none may be missing.
void RequireEvenNumbers(const std::filesystem::path& recording, const FrameFiles& frames) {
  std::optional<int64_t> step;
  for (auto last = frames.begin(), next = std::next(last); next != frames.end(); ++last, ++next) {
    const std::optional<int64_t> from = NumberOf(last->first);
    const std::optional<int64_t> to = NumberOf(next->first);
    if (!from || !to) return;
    if (step && *to - *from != *step) {
      throw UserError(recording.string() + ": frame '" + last->first + "' is followed by '" +
                      next->first + "', but those before are numbered in steps of " +
                      std::to_string(*step) + "; frames must be evenly spaced in time");
    }
    step = *to - *from;
  }
}

/// Checks that the ground truth has the frames' times and copies it.
void CopyGroundTruth(const std::filesystem::path& from, const std::filesystem::path& to,
                     double duration) {
  const std::vector<StampedPose> poses = ReadTrajectory(from);
  const auto [first, last] = std::ranges::minmax_element(poses, {}, &StampedPose::timestamp);
  if (last->timestamp < 0 || first->timestamp > duration) {
    throw UserError(from.string() + ": is of " + ToText(first->timestamp) + " to " +
                    ToText(last->timestamp) + " s, but the frames of 0 to " + ToText(duration) +
                    " s; the first frame's time must be 0");
  }
  std::ifstream file(from, std::ios::binary);
  std::stringstream content;
  content << file.rdbuf();
  WriteFileAtomically(to, content.str());
}

void RequireFaceSize(const std::filesystem::path& path, const cv::Mat& image, int size) {
  if (image.rows == image.cols && image.rows >= 3 && (size == 0 || image.rows == size)) return;
  std::ostringstream message;
  message << path.string() << ": is " << image.cols << "x" << image.rows
          << ", but faces are square";
  if (size != 0) message << " and the others " << size << "x" << size;
  throw UserError(message.str());
}

cv::Mat3b StitchColourFiles(const FaceFiles& files, const EquirectangularCamera& camera) {
  CubeImages<cv::Vec3b> faces;
  for (size_t face = 0; face < kCubeFaces; ++face) {
    const LoadedImage loaded = LoadImage(files[face]);
    if (loaded.image.empty()) throw UserError(files[face].string() + ": " + loaded.problem);
    RequireFaceSize(files[face], loaded.image, faces[0].rows);
    faces[face] = loaded.image;
  }
  return StitchColour(faces, camera);
}

/// Returns true for an image with several shades of gray only: depth for the eye, not 24-bit
/// numbers.
bool IsGrey(const cv::Mat& image) {
  std::vector<cv::Mat> channels;
  cv::split(image, channels);
  double least = 0;
  double most = 0;
  cv::minMaxLoc(channels[0], &least, &most);
  return least < most && cv::norm(channels[0], channels[1], cv::NORM_INF) == 0 &&
         cv::norm(channels[0], channels[2], cv::NORM_INF) == 0;
}

cv::Mat1f ReadDepth(const std::filesystem::path& path, double farthest) {
  const cv::Mat image =
      path.extension() == ".png" ? cv::imread(path.string(), cv::IMREAD_UNCHANGED) : cv::Mat();
  if (image.type() == CV_16UC1 && !image.empty()) {
    cv::Mat1f depth;
    image.convertTo(depth, CV_32F, 1.0 / 256);
    return depth;
  }
  if (image.depth() == CV_8U && image.channels() >= 3 && !IsGrey(image))
    return DecodeDepth24(image, farthest);
  throw UserError(path.string() +
                  ": is not depth, which is a PNG of 16 bits and one channel (metres * 256) or of "
                  "colours that are 24-bit numbers");
}

cv::Mat1f StitchRangeFiles(const FaceFiles& files, double farthest,
                           const EquirectangularCamera& camera) {
  CubeImages<float> faces;
  for (size_t face = 0; face < kCubeFaces; ++face) {
    const cv::Mat1f depth = ReadDepth(files[face], farthest);
    RequireFaceSize(files[face], depth, faces[0].rows);
    faces[face] = depth;
  }
  return StitchRange(faces, camera);
}

cv::Mat1w StitchObjectFiles(const FaceFiles& files, const EquirectangularCamera& camera) {
  CubeImages<uint16_t> faces;
  for (size_t face = 0; face < kCubeFaces; ++face) {
    const cv::Mat image = cv::imread(files[face].string(), cv::IMREAD_UNCHANGED);
    if (image.empty() || (image.type() != CV_8UC1 && image.type() != CV_16UC1)) {
      throw UserError(files[face].string() +
                      ": does not number objects, which takes an image of one channel of 8 or 16 "
                      "bits");
    }
    RequireFaceSize(files[face], image, faces[0].rows);
    image.convertTo(faces[face], CV_16U);
  }
  return StitchObjects(faces, camera);
}

/// Lists the files in the folders with a prefix if there are such folders; every frame must have
/// images.
FrameFiles ListOptionalFrames(const std::filesystem::path& recording, const std::string& prefix,
                              const FrameFiles& images) {
  bool is_there = false;
  for (size_t face = 0; face < kCubeFaces; ++face)
    is_there |= std::filesystem::exists(FaceFolder(recording, prefix, face));
  if (!is_there) return {};
  FrameFiles frames = ListFrames(recording, prefix);
  for (const auto& [name, files] : frames) {
    if (!images.contains(name)) throw UserError(files[0].string() + ": has no image");
  }
  return frames;
}

std::string Description(const StitchOptions& options, const EquirectangularCamera& camera,
                        size_t frames, bool has_depth) {
  std::ostringstream text;
  text << "camera:\n  model: equirectangular\n  width: " << camera.width()
       << "\n  height: " << camera.height() << "\n";
  if (options.camera_height)
    text << "camera_height: " << *options.camera_height << "  # metres above the road\n";
  text << "fps: " << options.fps << "\nframes: " << frames << "\n";
  if (has_depth) {
    text << "farthest_depth: " << options.farthest_depth
         << "  # metres, of 24-bit depth it was made from\n";
  }
  return text.str();
}

}  // namespace

void StitchFolder(const std::filesystem::path& recording, const std::filesystem::path& folder,
                  const StitchOptions& options, const std::function<void(int, int)>& progress) {
  const FrameFiles frames = ListFrames(recording, "");
  RequireEvenNumbers(recording, frames);
  const FrameFiles depth = ListOptionalFrames(recording, kDepthPrefix, frames);
  const FrameFiles objects = ListOptionalFrames(recording, kObjectsPrefix, frames);

  const EquirectangularCamera camera(options.width, options.width / 2);
  std::vector<std::string> kinds = {SequenceWriter::kColour};
  if (!depth.empty()) kinds.emplace_back(SequenceWriter::kRange);
  if (!objects.empty()) kinds.emplace_back(SequenceWriter::kObjects);
  const SequenceWriter writer(folder, Description(options, camera, frames.size(), !depth.empty()),
                              kinds);
  const std::filesystem::path truth = recording / Dataset::kGroundTruthName;
  if (std::filesystem::exists(truth)) {
    CopyGroundTruth(truth, folder / Dataset::kGroundTruthName,
                    static_cast<double>(frames.size() - 1) / options.fps);
  }
  const int all = static_cast<int>(frames.size());
  int frame = 0;
  for (const auto& [name, files] : frames) {
    if (!writer.Has(SequenceWriter::kColour, frame))
      writer.WriteColour(frame, StitchColourFiles(files, camera));
    const auto with_depth = depth.find(name);
    if (with_depth != depth.end() && !writer.Has(SequenceWriter::kRange, frame)) {
      writer.WriteRange(frame,
                        StitchRangeFiles(with_depth->second, options.farthest_depth, camera));
    }
    const auto with_objects = objects.find(name);
    if (with_objects != objects.end() && !writer.Has(SequenceWriter::kObjects, frame)) {
      writer.WriteMask(SequenceWriter::kObjects, frame,
                       StitchObjectFiles(with_objects->second, camera));
    }
    progress(++frame, all);
  }
  writer.WriteContactSheet(all);
}

}  // namespace orb360::town
