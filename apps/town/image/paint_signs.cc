#include <algorithm>
#include <array>
#include <cctype>
#include <span>
#include <string>

#include <opencv2/imgproc.hpp>

#include "apps/town/image/noise.h"
#include "apps/town/image/paint.h"
#include "apps/town/image/random.h"

namespace orb360::town {
namespace {

constexpr std::array<const char*, 16> kTrades = {
    "",      "",      "BAR",   "CAFE",     "MODE",   "BANK",   "HOTEL",  "OPTIK",
    "PIZZA", "BOOKS", "SHOES", "APOTHEKE", "& SONS", "MARKET", "BAKERY", "CYCLES"};

/// Returns an invented name of two to four syllables.
std::string RandomName(Random& random) {
  static constexpr std::array<const char*, 24> kSyllables = {
      "BA",  "LO", "MER", "TIN", "CA", "FE",  "RO",  "SA",  "VEN", "DO", "LI",  "KA",
      "NOR", "PE", "TRA", "MI",  "GU", "SOL", "BER", "HAN", "ZU",  "EL", "MAR", "OS"};
  std::string name;
  const int syllables = 2 + random.Int(2);
  for (int i = 0; i < syllables; ++i) name += kSyllables[static_cast<size_t>(random.Int(24))];
  return name;
}

/// Returns a printer's colour in OpenCV's form, near a gray in [low, high] and not too saturated.
cv::Scalar DrawColour(Random& random, double low, double high) {
  const double grey = random.Uniform(low, high);
  const double reach = std::min(0.45 * grey + 12, 70.0);
  const double b = grey + random.Uniform(-reach, 0.6 * reach);
  const double g = grey + random.Uniform(-reach, reach);
  const double r = grey + random.Uniform(-reach, 1.2 * reach);
  return {b, g, r};
}

/// Writes `text` centred on `centre`, as large as it fits in `box`.
void WriteCentred(cv::Mat& image, const std::string& text, cv::Point centre, cv::Size box, int font,
                  int thickness, const cv::Scalar& ink) {
  int baseline = 0;
  const cv::Size unit = cv::getTextSize(text, font, 1.0, thickness, &baseline);
  const double scale = std::min(static_cast<double>(box.width) / unit.width,
                                static_cast<double>(box.height) / unit.height);
  const cv::Size size = cv::getTextSize(text, font, scale, thickness, &baseline);
  cv::putText(image, text, {centre.x - size.width / 2, centre.y + size.height / 2}, font, scale,
              ink, thickness, cv::LINE_AA);
}

constexpr std::array<int, 5> kFonts = {cv::FONT_HERSHEY_DUPLEX, cv::FONT_HERSHEY_TRIPLEX,
                                       cv::FONT_HERSHEY_COMPLEX, cv::FONT_HERSHEY_SIMPLEX,
                                       cv::FONT_HERSHEY_SCRIPT_COMPLEX};

/// Draws blobs, bars and rings, as a printed motif.
void DrawMotif(cv::Mat& image, Random& random, const cv::Rect& area) {
  const auto point = [&] {
    const int x = area.x + random.Int(area.width);
    return cv::Point(x, area.y + random.Int(area.height));
  };
  const int shapes = 3 + random.Int(5);
  for (int i = 0; i < shapes; ++i) {
    const cv::Scalar colour = DrawColour(random, 20, 240);
    const cv::Point centre = point();
    const int size = area.width / 10 + random.Int(area.width / 4);
    switch (random.Int(4)) {
      case 0:
        cv::circle(image, centre, size, colour, cv::FILLED, cv::LINE_AA);
        break;
      case 1:
        cv::circle(image, centre, size, colour, 2 + size / 6, cv::LINE_AA);
        break;
      case 2:
        cv::rectangle(image, centre, centre + cv::Point(size, size / 2), colour, cv::FILLED);
        break;
      default:
        cv::line(image, centre, point(), colour, 2 + size / 8, cv::LINE_AA);
        break;
    }
  }
}

/// Converts an 8-bit sRGB image, whose first row is at the top, to a texture.
Texture FromImage(const cv::Mat& image) {
  std::vector<Rgba> texels;
  texels.reserve(image.total());
  for (int y = image.rows - 1; y >= 0; --y) {
    for (int x = 0; x < image.cols; ++x) {
      const auto& c = image.at<cv::Vec3b>(y, x);
      texels.push_back(Srgb(c[2], c[1], c[0]));
    }
  }
  return Texture(image.cols, image.rows, std::move(texels));
}

}  // namespace

Texture PaintSign(uint32_t seed) {
  Random random(seed);
  const bool dark = random.Chance(0.65);
  cv::Mat image(128, 512, CV_8UC3,
                dark ? DrawColour(random, 15, 100) : DrawColour(random, 160, 225));
  const cv::Scalar ink = dark ? DrawColour(random, 170, 240) : DrawColour(random, 10, 100);
  std::string text = RandomName(random);
  const std::string trade = random.Pick(std::span<const char* const>(kTrades));
  if (!trade.empty()) text += " " + trade;
  const int font = random.Pick(std::span<const int>(kFonts));
  if (font == cv::FONT_HERSHEY_SCRIPT_COMPLEX) {
    for (size_t i = 1; i < text.size(); ++i) {
      if (text[i - 1] != ' ' && text[i] != ' ')
        text[i] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[i])));
    }
  }
  WriteCentred(image, text, {256, 64}, {random.Chance(0.3) ? 340 : 430, 60}, font,
               3 + random.Int(4), ink);
  if (random.Chance(0.4)) cv::rectangle(image, {6, 6}, {505, 121}, ink, 3, cv::LINE_AA);
  if (random.Chance(0.3)) cv::circle(image, {34, 64}, 20, ink, 5, cv::LINE_AA);
  return FromImage(image);
}

