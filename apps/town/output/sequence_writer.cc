#include "apps/town/output/sequence_writer.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include <opencv2/imgcodecs.hpp>

#include "slam/check.h"

namespace orb360::town {
namespace {

std::string FrameName(int frame, const char* extension) {
  char name[32];
  std::snprintf(name, sizeof name, "%06d.%s", frame, extension);
  return name;
}

void WriteFile(const std::filesystem::path& path, const char* data, size_t size) {
  const std::filesystem::path partial = path.string() + ".partial";
  std::ofstream file(partial, std::ios::binary);
  file.write(data, static_cast<std::streamsize>(size));
  file.close();
  if (!file)
    throw UserError("cannot write " + path.string() +
                    ": is the disk full, or the folder read-only?");
  std::filesystem::rename(partial, path);
}

/// TUM: timestamp, then the pose of the optical camera (x right, y down, z forward).
std::string GroundTruth(const std::vector<Rigid3>& poses, double fps) {
  Eigen::Matrix3d camera_from_optical;  // camera: -X forward, +Y right, +Z up
  camera_from_optical << 0, 0, -1, 1, 0, 0, 0, -1, 0;
  const Eigen::Quaterniond turn(camera_from_optical);
  std::ostringstream text;
  text << "# timestamp tx ty tz qx qy qz qw\n";
  for (size_t i = 0; i < poses.size(); ++i) {
    const Eigen::Quaterniond q = (poses[i].rotation * turn).normalized();
    const Eigen::Vector3d& t = poses[i].translation;
    char line[256];
    std::snprintf(line, sizeof line, "%.6f %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n",
                  static_cast<double>(i) / fps, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
    text << line;
  }
  return text.str();
}

std::string Description(const SequenceInfo& info) {
  std::ostringstream text;
  text << "camera:\n  model: equirectangular\n  width: " << info.width
       << "\n  height: " << info.height << "\ncamera_height: " << info.camera_height
       << "  # metres above the road\nfps: " << info.fps << "\nframes: " << info.frames
       << "\ntown: " << info.town << "\nseed: " << info.seed << "\nlight: " << info.light
       << "\ntraffic: " << info.traffic
       << "\nspeed:  # metres per second\n  mean: " << info.mean_speed
       << "\n  maximum: " << info.maximum_speed << "\n";
  return text.str();
}

}  // namespace

SequenceWriter::SequenceWriter(const std::filesystem::path& folder, const SequenceInfo& info,
                               const std::vector<Rigid3>& world_from_camera)
    : folder_(folder) {
  std::error_code error;
  std::filesystem::create_directories(folder / "rgb", error);
  if (!error) std::filesystem::create_directories(folder / "depth", error);
  if (error)
    throw UserError("cannot create the folder " + folder.string() + ": " + error.message());
  const std::string truth = GroundTruth(world_from_camera, info.fps);
  WriteFile(folder / "groundtruth.txt", truth.data(), truth.size());
  const std::string description = Description(info);
  WriteFile(folder / "sequence.yaml", description.data(), description.size());
}

void SequenceWriter::WriteColour(int frame, const cv::Mat3b& image) const {
  constexpr int kQuality = 95;
  std::vector<uchar> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, kQuality});
  WriteFile(folder_ / "rgb" / FrameName(frame, "jpg"), reinterpret_cast<const char*>(bytes.data()),
            bytes.size());
}

void SequenceWriter::WriteRange(int frame, const cv::Mat1f& range) const {
  cv::Mat1w stored(range.size());
  for (int row = 0; row < range.rows; ++row) {
    for (int column = 0; column < range.cols; ++column) {
      const float value = std::round(range(row, column) * 256);
      stored(row, column) = value > 65535 ? 0 : static_cast<uint16_t>(value);
    }
  }
  std::vector<uchar> bytes;
  cv::imencode(".png", stored, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  WriteFile(folder_ / "depth" / FrameName(frame, "png"),
            reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

}  // namespace orb360::town
