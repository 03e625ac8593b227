#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include <orb360/slam/pipeline/reconstruction.h>

namespace orb360 {

/// Images of dense depth, CV_8UC3, BGR; empty where there is no dense depth.
struct DenseImages {
  cv::Mat cloud;  ///< The cloud from above (CloudImage).
  struct OfView {
    int frame_index = 0;
    cv::Mat image;  ///< A view's depth (DrawDepth).
  };
  std::vector<OfView> views;
};

/// Writes `report/` in the folder of a run: the images as PNG, and report.html, which contains the
/// images, the map (`map_svg`, empty where there is none) and the figures of `summary`. Throws
/// UserError where that fails.
void WriteRunReport(const std::filesystem::path& run_folder, const Reconstruction& reconstruction,
                    const nlohmann::json& summary, const std::string& map_svg,
                    const DenseImages& images);

}  // namespace orb360
