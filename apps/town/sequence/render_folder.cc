#include "apps/town/sequence/render_folder.h"

#include <algorithm>
#include <future>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "apps/town/sequence/sequence_writer.h"
#include <orb360/slam/io/trajectory.h>

namespace orb360::town {
namespace {

constexpr const char* kMoving = "moving";

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
  if (drive.cube_size() > 0)
    text << "stitched_from: " << drive.cube_size() << "  # pixels, width of six cube faces\n";
  text << "samples: " << (drive.sampling() == Sampling::kFull ? "4" : "adaptive")
       << "  # a pixel\n";
  if (drive.camera_height())
    text << "camera_height: " << *drive.camera_height() << "  # metres above the road\n";
  text << "fps: " << drive.fps() << "\nframes: " << frames << "\n"
       << drive.Origin() << Describe(drive.sensor()) << "path_length: " << distance
       << "  # metres\nspeed:  # metres per second\n  mean: "
       << (frames > 1 ? distance * drive.fps() / (frames - 1) : 0.0) << "\n  maximum: " << fastest
       << "\n";
  return text.str();
}

/// The images of a frame that are to be written; empty ones are not.
struct Images {
  cv::Mat3b colour;
  cv::Mat1f range;
  cv::Mat1f exact_range;
  cv::Mat1w objects;
  cv::Mat1b moving;

  bool IsEmpty() const {
    return colour.empty() && range.empty() && exact_range.empty() && objects.empty();
  }
};

/// Renders the images of a frame that do not exist yet.
Images RenderMissing(const Drive& drive, const SequenceWriter& writer, const FolderOptions& options,
                     int frame) {
  const bool has_geometry = frame % options.depth_every == 0;
  const bool needs_masks =
      has_geometry && options.masks &&
      !(writer.Has(SequenceWriter::kObjects, frame) && writer.Has(kMoving, frame));
  const bool needs_range = has_geometry && !writer.Has(SequenceWriter::kRange, frame);
  const bool needs_exr =
      has_geometry && options.exr && !writer.Has(SequenceWriter::kExactRange, frame);
  const bool needs_colour = !writer.Has(SequenceWriter::kColour, frame);
  Images images;
  if (!needs_colour && !needs_range && !needs_exr && !needs_masks) return images;
  const FrameScene scene = drive.SceneAt(frame);
  if (needs_colour) images.colour = drive.Colour(scene, frame);
  if (!needs_range && !needs_exr && !needs_masks) return images;
  GeometryImage geometry = drive.Geometry(scene, frame);
  if (needs_range) images.range = geometry.range;
  if (needs_exr) images.exact_range = geometry.range;
  if (needs_masks) {
    images.objects = geometry.object;
    images.moving = geometry.object >= scene.first_moving_id();
  }
  return images;
}

void Write(const SequenceWriter& writer, int frame, const Images& images) {
  if (!images.colour.empty()) writer.WriteColour(frame, images.colour);
  if (!images.range.empty()) writer.WriteRange(frame, images.range);
  if (!images.exact_range.empty()) writer.WriteExactRange(frame, images.exact_range);
  if (!images.objects.empty()) {
    writer.WriteMask(SequenceWriter::kObjects, frame, images.objects);
    writer.WriteMask(kMoving, frame, images.moving);
  }
}

}  // namespace

void RenderIntoFolder(const Drive& drive, const std::filesystem::path& folder,
                      const FolderOptions& options, const std::function<void(int, int)>& progress) {
  std::vector<std::string> kinds = {SequenceWriter::kColour, SequenceWriter::kRange};
  if (options.exr) kinds.emplace_back(SequenceWriter::kExactRange);
  if (options.masks) kinds.insert(kinds.end(), {SequenceWriter::kObjects, kMoving});
  const SequenceWriter writer(folder, Description(drive), kinds);
  std::vector<StampedPose> poses;
  for (int frame = 0; frame < drive.frames(); ++frame)
    poses.push_back({frame / drive.fps(), drive.WorldFromCamera(frame)});
  WriteTrajectory(folder / "groundtruth.txt", poses);

  // A frame is compressed and written while the next one is rendered.
  std::future<void> writing;
  int rendered = 0;
  for (int frame = 0; frame < drive.frames(); ++frame) {
    Images images = RenderMissing(drive, writer, options, frame);
    if (writing.valid()) writing.get();
    if (frame > 0) progress(frame, rendered);
    if (images.IsEmpty()) continue;
    ++rendered;
    writing = std::async(std::launch::async, [&writer, frame, images = std::move(images)] {
      Write(writer, frame, images);
    });
  }
  if (writing.valid()) writing.get();
  progress(drive.frames(), rendered);
  writer.WriteContactSheet(drive.frames());
}

}  // namespace orb360::town