Texture PaintNumberPlate(uint32_t seed) {
  Random random(seed);
  cv::Mat image(64, 256, CV_8UC3, cv::Scalar(205, 222, 225));
  cv::rectangle(image, {0, 0}, {22, 63}, {140, 60, 20}, cv::FILLED);
  cv::rectangle(image, {1, 1}, {254, 62}, {30, 30, 30}, 2);
  std::string text;
  for (int i = 0; i < 3; ++i) text += static_cast<char>('A' + random.Int(26));
  text += ' ';
  for (int i = 0; i < 4; ++i) text += static_cast<char>('0' + random.Int(10));
  WriteCentred(image, text, {138, 32}, {210, 40}, cv::FONT_HERSHEY_DUPLEX, 3, {25, 25, 25});
  return FromImage(image);
}

Texture PaintPoster(uint32_t seed) {
  Random random(seed);
  cv::Mat image(256, 128, CV_8UC3, DrawColour(random, 40, 235));
  DrawMotif(image, random, {0, 50, 128, 130});
  const cv::Scalar ink = DrawColour(random, 0, 60);
  cv::rectangle(image, {0, 0}, {127, 44}, DrawColour(random, 190, 240), cv::FILLED);
  WriteCentred(image, RandomName(random), {64, 22}, {112, 24},
               random.Pick(std::span<const int>(kFonts)), 3, ink);
  cv::rectangle(image, {0, 200}, {127, 255}, DrawColour(random, 190, 240), cv::FILLED);
  for (int y = 210; y < 250; y += 9)
    cv::line(image, {10, y}, {40 + random.Int(76), y}, ink, 3, cv::LINE_AA);
  return FromImage(image);
}

Texture PaintHouseNumber(uint32_t seed) {
  Random random(seed);
  cv::Mat image(64, 64, CV_8UC3,
                random.Chance(0.6) ? cv::Scalar(110, 50, 25) : cv::Scalar(40, 60, 35));
  cv::rectangle(image, {2, 2}, {61, 61}, {220, 225, 225}, 3);
  WriteCentred(image, std::to_string(1 + random.Int(98)), {32, 32}, {40, 34},
               cv::FONT_HERSHEY_DUPLEX, 4, {225, 230, 230});
  return FromImage(image);
}

Texture PaintMural(uint32_t seed) {
  Random random(seed);
  constexpr int kSize = 512;
  cv::Mat image(kSize, kSize, CV_8UC3, DrawColour(random, 90, 215));
  DrawMotif(image, random, {20, 170, kSize - 40, kSize - 260});
  const cv::Scalar ink = DrawColour(random, 10, 90);
  const int font = random.Pick(std::span<const int>(kFonts));
  WriteCentred(image, RandomName(random), {kSize / 2, 90}, {420, 80}, font, 12, ink);
  WriteCentred(image, "SINCE " + std::to_string(1880 + random.Int(90)), {kSize / 2, 450}, {300, 34},
               font, 5, ink);
  cv::rectangle(image, {10, 10}, {kSize - 11, kSize - 11}, ink, 8);
  // Paint flakes off, and the rest has faded.
  const Texture flat = FromImage(image);
  return Texture::Paint(kSize / 2, [&flat, seed](float x, float y) {
    Rgba c = flat.Sample(x, y, 1);
    const float age = TiledFbm(x, y, 4, 6, seed, 0.7F);
    c = 0.8F * Mix(c, {0.34F, 0.31F, 0.27F, 1}, 0.5F + 0.2F * age);
    const bool inside = std::min({x, y, 1 - x, 1 - y}) > 0.008F;
    c.a = inside && age < 0.55F ? 1.0F : 0.0F;
    return c;
  });
}

}  // namespace orb360::town
