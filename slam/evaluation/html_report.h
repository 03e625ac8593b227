#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace orb360 {

/// A page on a run: large figures, images, bars, and a table. Texts are plain; characters that are
/// markup in HTML are escaped.
struct HtmlReport {
  struct Tile {
    std::string value;
    std::string label;
  };
  struct Image {
    std::string title;
    std::string caption;
    std::string data;        // of the file
    std::string media_type;  // such as "image/png"
  };
  /// Two lengths from the same zero, such as a median and a 95th percentile.
  struct Bar {
    std::string label;
    double value = 0;
    double extent = 0;  // at least `value`
  };
  struct Row {
    std::string name;
    std::string text;
  };

  std::string title;
  std::string subtitle;
  std::vector<Tile> tiles;
  std::vector<std::string> warnings;
  std::vector<Image> images;
  std::string bars_title;
  std::string bars_unit;
  std::vector<Bar> bars;
  std::string table_title;
  std::vector<Row> table;
};

/// Returns one self-contained file that includes the images.
std::string MakeHtml(const HtmlReport& report);

/// Encodes an image (CV_8UC3, BGR) as PNG.
std::string EncodePng(const cv::Mat& image);

/// Encodes bytes as base64 (RFC 4648).
std::string EncodeBase64(const std::string& data);

}  // namespace orb360
