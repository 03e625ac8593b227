#pragma once

#include <filesystem>
#include <string>

#include <opencv2/imgcodecs.hpp>

#include "tests/slam/io/temp_folder.h"

namespace orb360 {

/// A segment APP1 of a JPEG file.
inline std::string App1(const std::string& content) {
  const size_t size = content.size() + 2;
  return std::string("\xff\xe1") + static_cast<char>(size >> 8) + static_cast<char>(size) + content;
}

inline std::string XmpSegment(const std::string& xml) {
  return App1(std::string("http://ns.adobe.com/xap/1.0/\0", 29) + xml);
}

/// EXIF with DateTimeOriginal `time`, "YYYY:MM:DD HH:MM:SS", and SubSecTimeOriginal `fraction` of
/// at least four characters, in the order of bytes of Intel or of Motorola.
inline std::string ExifSegment(const std::string& time, const std::string& fraction,
                               bool is_big_endian = false) {
  std::string tiff = is_big_endian ? std::string("MM\0*", 4) : std::string("II*\0", 4);
  const auto add = [&](unsigned value, int bytes) {
    for (int i = 0; i < bytes; ++i) {
      tiff += static_cast<char>(value >> 8 * (is_big_endian ? bytes - 1 - i : i));
    }
  };
  const auto add_entry = [&](unsigned tag, unsigned type, size_t count, unsigned value) {
    add(tag, 2);
    add(type, 2);
    add(static_cast<unsigned>(count), 4);
    add(value, 4);
  };
  add(8, 4);                    // where the first directory is
  add(1, 2);                    // its entries
  add_entry(0x8769, 4, 1, 26);  // where EXIF's directory is
  add(0, 4);                    // no directory after this
  add(2, 2);                    // EXIF's entries
  add_entry(0x9003, 2, time.size() + 1, 56);
  add_entry(0x9291, 2, fraction.size() + 1, static_cast<unsigned>(56 + time.size() + 1));
  add(0, 4);
  tiff += time + '\0' + fraction + '\0';
  return App1(std::string("Exif\0\0", 6) + tiff);
}

/// Writes a JPEG file with segments after its first marker.
inline void WriteJpeg(const std::filesystem::path& path, const cv::Mat& image,
                      const std::string& segments) {
  cv::imwrite(path.string(), image);
  std::string bytes = ReadText(path);
  WriteText(path, bytes.insert(2, segments));
}

}  // namespace orb360
