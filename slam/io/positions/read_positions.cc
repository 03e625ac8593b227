#include "slam/io/positions/read_positions.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "nn/base/statistics.h"
#include "slam/io/dataset.h"
#include "slam/io/file_extension.h"
#include "slam/io/folder_source.h"
#include "slam/io/jpeg_metadata.h"
#include "slam/io/positions/camm.h"
#include "slam/io/positions/exif_gps.h"
#include "slam/io/positions/file_head.h"
#include "slam/io/positions/gpmf.h"
#include "slam/io/positions/gpx_file.h"
#include "slam/io/positions/insta360_trailer.h"
#include "slam/io/positions/metadata_track.h"
#include "slam/scale/position_alignment.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// A track, and how many measurements were left out because the receiver had no fix.
struct FoundTrack {
  PositionTrack track;
  int num_without_lock = 0;
};

FoundTrack ReadGpmfTrack(const std::filesystem::path& path) {
  FoundTrack found;
  PositionTrack& track = found.track;
  track.source = "GPMF telemetry of " + path.string();
  track.clock = PositionClock::kVideo;
  std::vector<double> utc_at_zero;
  ReadMetadataTrack(path, "gpmd", [&](const MetadataSample& sample) {
    GpmfPositions positions = ParseGpmf(sample.data);
    for (GeodeticFix& fix : positions.fixes) {
      fix.timestamp = sample.start + fix.timestamp * sample.duration;
      track.fixes.push_back(fix);
    }
    if (positions.utc && !positions.fixes.empty()) {
      utc_at_zero.push_back(*positions.utc - sample.start);
    }
    if (positions.altitude_reference != AltitudeReference::kUnknown) {
      track.altitude_reference = positions.altitude_reference;
    }
    found.num_without_lock += positions.num_without_lock;
  });
  if (!utc_at_zero.empty()) track.utc_at_zero = Median(utc_at_zero);
  return found;
}

FoundTrack ReadCammTrack(const std::filesystem::path& path) {
  FoundTrack found;
  PositionTrack& track = found.track;
  track.source = "CAMM telemetry of " + path.string();
  track.clock = PositionClock::kVideo;
  track.altitude_reference = AltitudeReference::kEllipsoid;
  std::vector<GeodeticFix> without_accuracy;
  std::vector<double> gps_at_zero;
  const auto append = [](const std::vector<GeodeticFix>& fixes, double timestamp,
                         std::vector<GeodeticFix>* all) {
    for (GeodeticFix fix : fixes) {
      fix.timestamp = timestamp;
      all->push_back(fix);
    }
  };
  const MetadataSummary summary =
      ReadMetadataTrack(path, "camm", [&](const MetadataSample& sample) {
        const CammPositions positions = ParseCamm(sample.data);
        append(positions.with_accuracy, sample.start, &track.fixes);
        append(positions.without_accuracy, sample.start, &without_accuracy);
        if (positions.gps_time) gps_at_zero.push_back(*positions.gps_time - sample.start);
        found.num_without_lock += positions.num_without_lock;
      });
  if (track.fixes.empty()) track.fixes = std::move(without_accuracy);
  if (!gps_at_zero.empty()) {
    // Of the two epochs that cameras use, the one nearer to their own clock.
    const double unix = Median(gps_at_zero);
    const double gps = unix + kGpsEpoch;
    const double made = summary.creation_time.value_or(gps);
    track.utc_at_zero = std::abs(unix - made) < std::abs(gps - made) ? unix : gps;
  }
  return found;
}

FoundTrack ReadInsta360Track(const std::filesystem::path& path) {
  FoundTrack found;
  found.track.source = "Insta360's GPS record of " + path.string();
  found.track.clock = PositionClock::kUtc;
  found.track.utc_at_zero = 0.0;
  std::ifstream file(path, std::ios::binary);
  Insta360Positions positions = ReadInsta360Positions(file);
  found.track.fixes = std::move(positions.fixes);
  found.num_without_lock = positions.num_without_lock;
  return found;
}

