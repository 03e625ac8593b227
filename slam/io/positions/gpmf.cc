#include "slam/io/positions/gpmf.h"

#include <algorithm>
#include <cstdint>
#include <string>

#include "nn/base/number_text.h"
#include "slam/io/byte_number.h"
#include "slam/io/positions/utc_time.h"

namespace orb360 {
namespace {

/// One key, length and value: `count` elements of `size` bytes, each of the type `type`. All
/// numbers are big-endian.
struct Klv {
  std::string_view key;
  char type = 0;  // 0: nested KLV
  size_t size = 0;
  size_t count = 0;
  std::string_view value;
};

/// Takes the next KLV from the front of `data`; none at the end and where one is cut off.
std::optional<Klv> TakeKlv(std::string_view* data) {
  constexpr size_t kHeader = 8;
  if (data->size() < kHeader) return std::nullopt;
  Klv klv;
  klv.key = data->substr(0, 4);
  klv.type = (*data)[4];
  klv.size = static_cast<unsigned char>((*data)[5]);
  klv.count = *ReadNumber<std::uint16_t>(*data, 6, std::endian::big);
  const size_t length = klv.size * klv.count;
  if (data->size() - kHeader < length) return std::nullopt;
  klv.value = data->substr(kHeader, length);
  const size_t padded = (length + 3) / 4 * 4;  // Values end at multiples of 32 bits.
  data->remove_prefix(std::min(kHeader + padded, data->size()));
  return klv;
}

size_t SizeOfType(char type) {
  switch (type) {
    case 'b':
    case 'B':
      return 1;
    case 's':
    case 'S':
      return 2;
    case 'f':
    case 'l':
    case 'L':
      return 4;
    case 'd':
    case 'j':
    case 'J':
      return 8;
    default:
      return 0;
  }
}

template <typename Number>
std::optional<double> NumberAt(std::string_view data, size_t at) {
  const std::optional<Number> number = ReadNumber<Number>(data, at, std::endian::big);
  if (!number) return std::nullopt;
  return static_cast<double>(*number);
}

std::optional<double> NumberAt(std::string_view data, size_t at, char type) {
  switch (type) {
    case 'b':
      return NumberAt<std::int8_t>(data, at);
    case 'B':
      return NumberAt<std::uint8_t>(data, at);
    case 's':
      return NumberAt<std::int16_t>(data, at);
    case 'S':
      return NumberAt<std::uint16_t>(data, at);
    case 'l':
      return NumberAt<std::int32_t>(data, at);
    case 'L':
      return NumberAt<std::uint32_t>(data, at);
    case 'f':
      return NumberAt<float>(data, at);
    case 'd':
      return NumberAt<double>(data, at);
    case 'j':
      return NumberAt<std::int64_t>(data, at);
    case 'J':
      return NumberAt<std::uint64_t>(data, at);
    default:
      return std::nullopt;
  }
}

/// The first `max_numbers` numbers of a value whose elements are of a simple type.
std::vector<double> Numbers(const Klv& klv, size_t max_numbers) {
  std::vector<double> numbers;
  const size_t step = SizeOfType(klv.type);
  if (step == 0) return numbers;
  for (size_t at = 0; at + step <= klv.value.size() && numbers.size() < max_numbers; at += step) {
    numbers.push_back(*NumberAt(klv.value, at, klv.type));
  }
  return numbers;
}

/// What a stream (STRM) says of its measurements, and these.
struct GpsStream {
  std::optional<Klv> gps5, gps9;
  std::string_view type;      // of a structure's elements, such as "lllllllSS"
  std::vector<double> scale;  // divisors: one, or one for each element
  std::optional<double> fix;  // 0: no lock; 2, 3: dimensions
  std::optional<double> dop;  // dilution of precision * 100
  std::string_view utc;       // yymmddhhmmss.sss
  std::string_view altitude;  // "MSLV": over mean sea level
};

constexpr size_t kGps5Numbers = 5;  // latitude, longitude, altitude, 2-D speed, 3-D speed
// The same, days since 2000, seconds since midnight, dilution of precision, fix.
constexpr size_t kGps9Numbers = 9;

GpsStream ReadStream(std::string_view data) {
  GpsStream stream;
  while (const std::optional<Klv> klv = TakeKlv(&data)) {
    const auto first = [&]() -> std::optional<double> {
      const std::vector<double> numbers = Numbers(*klv, 1);
      return numbers.empty() ? std::nullopt : std::optional(numbers.front());
    };
    if (klv->key == "GPS5" && klv->type == 'l') stream.gps5 = klv;
    if (klv->key == "GPS9" && klv->type == '?') stream.gps9 = klv;
    if (klv->key == "TYPE") stream.type = klv->value;
    if (klv->key == "SCAL") stream.scale = Numbers(*klv, kGps9Numbers);
    if (klv->key == "GPSF") stream.fix = first();
    if (klv->key == "GPSP") stream.dop = first();
    if (klv->key == "GPSU") stream.utc = klv->value;
    if (klv->key == "GPSA") stream.altitude = klv->value;
  }
  return stream;
}

/// Seconds since 1970 of `yymmddhhmmss.sss`, in the years 2000 to 2099.
std::optional<double> ParseGpsu(std::string_view text) {
  if (text.size() < 13) return std::nullopt;
  const auto two = [&](size_t at) { return ParseNumber<int>(text.substr(at, 2)).value_or(-1); };
  const std::string_view seconds = text.substr(10, 6);
  return UtcSeconds(2000 + two(0), two(2), two(4), two(6), two(8),
                    ParseNumber<double>(seconds).value_or(-1));
}

/// The numbers of one measurement, divided by their scale. Empty where a number is missing.
std::vector<double> Measurement(std::string_view data, std::string_view types,
                                const std::vector<double>& scale) {
  std::vector<double> numbers;
  size_t at = 0;
  for (size_t i = 0; i < types.size(); ++i) {
    const std::optional<double> number = NumberAt(data, at, types[i]);
    const double divisor = scale.empty() ? 1.0 : scale[scale.size() == 1 ? 0 : i];
    if (!number || divisor == 0) return {};
    numbers.push_back(*number / divisor);
    at += SizeOfType(types[i]);
  }
  return numbers;
}

void SetSigmas(double dop, GeodeticFix* fix) {
  if (!(dop > 0)) return;
  fix->horizontal_sigma = dop * kMetresPerDop;
  fix->vertical_sigma = dop * kMetresPerDop * kVerticalPerHorizontal;
}

GpmfPositions ReadMeasurements(const GpsStream& stream) {
  GpmfPositions positions;
  if (stream.altitude.starts_with("MSLV")) {
    positions.altitude_reference = AltitudeReference::kMeanSeaLevel;
  }
  const bool is_gps9 = stream.gps9.has_value();
  const Klv& klv = is_gps9 ? *stream.gps9 : *stream.gps5;
  const size_t count = is_gps9 ? kGps9Numbers : kGps5Numbers;
  const std::string_view types = is_gps9 ? stream.type.substr(0, count) : "lllll";
  const bool is_scaled = stream.scale.size() <= 1 || stream.scale.size() >= count;
  if (types.size() < count || !is_scaled) return positions;
  if (!is_gps9) positions.utc = ParseGpsu(stream.utc);
  for (size_t i = 0; i < klv.count; ++i) {
    const std::string_view data = klv.value.substr(i * klv.size, klv.size);
    const std::vector<double> numbers = Measurement(data, types, stream.scale);
    if (numbers.empty()) continue;
    const double lock = is_gps9 ? numbers[8] : stream.fix.value_or(3);
    if (lock < 2) {
      ++positions.num_without_lock;
      continue;
    }
    GeodeticFix fix;
    fix.timestamp = static_cast<double>(i) / static_cast<double>(klv.count);
    fix.latitude = numbers[0];
    fix.longitude = numbers[1];
    if (lock >= 3) fix.altitude = numbers[2];
    SetSigmas(is_gps9 ? numbers[7] : stream.dop.value_or(0) / 100, &fix);
    if (!IsPlausible(fix)) continue;
    if (is_gps9 && positions.fixes.empty()) {
      constexpr double k2000 = 946684800;  // seconds from 1970 to 2000
      positions.utc = k2000 + 86400 * numbers[5] + numbers[6];
    }
    positions.fixes.push_back(fix);
  }
  return positions;
}

}  // namespace

GpmfPositions ParseGpmf(std::string_view sample) {
  std::optional<GpsStream> chosen;
  while (const std::optional<Klv> device = TakeKlv(&sample)) {
    if (device->key != "DEVC" || device->type != 0) continue;
    std::string_view streams = device->value;
    while (const std::optional<Klv> klv = TakeKlv(&streams)) {
      if (klv->key != "STRM" || klv->type != 0) continue;
      const GpsStream stream = ReadStream(klv->value);
      const bool is_better = stream.gps9 || (stream.gps5 && !chosen);
      if (is_better && !(chosen && chosen->gps9)) chosen = stream;
    }
  }
  return chosen ? ReadMeasurements(*chosen) : GpmfPositions();
}

}  // namespace orb360
