#include "slam/io/folder_source.h"

#include <algorithm>
#include <memory>
#include <span>

#include "slam/io/file_extension.h"
#include "slam/io/full_sphere.h"
#include "slam/io/image_file.h"
#include "slam/io/jpeg_metadata.h"
#include "slam/io/panorama_layout.h"
#include "slam/io/panorama_xml.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

/// Removes the run of digits at the start of `text` and returns it without leading zeros.
std::string_view TakeNumber(std::string_view& text) {
  const auto end = std::ranges::find_if_not(text, IsDigit);
  std::string_view number(text.begin(), end);
  text.remove_prefix(number.size());
  number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
  return number;
}

void RequireSize(const std::filesystem::path& file, cv::Size size, cv::Size expected) {
  if (size == expected) return;
  throw UserError(file.string() + ": is " + ToString(size) + ", the images before it are " +
                  ToString(expected) + "; all images of a folder must have the same size");
}

/// Returns the size of the first image whose size can be found. Throws UserError if the header of
/// another image states a different size.
cv::Size CommonSize(std::span<const FrameList::Image> images, const std::string& name) {
  std::optional<cv::Size> common;
  for (const FrameList::Image& image : images) {
    std::optional<cv::Size> size = ProbeImageSize(image.path);
    if (!size && !common) {
      const cv::Mat pixels = LoadImage(image.path).image;
      if (!pixels.empty()) size = pixels.size();
    }
    if (size && common) RequireSize(image.path, *size, *common);
    if (!common) common = size;
  }
  if (!common) {
    throw UserError(name + ": none of its " + std::to_string(images.size()) +
                    " images can be decoded");
  }
  return *common;
}

/// Returns what GPano says of all images. Throws UserError where not all show the same part of the
/// sphere. Contract: there is one.
PanoramaMetadata CommonPanorama(std::span<const FrameList::Image> images) {
  std::optional<PanoramaMetadata> common;
  for (const FrameList::Image& image : images) {
    const PanoramaMetadata panorama =
        ReadPanoramaXml(image.path.string(), ReadJpegMetadata(image.path).xmp, "GPano")
            .value_or(PanoramaMetadata());
    if (!common) common = panorama;
    if (panorama.crop != common->crop) {
      throw UserError(image.path.string() +
                      ": shows another part of the sphere than the images before it (metadata "
                      "GPano); all images of a folder must show the same part");
    }
  }
  return *common;
}

/// The mapping of panoramas, which GPano may place in the sphere.
SphereMapping MapPanoramas(std::span<const FrameList::Image> images, const std::string& name,
                           cv::Size stored) {
  for (const FrameList::Image& image : images) {
    if (LowerCaseExtension(image.path) == ".insp") {
      throw UserError(image.path.string() +
                      ": is a raw image of two fisheye lenses; give their calibration with --lens, "
                      "such as --lens insta360-side-by-side");
    }
  }
  const PanoramaLayout layout = MakePanoramaLayout(name, stored, 1.0, CommonPanorama(images));
  const auto placer = std::make_shared<PanoramaPlacer>(layout);
  return {layout.shown, placer->coverage(),
          [placer](const cv::Mat& image) { return placer->Place(image); }};
}

/// Gives the images their EXIF times if all have one, and sets whether their order changed. Returns
/// whether the times can be timestamps.
bool OrderByExifTime(FrameList* list) {
  for (FrameList::Image& image : list->images) {
    const std::optional<double> time = ExifTime(ReadJpegMetadata(image.path).exif);
    if (!time) return false;
    image.timestamp = *time;
  }
  list->is_reordered = !std::ranges::is_sorted(list->images, {}, &FrameList::Image::timestamp);
  std::ranges::stable_sort(list->images, {}, &FrameList::Image::timestamp);
  return list->images.size() > 1 &&
         std::ranges::adjacent_find(list->images, {}, &FrameList::Image::timestamp) ==
             list->images.end();
}

}  // namespace

bool NaturalLess(std::string_view a, std::string_view b) {
  const std::string_view whole_a = a;
  const std::string_view whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (IsDigit(a.front()) && IsDigit(b.front())) {
      const std::string_view number_a = TakeNumber(a);
      const std::string_view number_b = TakeNumber(b);
      if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
      if (number_a != number_b) return number_a < number_b;
    } else {
      if (a.front() != b.front()) return a.front() < b.front();
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.empty() != b.empty()) return a.empty();
  return whole_a < whole_b;  // Equal but for leading zeros: any fixed order.
}

std::vector<std::filesystem::path> ListImages(const std::filesystem::path& folder,
                                              const std::string& name) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    // File managers leave files with a leading dot behind.
    if (IsImageFileName(entry.path()) && !entry.path().filename().string().starts_with('.') &&
        !entry.is_directory()) {
      files.push_back(entry.path());
    }
  }
  if (files.empty()) {
    throw UserError(name +
                    ": contains no images (jpg, png, bmp, tif, webp, ppm, avif, heic, insp)");
  }
  std::ranges::sort(files, [](const auto& a, const auto& b) {
    return NaturalLess(a.filename().native(), b.filename().native());
  });
  return files;
}

FrameList ListFrames(const std::filesystem::path& folder, const std::string& name,
                     const std::optional<double>& frame_rate) {
  FrameList list{{}, frame_rate.value_or(kFolderFrameRate), false};
  ORB360_CHECK(list.frame_rate > 0.0, list.frame_rate);
  for (std::filesystem::path& path : ListImages(folder, name)) {
    list.images.push_back({std::move(path), 0.0});
  }
  std::vector<FrameList::Image>& images = list.images;
  if (!frame_rate && OrderByExifTime(&list)) {
    const double first = images.front().timestamp;
    for (FrameList::Image& image : images) image.timestamp -= first;
    list.frame_rate = static_cast<double>(images.size() - 1) / images.back().timestamp;
  } else {
    for (size_t i = 0; i < images.size(); ++i) {
      images[i].timestamp = static_cast<double>(i) / list.frame_rate;
    }
  }
  return list;
}

FolderSource::FolderSource(const std::filesystem::path& folder, std::string name,
                           std::optional<double> frame_rate, std::optional<double> camera_height,
                           const MakeSphereMapping& make_mapping)
    : list_(ListFrames(folder, name, frame_rate)) {
  info_.frame_rate = list_.frame_rate;
  stored_size_ = CommonSize(list_.images, name);
  mapping_ =
      make_mapping ? make_mapping(stored_size_) : MapPanoramas(list_.images, name, stored_size_);
  info_.image_size = mapping_.sphere;
  info_.coverage = mapping_.coverage;
  if (list_.is_reordered) {
    warnings_.push_back(folder.string() +
                        ": the names of the images are not in the order of their EXIF times; "
                        "ordered by these");
  }
  info_.name = std::move(name);
  info_.frame_count = static_cast<int>(list_.images.size());
  info_.camera_height = camera_height;
}

bool FolderSource::Skip() {
  if (next_ == list_.images.size()) return false;
  ++next_;
  return true;
}

std::optional<Frame> FolderSource::Read() {
  if (next_ == list_.images.size()) return std::nullopt;
  const auto& [file, timestamp] = list_.images[next_];
  LoadedImage loaded = LoadImage(file);
  if (!loaded.image.empty()) {
    RequireSize(file, loaded.image.size(), stored_size_);
    loaded.image = mapping_.to_sphere(loaded.image);
  } else {
    warnings_.push_back(file.string() + ": " + loaded.problem + "; frame " + std::to_string(next_) +
                        " is skipped");
  }
  return Frame{static_cast<int>(next_++), timestamp, loaded.image};
}

}  // namespace orb360
