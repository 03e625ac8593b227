#include "apps/town/sequence/sequence_writer.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <system_error>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <unistd.h>

#include "apps/town/sequence/exr_image.h"
#include "slam/io/atomic_file.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/depth_image.h>

namespace orb360::town {
namespace {

constexpr int kJpegQuality = 95;

void WriteImage(const std::filesystem::path& path, const cv::Mat& image) {
  const bool is_jpeg = path.extension() == ".jpg";
  std::vector<uchar> bytes;
  cv::imencode(
      path.extension().string(), image, bytes,
      is_jpeg ? std::vector<int>{cv::IMWRITE_JPEG_QUALITY, kJpegQuality} : std::vector<int>{});
  WriteFileAtomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

void MakeFolder(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw UserError("cannot create the folder " + path.string() + ": " + error.message());
}

}  // namespace

void RequireWritable(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::path existing = std::filesystem::absolute(folder);
  while (!std::filesystem::exists(existing, error) && existing.has_relative_path())
    existing = existing.parent_path();
  if (!std::filesystem::is_directory(existing, error)) {
    throw UserError("cannot create the folder " + folder.string() + ": " + existing.string() +
                    " is a file; choose another --out");
  }
  if (access(existing.c_str(), W_OK | X_OK) != 0) {
    throw UserError("cannot write into " + existing.string() + ": " +
                    std::generic_category().message(errno) + "; choose another --out");
  }
}

SequenceWriter::SequenceWriter(const std::filesystem::path& folder, const std::string& description,
                               const std::vector<std::string>& kinds)
    : folder_(folder) {
  MakeFolder(folder_);
  const std::filesystem::path path = folder_ / "sequence.yaml";
  if (std::ifstream file(path); file) {
    std::stringstream found;
    found << file.rdbuf();
    if (found.str() != description) {
      throw UserError(folder_.string() +
                      " holds a sequence made with other options (see its sequence.yaml): choose "
                      "another --out or delete it");
    }
  } else {
    WriteFileAtomically(path, description);
  }
  for (const std::string& kind : kinds) MakeFolder(folder_ / kind);
}

std::filesystem::path SequenceWriter::ImagePath(const std::string& kind, int frame) const {
  char name[32];
  const char* extension = kind == kColour ? "jpg" : kind == kExactRange ? "exr" : "png";
  std::snprintf(name, sizeof name, "%06d.%s", frame, extension);
  return folder_ / kind / name;
}

bool SequenceWriter::Has(const std::string& kind, int frame) const {
  return std::filesystem::exists(ImagePath(kind, frame));
}

void SequenceWriter::WriteColour(int frame, const cv::Mat3b& image) const {
  WriteImage(ImagePath(kColour, frame), image);
}

void SequenceWriter::WriteRange(int frame, const cv::Mat1f& range) const {
  WriteDepthImage(ImagePath(kRange, frame), range);
}

void SequenceWriter::WriteExactRange(int frame, const cv::Mat1f& range) const {
  WriteExrImage(ImagePath(kExactRange, frame), range);
}

void SequenceWriter::WriteMask(const std::string& kind, int frame, const cv::Mat& mask) const {
  WriteImage(ImagePath(kind, frame), mask);
}

void SequenceWriter::WriteContactSheet(int frames) const {
  constexpr int kColumns = 4;
  constexpr int kRows = 6;
  const cv::Size tile(480, 240);
  cv::Mat3b sheet(kRows * tile.height, kColumns * tile.width, cv::Vec3b(0, 0, 0));
  const int tiles = std::min(frames, kColumns * kRows);
  for (int i = 0; i < tiles; ++i) {
    const int frame = static_cast<int>(static_cast<int64_t>(i) * frames / tiles);
    const cv::Mat image = cv::imread(ImagePath(kColour, frame).string());
    if (image.empty()) continue;
    cv::Mat small;
    cv::resize(image, small, tile, 0, 0, cv::INTER_AREA);
    small.copyTo(
        sheet(cv::Rect(cv::Point(i % kColumns * tile.width, i / kColumns * tile.height), tile)));
  }
  WriteImage(folder_ / "contact_sheet.jpg",
             sheet.rowRange(0, (tiles + kColumns - 1) / kColumns * tile.height));
}

}  // namespace orb360::town
