#pragma once

#include <string>

#include <orb360/slam/depth/dense_depth.h>

namespace orb360 {

/// The range and confidence of a view for the page, little endian: width and height (uint32), then
/// for each pixel, row by row, a code of its range (uint16), then for each its confidence in 1/255
/// (uint8). A code is 32768 + 1024 ln(range), range in units of the world, so that its error is at
/// most 0.05 %; 0 where there is none. `max_width`: wider views are thinned to every n-th pixel of
/// every n-th row.
std::string ViewRangeBytes(const DenseDepth& depth, int max_width);

/// An image (CV_8UC3, BGR) as JPEG, at most `max_width` pixels wide.
std::string ImageBytes(const cv::Mat& image, int max_width);

}  // namespace orb360
