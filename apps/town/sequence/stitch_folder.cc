#include "apps/town/sequence/stitch_folder.h"

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "apps/town/image/stitch.h"
#include "apps/town/sequence/sequence_writer.h"
#include "slam/check.h"

namespace orb360::town {
namespace {

/// The images of a folder by their names without extension, so in their order.
std::map<std::string, std::filesystem::path> ListImages(const std::filesystem::path& folder) {
  std::map<std::string, std::filesystem::path> images;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".png" || extension == ".jpg" || extension == ".jpeg")
      images[entry.path().stem().string()] = entry.path();
  }
  return images;
}

/// For each frame the files of the faces.
using FaceFiles = std::vector<std::array<std::filesystem::path, kCubeFaces>>;

/// The images in the folders prefix + face name. Those of the first face say which frames there
/// are, `names` (if any) which there must be.
FaceFiles ListFaces(const std::filesystem::path& recording, const std::string& prefix,
                    std::vector<std::string>* names) {
  FaceFiles files;
  for (size_t face = 0; face < kCubeFaces; ++face) {
    const std::filesystem::path folder = recording / (prefix + std::string(kCubeFaceNames[face]));
    if (!std::filesystem::is_directory(folder)) {
      throw UserError(folder.string() +
                      ": no such folder; a recording has front, right, back, left, up and down");
    }
    const auto images = ListImages(folder);
    if (images.empty()) throw UserError(folder.string() + ": holds no PNG or JPEG image");
    if (names->empty()) {
      for (const auto& [name, path] : images) names->push_back(name);
    }
    files.resize(names->size());
    for (size_t frame = 0; frame < names->size(); ++frame) {
      const auto image = images.find((*names)[frame]);
      if (image == images.end()) {
        throw UserError(folder.string() + ": frame '" + (*names)[frame] +
                        "' is missing, which other faces have");
      }
      files[frame][face] = image->second;
    }
  }
  return files;
}

/// Reads a face and checks that it is square and of the right size (0: any).
cv::Mat ReadFace(const std::filesystem::path& path, int flags, int size) {
  cv::Mat image = cv::imread(path.string(), flags);
  if (image.empty()) throw UserError(path.string() + ": cannot be read as an image");
  if (image.rows != image.cols || image.rows < 2 || (size != 0 && image.rows != size)) {
    std::ostringstream message;
    message << path.string() << ": is " << image.cols << "x" << image.rows
            << ", but faces are square";
    if (size != 0) message << " and the others " << size << "x" << size;
    throw UserError(message.str());
  }
  return image;
}

cv::Mat3b StitchColourFiles(const FaceFiles::value_type& files,
                            const EquirectangularCamera& camera) {
  CubeImages<cv::Vec3b> faces;
  for (size_t face = 0; face < kCubeFaces; ++face)
    faces[face] = ReadFace(files[face], cv::IMREAD_COLOR, faces[0].rows);
  return StitchColour(faces, camera);
}

cv::Mat1f DecodeDepth(const cv::Mat& image, const std::filesystem::path& path, double farthest) {
  if (image.type() == CV_16UC1) {
    cv::Mat1f depth;
    image.convertTo(depth, CV_32F, 1.0 / 256);
    return depth;
  }
  if (image.depth() == CV_8U && image.channels() >= 3) return DecodeDepth24(image, farthest);
  throw UserError(
      path.string() +
      ": depth is a 16-bit image of one channel (metres * 256) or an 8-bit colour image "
      "(24-bit encoding)");
}

cv::Mat1f StitchRangeFiles(const FaceFiles::value_type& files, double farthest,
                           const EquirectangularCamera& camera) {
  CubeImages<float> faces;
  for (size_t face = 0; face < kCubeFaces; ++face) {
    const cv::Mat image = ReadFace(files[face], cv::IMREAD_UNCHANGED, faces[0].rows);
    faces[face] = DecodeDepth(image, files[face], farthest);
  }
  return StitchRange(faces, camera);
}

}  // namespace

void StitchFolder(const std::filesystem::path& recording, const std::filesystem::path& folder,
                  const StitchOptions& options, const std::function<void(int, int)>& progress) {
  std::vector<std::string> names;
  const FaceFiles colour = ListFaces(recording, "", &names);
  const std::string depth_prefix = "depth_";
  const bool has_depth =
      std::filesystem::exists(recording / (depth_prefix + std::string(kCubeFaceNames[0])));
  const FaceFiles depth = has_depth ? ListFaces(recording, depth_prefix, &names) : FaceFiles();

  const EquirectangularCamera camera(options.width, options.width / 2);
  std::ostringstream description;
  description << "camera:\n  model: equirectangular\n  width: " << camera.width()
              << "\n  height: " << camera.height() << "\nfps: " << options.fps
              << "\nframes: " << names.size() << "\n";
  std::vector<std::string> kinds = {SequenceWriter::kColour};
  if (has_depth) kinds.emplace_back(SequenceWriter::kRange);
  const SequenceWriter writer(folder, description.str(), kinds);
  const std::filesystem::path truth = recording / "groundtruth.txt";
  if (std::filesystem::exists(truth)) {
    std::filesystem::copy_file(truth, folder / "groundtruth.txt",
                               std::filesystem::copy_options::overwrite_existing);
  }
  const int all = static_cast<int>(names.size());
  for (int frame = 0; frame < all; ++frame) {
    const auto index = static_cast<size_t>(frame);
    if (!writer.Has(SequenceWriter::kColour, frame))
      writer.WriteColour(frame, StitchColourFiles(colour[index], camera));
    if (has_depth && !writer.Has(SequenceWriter::kRange, frame)) {
      writer.WriteRange(frame, StitchRangeFiles(depth[index], options.farthest_depth, camera));
    }
    progress(frame + 1, all);
  }
  writer.WriteContactSheet(all);
}

}  // namespace orb360::town
