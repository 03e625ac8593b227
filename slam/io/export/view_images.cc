#include "slam/io/export/view_images.h"

#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "slam/io/atomic_file.h"
#include "slam/io/export/make_folder.h"
#include "slam/io/export/view_resampler.h"
#include "slam/io/image_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Makes the folder of each view's files.
void MakeViewFolders(const ExportScene& scene, const std::filesystem::path& folder) {
  for (const View& view : scene.views) MakeFolder(folder / view.name);
}

}  // namespace

Frame ReadFrame(Sequence* sequence, int index, const std::string& input) {
  std::optional<Frame> frame = sequence->Next();
  while (frame && frame->index < index) frame = sequence->Next();
  if (!frame || frame->index != index) {
    throw UserError(input + ": has no frame " + std::to_string(index) +
                    ", which the run has tracked; give the run's input with --input");
  }
  return *std::move(frame);
}

int WriteViewImages(const ExportScene& scene, const std::string& input, Sequence* sequence,
                    const std::filesystem::path& folder, const ExportProgress& progress) {
  const std::filesystem::path images = folder / kImagesFolder;
  MakeViewFolders(scene, images);
  const ViewResampler resampler({scene.model.width, scene.model.height}, scene.views);
  const int count = static_cast<int>(scene.model.frames.size());
  int done = 0;
  for (const PosedFrame& frame : scene.model.frames) {
    const Frame read = ReadFrame(sequence, frame.index, input);
    // Encoding takes most of the time, so each view has a thread.
    std::vector<std::exception_ptr> errors(scene.views.size());
#pragma omp parallel for schedule(dynamic, 1)
    for (size_t v = 0; v < scene.views.size(); ++v) {
      try {
        WriteImage(images / ImageName(scene, frame, scene.views[v]),
                   resampler.Resample(read.image, v));
      } catch (...) {
        errors[v] = std::current_exception();
      }
    }
    for (const std::exception_ptr& error : errors) {
      if (error) std::rethrow_exception(error);
    }
    if (progress && !progress(++done, count)) return done;
  }
  return count;
}

void WriteViewMasks(const ExportScene& scene, const cv::Mat& mask,
                    const std::filesystem::path& folder) {
  const std::filesystem::path masks = folder / kMasksFolder;
  MakeViewFolders(scene, masks);
  const ViewResampler resampler({scene.model.width, scene.model.height}, scene.views);
  for (size_t v = 0; v < scene.views.size(); ++v) {
    const cv::Mat image = resampler.ResampleNearest(mask, v);
    for (const PosedFrame& frame : scene.model.frames) {
      WriteImage(masks / MaskName(ImageName(scene, frame, scene.views[v])), image);
    }
  }
}

}  // namespace orb360
