// Writes the telemetry, Exif blocks and tracks that the fuzzer of positions starts from into a
// folder: write_position_seeds FOLDER. The first byte of a file is the kind that the fuzzer reads.

#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "tests/slam/io/positions/camm_writer.h"
#include "tests/slam/io/positions/exif_writer.h"
#include "tests/slam/io/positions/gpmf_writer.h"
#include "tests/slam/io/positions/insta360_writer.h"

int main(int argc, char** argv) {
  using namespace orb360;
  if (argc != 2) {
    std::cerr << "write_position_seeds FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  const auto write = [&](const char* name, char kind, const std::string& content) {
    std::ofstream(folder / name, std::ios::binary) << kind << content;
  };
  const std::vector<GpmfMeasurement> measurements = {{47.5, 8.25, 400.5}, {47.6, 8.26, 401}};
  write("gps5", 0, WriteGps5(measurements, "240229235959.750"));
  write("gps9", 0, WriteGps9(measurements));
  write("camm5", 1, CammType5(47.5, 8.25, 400));
  write("camm6", 1, CammType2() + CammType6(1.4e9, 3, 47.5, 8.25, 400, 2.0f, 4.0f));
  constexpr std::size_t kSegmentHead = 10;  // marker, length and "Exif\0\0"
  write("exif", 2,
        WriteExifSegment({.latitude = 47.5,
                          .longitude = 8.25,
                          .altitude = 400,
                          .date = "2024:02:29",
                          .time_of_day = 3600,
                          .horizontal_error = 5})
            .substr(kSegmentHead));
  write("gpx", 3,
        "<gpx><trk><trkseg><trkpt lat=\"47.5\" lon=\"8.25\"><ele>400</ele>"
        "<time>2024-02-29T23:59:59.75Z</time><hdop>1.5</hdop><vdop>2</vdop></trkpt>"
        "<trkpt lat=\"47.5\" lon=\"8.26\"><time>2024-03-01T01:00:00+01:00</time></trkpt>"
        "</trkseg></trk></gpx>");
  const std::vector<Insta360Record> records = {{7, Insta360Measurement(1.7e9, 47.5, 8.25, 400)},
                                               {3, std::string(20, 'g')}};
  write("insta360", 4, Insta360Trailer(records));
  write("insta360_index", 4, IndexedInsta360Trailer(records));
  return 0;
}
