#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

namespace orb360 {

/// Writes ranges (CV_32FC1, metres along each pixel's ray, 0 for none) as a 16-bit PNG of metres *
/// 256, rounded (KITTI's convention). Values that are not positive or are beyond 255.99 m become 0.
/// Throws UserError if the file cannot be written.
void WriteDepthImage(const std::filesystem::path& path, const cv::Mat& range);

/// Reads a file that WriteDepthImage can write. Returns ranges (CV_32FC1, metres along each pixel's
/// ray, 0 for none). Throws UserError for a file that is not a 16-bit image of one channel.
cv::Mat ReadDepthImage(const std::filesystem::path& path);

/// Writes values between 0 and 1 (CV_32FC1), such as confidences, as a 16-bit PNG of value * 65535,
/// rounded. Throws UserError if the file cannot be written.
void WriteFractionImage(const std::filesystem::path& path, const cv::Mat& fraction);

/// Reads a file that WriteFractionImage can write. Returns values between 0 and 1 (CV_32FC1).
/// Throws UserError for a file that is not a 16-bit image of one channel.
cv::Mat ReadFractionImage(const std::filesystem::path& path);

/// Writes the source of each range (CV_8UC1 of RangeSource) as an 8-bit PNG of its numbers. Throws
/// UserError if the file cannot be written.
void WriteSourceImage(const std::filesystem::path& path, const cv::Mat& source);

/// Reads a file that WriteSourceImage can write (CV_8UC1 of RangeSource). Throws UserError for any
/// other.
cv::Mat ReadSourceImage(const std::filesystem::path& path);

}  // namespace orb360