/// The images' own positions. Images without one are left out. The order of the images is that of
/// the source of frames, which knows the rate of a data set (`own_rate`) only; with --fps
/// (`frame_rate`) their times are replaced.
PositionTrack ReadExifTrack(const std::filesystem::path& folder,
                            const std::optional<double>& own_rate,
                            const std::optional<double>& frame_rate) {
  PositionTrack track;
  track.source = "Exif of the images in " + folder.string();
  track.clock = PositionClock::kFrames;
  const FrameList list = ListFrames(folder, folder.string(), own_rate);
  for (size_t i = 0; i < list.images.size(); ++i) {
    const auto& [path, timestamp] = list.images[i];
    const std::optional<ExifPosition> position = ParseExifGps(ReadJpegMetadata(path).exif);
    if (!position) continue;
    GeodeticFix fix = position->fix;
    fix.timestamp = frame_rate ? static_cast<double>(i) / *frame_rate : timestamp;
    track.fixes.push_back(fix);
    if (position->fix.altitude) track.altitude_reference = position->altitude_reference;
    if (!track.utc_at_zero && position->utc) track.utc_at_zero = *position->utc - fix.timestamp;
  }
  return track;
}

bool IsGpx(const std::filesystem::path& path) {
  const std::string extension = LowerCaseExtension(path);
  if (extension == ".gpx" || extension == ".xml") return true;
  const std::string head = ReadFileHead(path, 5);
  return head == "<?xml" || head.starts_with("<gpx");
}

/// The positions of a video: none without telemetry. Throws UserError where there is telemetry and
/// the receiver never had a fix.
std::optional<PositionTrack> FindInVideo(const std::filesystem::path& path) {
  FoundTrack found;
  for (const auto& read : {ReadGpmfTrack, ReadCammTrack, ReadInsta360Track}) {
    found = read(path);
    if (!found.track.fixes.empty() || found.num_without_lock > 0) break;
  }
  Tidy(&found.track);
  if (!found.track.fixes.empty()) return std::move(found.track);
  if (found.num_without_lock == 0) return std::nullopt;
  throw UserError(path.string() + ": its receiver had no satellites in any of " +
                  std::to_string(found.num_without_lock) +
                  " measurements; give the track of another device");
}

void RequireEnough(const PositionTrack& track) {
  if (track.fixes.size() >= kMinAlignmentFixes) return;
  throw UserError(track.source + ": has " + std::to_string(track.fixes.size()) +
                  " positions, and at least " + std::to_string(kMinAlignmentFixes) +
                  " are needed; give a longer track");
}

}  // namespace

std::optional<PositionTrack> FindPositions(const std::filesystem::path& input,
                                           const std::optional<double>& frame_rate) {
  std::optional<PositionTrack> track;
  if (IsDataset(input)) {
    const Dataset dataset = OpenDataset(input);
    track = ReadExifTrack(dataset.images(), dataset.frame_rate, frame_rate);
  } else if (std::filesystem::is_directory(input)) {
    track = ReadExifTrack(input, std::nullopt, frame_rate);
  } else {
    track = FindInVideo(input);
  }
  if (track && track->clock == PositionClock::kVideo && frame_rate) {
    throw UserError(track->source +
                    ": its positions have the times of the video, which --fps replaces; leave "
                    "--fps out");
  }
  if (track) Tidy(&*track);
  if (!track || track->fixes.empty()) return std::nullopt;
  RequireEnough(*track);
  return track;
}

PositionTrack ReadPositions(const std::filesystem::path& path,
                            const std::optional<double>& frame_rate) {
  if (std::filesystem::is_regular_file(path) && IsGpx(path)) {
    PositionTrack track = ReadGpx(path);
    RequireEnough(track);
    return track;
  }
  if (!std::filesystem::exists(path)) throw UserError(path.string() + ": no such file or folder");
  if (std::optional<PositionTrack> track = FindPositions(path, frame_rate)) return *track;
  throw UserError(
      path.string() +
      (std::filesystem::is_directory(path)
           ? ": none of its images has a position in its Exif (JPEG)"
           : ": has no positions: neither a GPMF nor a CAMM track nor Insta360's GPS record") +
      "; give a GPX file, or a video or images with positions");
}

}  // namespace orb360
