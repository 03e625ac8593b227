#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <opencv2/imgproc.hpp>

#include "apps/town/image/noise.h"
#include "apps/town/image/paint.h"
#include "apps/town/image/random.h"

namespace orb360::town {
namespace {

Rgba RandomColour(Random& random, float low, float high) {
  const auto channel = [&] { return static_cast<float>(random.Uniform(low, high)); };
  const float r = channel();
  const float g = channel();
  const float b = channel();
  return {r, g, b, 1};
}

/// A made-up name of two to four syllables.
std::string RandomName(Random& random) {
  static constexpr std::array<const char*, 24> kSyllables = {
      "BA",  "LO", "MER", "TIN", "CA", "FE",  "RO",  "SA",  "VEN", "DO", "LI",  "KA",
      "NOR", "PE", "TRA", "MI",  "GU", "SOL", "BER", "HAN", "ZU",  "EL", "MAR", "OS"};
  static constexpr std::array<const char*, 14> kTrades = {
      "",      "",      "BAR",   "CAFE",  "MODE",     "BANK",   "HOTEL",
      "OPTIK", "PIZZA", "BOOKS", "SHOES", "APOTHEKE", "& SONS", "MARKET"};
  std::string name;
  const int syllables = 2 + random.Int(2);
  for (int i = 0; i < syllables; ++i) name += kSyllables[static_cast<size_t>(random.Int(24))];
  const std::string trade = kTrades[static_cast<size_t>(random.Int(14))];
  return trade.empty() ? name : name + " " + trade;
}

/// An 8-bit sRGB picture, its first row at the top, as a texture.
Texture FromPicture(const cv::Mat& picture) {
  std::vector<Rgba> texels;
  texels.reserve(picture.total());
  for (int y = picture.rows - 1; y >= 0; --y) {
    for (int x = 0; x < picture.cols; ++x) {
      const auto& c = picture.at<cv::Vec3b>(y, x);
      texels.push_back(Srgb(c[2], c[1], c[0]));
    }
  }
  return Texture(picture.cols, picture.rows, std::move(texels));
}

}  // namespace

Texture PaintRoom(uint32_t seed) {
  Random random(seed);
  const int kind = random.Int(5);
  const Rgba wall = 0.35F * RandomColour(random, 0.25F, 0.7F);
  const Rgba curtain = RandomColour(random, 0.35F, 0.85F);
  const float open = static_cast<float>(random.Uniform(0.15, 0.42));
  const float drop = static_cast<float>(random.Uniform(0.1, 0.9));
  const float lamp_x = static_cast<float>(random.Uniform(0.3, 0.7));
  const bool plant = random.Chance(0.3);
  const int folds = 10 + random.Int(8);
  return Texture::Paint(128, [=](float x, float y) {
    // The room darkens with depth; a lamp and the far wall show faintly.
    Rgba colour = (0.25F + 0.5F * y + 0.15F * TiledFbm(x, y, 3, 4, seed)) * (0.35F * wall);
    const float lamp = std::hypot(x - lamp_x, 1.4F * (y - 0.72F));
    colour = Mix({0.55F, 0.42F, 0.25F, 1}, colour, SmoothStep(0.03F, 0.12F, lamp));
    if (plant) {
      const float leaf = std::hypot(x - 0.5F, y - 0.16F) + 0.12F * TiledFbm(x, y, 10, 3, seed + 1);
      if (leaf < 0.17F)
        colour =
            (0.5F + 0.5F * LatticeValue(static_cast<int>(x * 40), static_cast<int>(y * 40), seed)) *
            Srgb(60, 90, 40);
    }
    const float fold = 0.75F + 0.25F * std::sin(x * 6.2831853F * static_cast<float>(folds) +
                                                2 * TiledFbm(x, y, 3, 2, seed + 2));
    if (kind <= 1 && (x < open || x > 1 - open)) {
      colour = (fold * (0.5F + 0.3F * y)) * curtain;
    } else if (kind == 2 && y > 1 - drop) {
      const float slat = y * 26 - std::floor(y * 26);
      colour = (0.3F + 0.35F * slat) * curtain;
    } else if (kind == 3) {
      colour = Mix(colour, (0.55F + 0.25F * fold) * Rgba{0.75F, 0.74F, 0.7F, 1}, 0.55F);
    }
    return colour;
  });
}

Texture PaintShop(uint32_t seed) {
  Random random(seed);
  const Rgba wall = RandomColour(random, 0.25F, 0.8F);
  const int shelves = 3 + random.Int(3);
  const int columns = 6 + random.Int(10);
  return Texture::Paint(256, [=](float x, float y) {
    Rgba colour = (0.3F + 0.35F * y) * wall;
    if (y > 0.86F) {
      const float strip = std::abs(x * 5 - std::floor(x * 5) - 0.5F);
      return strip < 0.3F ? Rgba{0.95F, 0.93F, 0.85F, 1} : 0.6F * wall;
    }
    const float shelf_y = y / 0.86F * static_cast<float>(shelves);
    const int shelf = static_cast<int>(shelf_y);
    const float in_shelf = shelf_y - static_cast<float>(shelf);
    const float column_x = x * static_cast<float>(columns) + 0.5F * LatticeValue(shelf, 1, seed);
    const int column = static_cast<int>(column_x);
    const float in_column = column_x - static_cast<float>(column);
    const float height = 0.3F + 0.6F * LatticeValue(column, shelf, seed + 1);
    if (in_shelf < 0.06F) return 0.25F * wall;
    if (in_shelf < height && in_column > 0.08F &&
        in_column < 0.55F + 0.4F * LatticeValue(column, shelf, seed + 2)) {
      colour = {0.1F + 0.7F * LatticeValue(column, shelf, seed + 3),
                0.1F + 0.6F * LatticeValue(column, shelf, seed + 4),
                0.1F + 0.5F * LatticeValue(column, shelf, seed + 5), 1};
      const int label = static_cast<int>(in_shelf * 8);
      if (LatticeValue(column * 8 + label, shelf, seed + 6) > 0.65F)
        colour = Mix(colour, {0.8F, 0.8F, 0.75F, 1}, 0.7F);
    }
    return (0.65F + 0.15F * TiledFbm(x, y, 4, 5, seed + 7)) * colour;
  });
}

Texture PaintDoor(uint32_t seed) {
  Random random(seed);
  const Rgba paint = RandomColour(random, 0.04F, 0.35F);
  const bool glazed = random.Chance(0.5);
  const int rows = 2 + random.Int(3);
  return Texture::Paint(128, [=](float x, float y) {
    const float px = x * 2 - std::floor(x * 2);
    const float py = y * static_cast<float>(rows) - std::floor(y * static_cast<float>(rows));
    const float edge = std::min(std::min(px, 1 - px), std::min(py, 1 - py) * 1.5F);
    float value = 1 + 0.1F * TiledFbm(x, 0.125F * y, 24, 4, seed);
    value *= edge < 0.1F ? 1.0F : (edge < 0.16F ? 0.55F : 0.85F);
    if (glazed && y > 0.5F && edge > 0.16F) return Rgba{0.05F, 0.06F, 0.07F, 1};
    if (std::hypot(x - 0.9F, 1.5F * (y - 0.46F)) < 0.035F) return Rgba{0.6F, 0.52F, 0.3F, 1};
    return value * paint;
  });
}

Texture PaintSign(uint32_t seed) {
  Random random(seed);
  const bool dark = random.Chance(0.6);
  const auto channel = [&](bool low) { return random.Uniform(low ? 10 : 170, low ? 110 : 255); };
  const auto colour = [&](bool low) {
    const double b = channel(low);
    const double g = channel(low);
    const double r = channel(low);
    return cv::Scalar(b, g, r);
  };
  const cv::Scalar board = colour(dark);
  const cv::Scalar ink = colour(!dark);
  cv::Mat picture(128, 512, CV_8UC3, board);
  const std::string name = RandomName(random);
  static constexpr std::array<int, 4> kFonts = {cv::FONT_HERSHEY_DUPLEX, cv::FONT_HERSHEY_TRIPLEX,
                                                cv::FONT_HERSHEY_COMPLEX, cv::FONT_HERSHEY_SIMPLEX};
  const int font = kFonts[static_cast<size_t>(random.Int(4))];
  const int thickness = 3 + random.Int(4);
  int baseline = 0;
  const cv::Size unit = cv::getTextSize(name, font, 1.0, thickness, &baseline);
  const double scale = std::min(440.0 / unit.width, 62.0 / unit.height);
  const cv::Size size = cv::getTextSize(name, font, scale, thickness, &baseline);
  cv::putText(picture, name, {(512 - size.width) / 2, (128 + size.height) / 2}, font, scale, ink,
              thickness, cv::LINE_AA);
  if (random.Chance(0.5)) cv::rectangle(picture, {6, 6}, {505, 121}, ink, 3, cv::LINE_AA);
  return FromPicture(picture);
}

Texture PaintRailing(uint32_t seed) {
  return Texture::Paint(128, [seed](float x, float y) {
    const float bar = std::abs(x * 8 - std::floor(x * 8) - 0.5F);
    const bool solid =
        bar < 0.09F || y > 0.94F || (y > 0.06F && y < 0.11F) || (y > 0.8F && y < 0.84F);
    const float value = 0.04F * (1 + 0.3F * TiledFbm(x, y, 8, 4, seed));
    return Rgba{value, value, value, solid ? 1.0F : 0.0F};
  });
}

}  // namespace orb360::town
