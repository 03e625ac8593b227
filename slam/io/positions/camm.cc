#include "slam/io/positions/camm.h"

#include <cmath>
#include <cstdint>

#include "slam/io/byte_number.h"

namespace orb360 {
namespace {

/// Bytes of a packet of each type with its header: two reserved bytes and the type.
size_t PacketSize(int type) {
  switch (type) {
    case 0:  // angle axis
    case 2:  // angular velocity
    case 3:  // acceleration
    case 4:  // position in a local frame
    case 7:  // magnetic field
      return 16;
    case 1:  // exposure time, rolling shutter
      return 12;
    case 5:
      return 28;
    case 6:
      return 60;
    default:
      return 0;
  }
}

/// Radius that holds 68 % of a two-dimensional normal distribution, standard deviations of one
/// direction: sqrt(-2 ln(1 - 0.68)).
const double kRadius68 = std::sqrt(-2 * std::log(0.32));

template <typename Number>
double NumberAt(std::string_view packet, size_t at) {
  return static_cast<double>(*ReadNumber<Number>(packet, at, std::endian::little));
}

std::optional<double> PositiveOrNone(double number) {
  return std::isfinite(number) && number > 0 ? std::optional(number) : std::nullopt;
}

GeodeticFix FixAt(std::string_view packet, size_t at) {
  GeodeticFix fix;
  fix.latitude = NumberAt<double>(packet, at);
  fix.longitude = NumberAt<double>(packet, at + 8);
  return fix;
}

void ReadPosition(std::string_view packet, CammPositions* positions) {
  GeodeticFix fix = FixAt(packet, 4);
  fix.altitude = NumberAt<double>(packet, 20);
  if (IsPlausible(fix)) positions->without_accuracy.push_back(fix);
}

void ReadGps(std::string_view packet, CammPositions* positions) {
  const double lock = NumberAt<std::int32_t>(packet, 12);
  if (lock < 2) {
    ++positions->num_without_lock;
    return;
  }
  GeodeticFix fix = FixAt(packet, 16);
  if (lock >= 3) fix.altitude = NumberAt<float>(packet, 32);
  fix.horizontal_sigma = PositiveOrNone(NumberAt<float>(packet, 36) / kRadius68);
  fix.vertical_sigma = PositiveOrNone(NumberAt<float>(packet, 40));
  if (!IsPlausible(fix)) return;
  if (positions->with_accuracy.empty()) positions->gps_time = NumberAt<double>(packet, 4);
  positions->with_accuracy.push_back(fix);
}

}  // namespace

CammPositions ParseCamm(std::string_view sample) {
  CammPositions positions;
  while (const auto type = ReadNumber<std::uint16_t>(sample, 2, std::endian::little)) {
    const size_t size = PacketSize(*type);
    if (size == 0 || sample.size() < size) break;
    const std::string_view packet = sample.substr(0, size);
    if (*type == 5) ReadPosition(packet, &positions);
    if (*type == 6) ReadGps(packet, &positions);
    sample.remove_prefix(size);
  }
  return positions;
}

}  // namespace orb360
