#include "apps/town/sequence/folder.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/check.h"
#include "slam/io/atomic_file.h"
#include "slam/io/depth_image.h"
#include "slam/io/trajectory.h"

namespace orb360::town {
namespace {

constexpr int kJpegQuality = 95;

std::filesystem::path FramePath(const std::filesystem::path& folder, const char* kind, int frame,
                                const char* extension) {
  char name[32];
  std::snprintf(name, sizeof name, "%06d.%s", frame, extension);
  return folder / kind / name;
}

void WriteImage(const std::filesystem::path& path, const cv::Mat& image,
                const std::vector<int>& parameters) {
  std::vector<uchar> bytes;
  cv::imencode(path.extension().string(), image, bytes, parameters);
  WriteFileAtomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::string Description(const Drive& drive) {
  const int frames = drive.frames();
  double distance = 0;
  double fastest = 0;
  for (int frame = 1; frame < frames; ++frame) {
    const double step =
        (drive.WorldFromCamera(frame).translation - drive.WorldFromCamera(frame - 1).translation)
            .norm();
    distance += step;
    fastest = std::max(fastest, step * drive.fps());
  }
  std::ostringstream text;
  text << "camera:\n  model: equirectangular\n  width: " << drive.camera().width()
       << "\n  height: " << drive.camera().height() << "\n";
  if (drive.camera_height())
    text << "camera_height: " << *drive.camera_height() << "  # metres above the road\n";
  text << "fps: " << drive.fps() << "\nframes: " << frames << "\n"
       << drive.Origin() << "path_length: " << distance
       << "  # metres\nspeed:  # metres per second\n  mean: "
       << (frames > 1 ? distance * drive.fps() / (frames - 1) : 0.0) << "\n  maximum: " << fastest
       << "\n";
  return text.str();
}

/// Writes the description, or makes sure that the one that is there is the same.
void ClaimFolder(const std::filesystem::path& folder, const std::string& description) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw UserError("cannot create the folder " + folder.string() + ": " + error.message());
  const std::filesystem::path path = folder / "sequence.yaml";
  if (std::ifstream file(path); file) {
    std::stringstream found;
    found << file.rdbuf();
    if (found.str() != description) {
      throw UserError(folder.string() +
                      " holds a sequence made with other options (see its sequence.yaml): choose "
                      "another --out or delete it");
    }
    return;
  }
  WriteFileAtomically(path, description);
}

void MakeFolder(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw UserError("cannot create the folder " + path.string() + ": " + error.message());
}

/// Evenly spread frames of a finished sequence side by side.
void WriteContactSheet(const std::filesystem::path& folder, int frames) {
  constexpr int kColumns = 4;
  constexpr int kRows = 6;
  const cv::Size tile(480, 240);
  cv::Mat3b sheet(kRows * tile.height, kColumns * tile.width, cv::Vec3b(0, 0, 0));
  const int tiles = std::min(frames, kColumns * kRows);
  for (int i = 0; i < tiles; ++i) {
    const int frame = static_cast<int>(static_cast<int64_t>(i) * frames / tiles);
    const cv::Mat image = cv::imread(FramePath(folder, "rgb", frame, "jpg").string());
    if (image.empty()) continue;
    cv::Mat small;
    cv::resize(image, small, tile, 0, 0, cv::INTER_AREA);
    small.copyTo(
        sheet(cv::Rect(cv::Point(i % kColumns * tile.width, i / kColumns * tile.height), tile)));
  }
  WriteImage(folder / "contact_sheet.jpg",
             sheet.rowRange(0, (tiles + kColumns - 1) / kColumns * tile.height),
             {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
}

}  // namespace

void RenderIntoFolder(const Drive& drive, const std::filesystem::path& folder,
                      const FolderOptions& options, const std::function<void(int, int)>& progress) {
  ClaimFolder(folder, Description(drive));
  MakeFolder(folder / "rgb");
  MakeFolder(folder / "depth");
  if (options.masks) {
    MakeFolder(folder / "objects");
    MakeFolder(folder / "moving");
  }
  std::vector<StampedPose> poses;
  for (int frame = 0; frame < drive.frames(); ++frame)
    poses.push_back({frame / drive.fps(), drive.WorldFromCamera(frame)});
  WriteTrajectory(folder / "groundtruth.txt", poses);

  int rendered = 0;
  for (int frame = 0; frame < drive.frames(); ++frame) {
    const auto missing = [&](const char* kind, const char* extension) {
      return !std::filesystem::exists(FramePath(folder, kind, frame, extension));
    };
    const bool has_geometry = frame % options.depth_every == 0;
    const bool needs_masks =
        has_geometry && options.masks && (missing("objects", "png") || missing("moving", "png"));
    const bool needs_range = has_geometry && missing("depth", "png");
    const bool needs_colour = missing("rgb", "jpg");
    if (needs_colour || needs_range || needs_masks) {
      const FrameScene scene = drive.SceneAt(frame);
      if (needs_colour)
        WriteImage(FramePath(folder, "rgb", frame, "jpg"), drive.Colour(scene, frame),
                   {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
      if (needs_range || needs_masks) {
        const GeometryImage geometry = drive.Geometry(scene, frame);
        if (needs_range) WriteDepthImage(FramePath(folder, "depth", frame, "png"), geometry.range);
        if (needs_masks) {
          WriteImage(FramePath(folder, "objects", frame, "png"), geometry.object, {});
          WriteImage(FramePath(folder, "moving", frame, "png"),
                     geometry.object >= scene.first_moving_id(), {});
        }
      }
      ++rendered;
    }
    progress(frame + 1, rendered);
  }
  WriteContactSheet(folder, drive.frames());
}

}  // namespace orb360::town
