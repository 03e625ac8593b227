#include "slam/io/lenses/dual_fisheye_images.h"

#include <string>

#include "slam/io/folder_source.h"
#include "slam/io/lenses/dual_fisheye_stitcher.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

std::unique_ptr<FrameSource> OpenDualFisheyeImages(const std::filesystem::path& folder,
                                                   const LensCalibration& calibration) {
  const std::string name = folder.string();
  RequireSideBySide(calibration, name);
  return std::make_unique<FolderSource>(
      folder, name, std::nullopt, std::nullopt, [&](cv::Size stored) {
        const std::vector<cv::Size> sizes(2, {stored.width / 2, stored.height});
        const auto stitcher =
            std::make_shared<SphereStitcher>(MakeDualFisheyeStitcher(calibration, sizes, name));
        return SphereMapping{stitcher->sphere(), stitcher->coverage(),
                             [stitcher](const cv::Mat& image) {
                               return stitcher->Stitch(Halves(image), kMatchesExposure);
                             }};
      });
}

}  // namespace orb360
