#include "slam/features/sphere_band.h"

#include <cmath>

#include <gtest/gtest.h>

namespace orb360 {
namespace {

// A level whose grey value is a smooth function of the direction.
double Grey(const Eigen::Vector3d& ray) {
  return 128 + 50 * std::sin(3 * ray.x()) + 40 * std::sin(2 * ray.y() + 1) + 30 * ray.z();
}

std::vector<PyramidLevel> SmoothLevels() {
  const EquirectangularCamera camera(512, 256);
  cv::Mat image(256, 512, CV_8U);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image.at<uint8_t>(y, x) =
          static_cast<uint8_t>(std::lround(Grey(camera.Bearing({x + 0.5, y + 0.5}))));
    }
  }
  std::vector<PyramidLevel> levels;
  BuildSpherePyramid(image, 3, &levels);
  return levels;
}

TEST(SphereBand, BandsCoverEveryRowOnce) {
  const std::vector<PyramidLevel> levels = SmoothLevels();
  for (const PyramidLevel& level : levels) {
    int next = 0;
    for (int index = 0; index < kSphereBands; ++index) {
      SphereBand band;
      CutBand(level, index, &band);
      EXPECT_EQ(band.y_begin, next);
      next = band.y_end;
    }
    EXPECT_EQ(next, level.camera.height());
  }
}

TEST(SphereBand, APixelShowsTheDirectionOfItsColumnAndRow) {
  const std::vector<PyramidLevel> levels = SmoothLevels();
  for (const PyramidLevel& level : levels) {
    for (int index = 0; index < kSphereBands; ++index) {
      SphereBand band;
      CutBand(level, index, &band);
      ASSERT_EQ(band.width % kSphereColumns, 0);
      for (int y = band.y_begin; y < band.y_end; ++y) {
        // Margins too: they continue around the sphere.
        for (int x = -PyramidLevel::kMarginX; x < band.width + PyramidLevel::kMarginX; ++x) {
          const double u = (x + 0.5) * level.camera.width() / band.width;
          ASSERT_NEAR(*band.Pixel(x, y), Grey(level.camera.Bearing({u, y + 0.5})), 2.5)
              << x << ' ' << y << " of band " << index;
        }
      }
    }
  }
}

TEST(SphereBand, NearThePolesPixelsAreAboutSquareOnTheSphere) {
  const std::vector<PyramidLevel> levels = SmoothLevels();
  for (const int index : {1, 2, 3, 12, 13, 14}) {
    SphereBand band;
    CutBand(levels[0], index, &band);
    const double latitude = M_PI * ((index + 0.5) / kSphereBands - 0.5);
    const double column = 2 * M_PI * std::cos(latitude) / band.width;  // rad
    const double row = M_PI / levels[0].camera.height();
    EXPECT_NEAR(column / row, 1.0, 0.2) << index;
  }
}

TEST(SphereBand, BlurIsAGaussianOfTwoPixels) {
  const std::vector<PyramidLevel> levels = SmoothLevels();
  PyramidLevel level = levels[0];
  level.padded = level.padded.clone();
  cv::randu(level.padded, 0, 256);
  FillSphereMargin(&level);
  for (const int index : {1, 7}) {  // compressed, and a view of the level
    SphereBand band;
    CutBand(level, index, &band);
    SphereBand blurred;
    cv::Mat whole(level.padded.size(), CV_8U);
    BlurBand(index, band, &whole, &blurred);
    for (int y = band.y_begin; y < band.y_end; ++y) {
      for (int x = 0; x < band.width; ++x) {
        double sum = 0;
        double weights = 0;
        for (int dy = -3; dy <= 3; ++dy) {
          for (int dx = -3; dx <= 3; ++dx) {
            const double weight = std::exp(-(dx * dx + dy * dy) / 8.0);
            sum += weight * *band.Pixel(x + dx, y + dy);
            weights += weight;
          }
        }
        // Weights rounded to 1/256, and both passes to whole grey levels.
        ASSERT_NEAR(*blurred.Pixel(x, y), sum / weights, 2.0) << x << ' ' << y;
      }
    }
  }
}

}  // namespace
}  // namespace orb360
