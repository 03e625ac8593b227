#include "slam/io/video/gspherical_box.h"

#include <array>
#include <cstdint>
#include <istream>
#include <string_view>

namespace orb360 {
namespace {

constexpr std::string_view kSphericalUuid(
    "\xff\xcc\x82\x63\xf8\x55\x4a\x93\x88\x14\x58\x7a\x02"
    "\x52\x1f\xdd",
    16);
constexpr std::uint64_t kMaxXmlBytes = 65536;
/// A file has tens of boxes at one level, with fragments some thousands; a damaged one could
/// consist of empty boxes alone.
constexpr int kMaxBoxes = 100000;

/// A range of bytes of the file.
struct Range {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
};

struct Box {
  std::array<char, 4> type;
  Range content;

  bool Is(std::string_view name) const { return std::string_view(type.data(), 4) == name; }
};

/// Reads `size` bytes from `at`, or nullopt if the file has not as many.
std::optional<std::string> ReadAt(std::istream& file, std::uint64_t at, std::uint64_t size) {
  std::string bytes(size, '\0');
  file.clear();
  file.seekg(static_cast<std::streamoff>(at));
  if (!file.read(bytes.data(), static_cast<std::streamsize>(size))) return std::nullopt;
  return bytes;
}

std::uint64_t BigEndian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (const char byte : bytes) value = value << 8 | static_cast<unsigned char>(byte);
  return value;
}

/// Reads the header of the box at the start of the range (ISO 14496-12, 4.2).
std::optional<Box> ReadBox(std::istream& file, Range range) {
  constexpr std::uint64_t kHeader = 8;
  constexpr std::uint64_t kLongHeader = 16;
  if (range.end - range.begin < kHeader) return std::nullopt;
  const std::optional<std::string> header = ReadAt(file, range.begin, kHeader);
  if (!header) return std::nullopt;
  std::uint64_t size = BigEndian(std::string_view(*header).substr(0, 4));
  std::uint64_t header_size = kHeader;
  if (size == 0) size = range.end - range.begin;  // up to the end
  if (size == 1) {
    const std::optional<std::string> long_size = ReadAt(file, range.begin + kHeader, kHeader);
    if (!long_size) return std::nullopt;
    size = BigEndian(*long_size);
    header_size = kLongHeader;
  }
  if (size < header_size || size > range.end - range.begin) return std::nullopt;
  return Box{{(*header)[4], (*header)[5], (*header)[6], (*header)[7]},
             {range.begin + header_size, range.begin + size}};
}

/// Calls visit(box) for the boxes of a range until it returns true. Returns whether it did.
template <typename Visitor>
bool AnyBox(std::istream& file, Range range, const Visitor& visit) {
  for (int count = 0; count < kMaxBoxes && range.begin < range.end; ++count) {
    const std::optional<Box> box = ReadBox(file, range);
    if (!box) return false;
    if (visit(*box)) return true;
    range.begin = box->content.end;
  }
  return false;
}

/// Whether a `trak` holds video: `mdia` with a `hdlr` of type `vide` (ISO 14496-12, 8.4.3).
bool IsVideo(std::istream& file, Range track) {
  return AnyBox(file, track, [&](const Box& media) {
    return media.Is("mdia") && AnyBox(file, media.content, [&](const Box& handler) {
             return handler.Is("hdlr") && handler.content.end - handler.content.begin >= 12 &&
                    ReadAt(file, handler.content.begin + 8, 4) == "vide";
           });
  });
}

std::optional<std::string> SphericalXml(std::istream& file, Range track) {
  std::optional<std::string> xml;
  AnyBox(file, track, [&](const Box& box) {
    const std::uint64_t size = box.content.end - box.content.begin;
    const std::uint64_t uuid_size = kSphericalUuid.size();
    if (!box.Is("uuid") || size < uuid_size || size > kMaxXmlBytes) return false;
    const std::optional<std::string> content = ReadAt(file, box.content.begin, size);
    if (!content || !content->starts_with(kSphericalUuid)) return false;
    xml = content->substr(uuid_size);
    return true;
  });
  return xml;
}

}  // namespace

std::optional<std::string> FindGSphericalXml(std::istream& file, int number) {
  file.seekg(0, std::ios::end);
  const std::streamoff size = file.tellg();
  if (size <= 0) return std::nullopt;
  std::optional<std::string> xml;
  AnyBox(file, {0, static_cast<std::uint64_t>(size)}, [&](const Box& movie) {
    return movie.Is("moov") && AnyBox(file, movie.content, [&](const Box& track) {
             if (!track.Is("trak") || !IsVideo(file, track.content)) return false;
             if (number-- > 0) return false;
             xml = SphericalXml(file, track.content);
             return true;
           });
  });
  return xml;
}

}  // namespace orb360
