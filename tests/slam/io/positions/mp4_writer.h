#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tests/slam/io/positions/byte_writer.h"

namespace orb360 {

/// A box of an MP4 file (ISO/IEC 14496-12).
inline std::string Box(const std::string& type, const std::string& content) {
  std::string box;
  Append(&box, static_cast<std::uint32_t>(8 + content.size()));
  return box + type + content;
}

/// Numbers of 32 bits.
inline std::string Words(const std::vector<std::uint32_t>& words) {
  std::string bytes;
  for (const std::uint32_t word : words) Append(&bytes, word);
  return bytes;
}

inline std::string UnityMatrix() { return Words({0x10000, 0, 0, 0, 0x10000, 0, 0, 0, 0x40000000}); }

/// A file without any track. `creation_time`: seconds since 1904, 0 for none.
inline std::string EmptyMp4(std::uint32_t creation_time = 0) {
  const std::string mvhd =
      Box("mvhd", Words({0, creation_time, creation_time, 1000, 0, 0x10000, 0x1000000, 0, 0}) +
                      UnityMatrix() + std::string(24, '\0') + Words({2}));
  return Box("ftyp", "isom" + Words({512}) + "isommp42") + Box("moov", mvhd);
}

/// Adds a track of metadata to an MP4 file whose box `moov` is the last one. The samples follow one
/// another without a gap, each `duration` milliseconds long.
inline std::string WithMetadataTrack(const std::string& mp4, const std::string& tag,
                                     const std::vector<std::string>& samples,
                                     std::uint32_t duration) {
  size_t moov_at = 0;
  for (size_t at = 0; at < mp4.size();) {
    const auto byte = [&](size_t i) { return static_cast<unsigned char>(mp4[at + i]); };
    const size_t size = size_t{byte(0)} << 24 | byte(1) << 16 | byte(2) << 8 | byte(3);
    if (mp4.compare(at + 4, 4, "moov") == 0) moov_at = at;
    at += size;
  }
  const auto count = static_cast<std::uint32_t>(samples.size());
  const std::uint32_t total = duration * count;
  std::string data;
  std::vector<std::uint32_t> sizes = {0, 0, count}, offsets = {0, count};
  for (const std::string& sample : samples) {
    sizes.push_back(static_cast<std::uint32_t>(sample.size()));
    offsets.push_back(static_cast<std::uint32_t>(moov_at + 8 + data.size()));
    data += sample;
  }
  const std::string entry = Box(tag, std::string(6, '\0') + std::string("\0\1", 2));
  const std::string stbl =
      Box("stbl", Box("stsd", Words({0, 1}) + entry) + Box("stts", Words({0, 1, count, duration})) +
                      Box("stsc", Words({0, 1, 1, 1, 1})) + Box("stsz", Words(sizes)) +
                      Box("stco", Words(offsets)));
  const std::string minf =
      Box("minf", Box("nmhd", Words({0})) +
                      Box("dinf", Box("dref", Words({0, 1}) + Box("url ", Words({1})))) + stbl);
  const std::string mdia =
      Box("mdia",
          Box("mdhd", Words({0, 0, 0, 1000, total, 0x55c40000})) +
              Box("hdlr", Words({0, 0}) + "meta" + Words({0, 0, 0}) + std::string(1, '\0')) + minf);
  const std::string tkhd =
      Box("tkhd", Words({7, 0, 0, 9, 0, total, 0, 0, 0, 0}) + UnityMatrix() + Words({0, 0}));
  const std::string moov = mp4.substr(moov_at + 8);
  return mp4.substr(0, moov_at) + Box("mdat", data) + Box("moov", moov + Box("trak", tkhd + mdia));
}

}  // namespace orb360
