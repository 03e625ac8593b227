#include "slam/io/scale_file.h"

#include <cmath>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string>

#include "slam/io/atomic_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

void WriteScales(const std::filesystem::path& path, std::span<const StampedScale> scales) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << "# timestamp value sigma\n";
  for (const StampedScale& scale : scales) {
    text << std::fixed << std::setprecision(9) << scale.timestamp << std::defaultfloat
         << std::setprecision(6) << ' ' << scale.value << ' ' << scale.sigma << '\n';
  }
  WriteFileAtomically(path, text.str());
}

std::vector<StampedScale> ReadScales(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) {
    throw UserError(path.string() + ": cannot be opened as a file of scales");
  }
  std::vector<StampedScale> scales;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream words(line);
    words.imbue(std::locale::classic());
    StampedScale scale;
    std::string rest;
    const bool is_whole =
        static_cast<bool>(words >> scale.timestamp >> scale.value >> scale.sigma) &&
        !(words >> rest) && scale.value > 0 && scale.sigma > 0;
    if (!is_whole) {
      throw UserError(path.string() + ":" + std::to_string(number) +
                      ": is not a time, a scale and its standard deviation");
    }
    scales.push_back(scale);
  }
  return scales;
}

}  // namespace orb360
