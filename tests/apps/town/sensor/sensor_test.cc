#include "apps/town/sensor/sensor.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <omp.h>
#include <opencv2/imgcodecs.hpp>

#include "apps/town/render/renderer.h"
#include "apps/town/render/tone.h"
#include "apps/town/sensor/auto_exposure.h"
#include "apps/town/sensor/dual_lens.h"
#include "apps/town/sensor/motion_blur.h"
#include "apps/town/sensor/sensor_noise.h"
#include "tests/apps/town/plain_materials.h"

namespace orb360::town {
namespace {

constexpr int kWidth = 256;
constexpr int kHeight = 128;
const EquirectangularCamera kCamera(kWidth, kHeight);

cv::Mat3f Constant(float radiance) {
  return cv::Mat3f(kHeight, kWidth, cv::Vec3f(radiance, radiance, radiance));
}

/// The bearing of every pixel in its channels, shifted to be positive.
cv::Mat3f Bearings() {
  cv::Mat3f image(kHeight, kWidth);
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const Eigen::Vector3d bearing = kCamera.Bearing({column + 0.5, row + 0.5});
      image(row, column) = cv::Vec3d(bearing.x() + 2, bearing.y() + 2, bearing.z() + 2);
    }
  }
  return image;
}

double Difference(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF); }

TEST(CaptureImage, WithoutEffectsGivesTheBytesOfTheRenderer) {
  const Materials materials = PlainMaterials();
  Scenery scenery;
  scenery.palette = materials;
  MeshBuilder builder(materials);
  builder.AddGroundPolygon(1, {{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}});
  scenery.fixed = builder.mesh();
  scenery.fixed.PartitionCutouts(materials);
  const RayScene rays(scenery);
  const FrameScene scene(rays, {});
  const Light light = MakeLight("noon", 1);
  const Sky sky(light, 1);
  const Shader shader(scenery.palette, light, sky);
  Rigid3 pose;
  pose.translation = {0.3, -0.4, 1.7};
  const RadianceAt radiance = [&](double) { return RenderRadiance(scene, shader, kCamera, pose); };
  const cv::Mat3b plain = RenderColour(scene, shader, kCamera, pose);
  EXPECT_EQ(Difference(CaptureImage({}, 3, 0.15, radiance, radiance), plain), 0);
  SensorOptions noisy;
  noisy.noise = SensorNoise();
  EXPECT_GT(Difference(CaptureImage(noisy, 3, 0.15, radiance, radiance), plain), 0);
}

TEST(MeteredRadiance, IsTheGeometricMeanByAreaOnTheSphere) {
  EXPECT_NEAR(MeteredRadiance(Constant(0.3F)), 0.3, 1e-6);
  // A cap down to a latitude of 30 degrees is a quarter of the sphere.
  cv::Mat3f cap = Constant(0.1F);
  cap.rowRange(0, 43).setTo(cv::Scalar::all(1.6));  // a third of the rows
  EXPECT_NEAR(std::log(MeteredRadiance(cap)), 0.25 * std::log(1.6) + 0.75 * std::log(0.1), 0.02);
  cv::Mat3f green(kHeight, kWidth, cv::Vec3f(0, 0.5F, 0));
  EXPECT_NEAR(MeteredRadiance(green), 0.5 * 0.7152, 1e-4);
}

TEST(ExposureGain, IsAWholeNumberOfStepsAndAtMostHalfAStepFromTheKey) {
  const AutoExposure options{.step = 0.5, .limit = 3, .key = 0.2};
  for (double metered = 0.2 / 7.5; metered < 0.2 * 7.5; metered *= 1.07) {
    const double steps = std::log2(ExposureGain(options, metered)) / options.step;
    EXPECT_NEAR(steps, std::round(steps), 1e-9);
    EXPECT_LE(std::abs(std::log2(metered * ExposureGain(options, metered) / 0.2)), 0.25 + 1e-9);
  }
  EXPECT_EQ(ExposureGain(options, 1e-6), 8);
  EXPECT_EQ(ExposureGain(options, 1e6), 1.0 / 8);
}

TEST(ExposureGainAt, ChangesOnlyWhenThePeriodHasPassed) {
  const AutoExposure options{.period = 0.5, .key = 0.2};
  std::vector<double> metered_at;
  const RadianceAt darkening = [&](double seconds) {
    metered_at.push_back(seconds);
    return Constant(static_cast<float>(0.2 * std::exp2(-seconds)));
  };
  double last = 1;
  for (int frame = 0; frame < 40; ++frame) {  // 20 a second
    const double gain = ExposureGainAt(options, frame / 20.0, darkening);
    EXPECT_NEAR(metered_at.back(), 0.5 * std::floor(frame / 10.0), 1e-9);
    if (frame % 10 == 0) {
      EXPECT_GE(gain, last);
    } else {
      EXPECT_EQ(gain, last);
    }
    last = gain;
  }
  EXPECT_NEAR(std::log2(last), 1.5, 0.5 / 3 + 1e-6);
}

TEST(Blurred, AveragesLightOverTheTimeTheShutterIsOpen) {
  std::vector<double> times;
  const cv::Mat3f blurred = Blurred({.shutter = 0.02, .moments = 4}, 3.0, [&](double seconds) {
    times.push_back(seconds);
    return Constant(static_cast<float>(seconds * seconds));
  });
  ASSERT_EQ(times.size(), 4U);
  EXPECT_NEAR(times.front(), 2.9925, 1e-12);
  EXPECT_NEAR(times.back(), 3.0075, 1e-12);
  double mean = 0;
  for (const double time : times) mean += time * time / 4;
  EXPECT_NEAR(blurred(5, 7)[1], mean, 1e-5);
}

TEST(AddNoise, HasTheMeanAndVarianceOfElectrons) {
  const SensorNoise options{.full_well = 1000, .read_noise = 8};
  for (const float radiance : {0.0F, 0.05F, 0.4F, 2.0F}) {
    cv::Mat3f image = Constant(radiance);
    AddNoise(options, 1, 2, &image);
    cv::Scalar mean;
    cv::Scalar deviation;
    cv::meanStdDev(image, mean, deviation);
    const double expected = std::sqrt(1000.0 * radiance + 64) / 1000;
    for (int channel = 0; channel < 3; ++channel) {
      EXPECT_NEAR(mean[channel], radiance, 4 * expected / std::sqrt(kWidth * kHeight));
      EXPECT_NEAR(deviation[channel], expected, 0.02 * expected);  // 5 deviations of a deviation
    }
    cv::Mat3f shifted;
    cv::hconcat(image.colRange(1, kWidth), image.colRange(0, 1), shifted);
    const cv::Mat noise = image - cv::Scalar::all(radiance);
    const cv::Mat shifted_noise = shifted - cv::Scalar::all(radiance);
    EXPECT_NEAR(noise.dot(shifted_noise) / noise.dot(noise), 0, 0.02);  // not correlated
  }
}

TEST(AddNoise, DependsOnSeedAndFrameOnly) {
  const auto noisy = [](uint64_t seed, int frame) {
    cv::Mat3f image = Constant(0.2F);
    AddNoise({}, seed, frame, &image);
    return image;
  };
  EXPECT_EQ(Difference(noisy(1, 5), noisy(1, 5)), 0);
  EXPECT_GT(Difference(noisy(1, 5), noisy(1, 6)), 0);
  EXPECT_GT(Difference(noisy(1, 5), noisy(2, 5)), 0);
}

TEST(StitchedFromTwoLenses, ShiftsOnlyByWhatTheBaselineExplains) {
  const cv::Mat3f bearings = Bearings();
  const DualLens options{.baseline = 0.2, .exposure_difference = 0, .rim_loss = 0, .overlap = 0.05};
  const cv::Mat3f image = StitchedFromTwoLenses(options, bearings);
  double largest = 0;
  for (int row = 2; row < kHeight - 2; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const Eigen::Vector3d bearing = kCamera.Bearing({column + 0.5, row + 0.5});
      const double inside = std::asin(bearing.x());
      if (std::abs(inside) < 0.03) continue;  // both lenses
      const cv::Vec3f& pixel = image(row, column);
      const Eigen::Vector3d seen =
          Eigen::Vector3d(pixel[0] - 2, pixel[1] - 2, pixel[2] - 2).normalized();
      const Eigen::Vector3d lens(bearing.x() < 0 ? -0.1 : 0.1, 0, 0);
      // The point that is seen lies on the road or on a wall, along the lens's ray.
      const double range = std::min(10 / std::hypot(bearing.x(), bearing.y()),
                                    bearing.z() < 0 ? 1.9 / -bearing.z() : 1e9);
      const Eigen::Vector3d expected = (lens + range * bearing).normalized();
      ASSERT_LT((seen - expected).norm(), 1e-3) << row << ' ' << column;
      largest = std::max(largest, (seen - bearing).norm());
    }
  }
  EXPECT_NEAR(largest, 0.1 / 1.9, 0.002);  // straight down
}

TEST(StitchedFromTwoLenses, MakesOneHalfBrighterAndBothRimsDarker) {
  const DualLens options{
      .baseline = 0, .exposure_difference = 0.5, .rim_loss = 0.3, .overlap = 0.2};
  const cv::Mat3f image = StitchedFromTwoLenses(options, Constant(0.5F));
  const auto level = [&](double longitude_degrees) {
    const int column = static_cast<int>(kWidth * (longitude_degrees / 360 + 0.5)) % kWidth;
    return image(kHeight / 2, column)[1];
  };
  EXPECT_NEAR(level(0), 0.5 * std::exp2(0.25), 1e-3);
  EXPECT_NEAR(level(180), 0.5 * std::exp2(-0.25), 1e-3);
  EXPECT_NEAR(level(-45) / level(0), 1 - 0.3 / 16, 2e-3);
  // At the seam both have lost the same, and one blends into the other.
  const float seam = 0.5F * (level(90) + level(89));  // the pixels on either side
  EXPECT_NEAR(seam, 0.7 * 0.25 * (std::exp2(0.25) + std::exp2(-0.25)), 3e-3);
  for (int column = 1; column < kWidth; ++column) {
    EXPECT_LT(std::abs(image(kHeight / 2, column)[1] - image(kHeight / 2, column - 1)[1]), 0.03);
  }
}

TEST(StitchedFromTwoLenses, WithAllParametersZeroChangesNothing) {
  const DualLens options{.baseline = 0, .exposure_difference = 0, .rim_loss = 0, .overlap = 0};
  EXPECT_LT(Difference(StitchedFromTwoLenses(options, Bearings()), Bearings()), 1e-4);
}

TEST(SensorOptions, SayWhichEffectsAreOn) {
  SensorOptions options;
  EXPECT_FALSE(options.HasEffects());
  EXPECT_EQ(Describe(options), "");
  options.motion_blur = MotionBlur{.shutter = 0.008, .moments = 3};
  EXPECT_TRUE(options.HasEffects());
  EXPECT_EQ(Describe(options), "sensor:\n  motion_blur: {shutter: 0.008, moments: 3}\n");
}

TEST(CaptureImage, CompressesAsTheQualitySays) {
  const RadianceAt radiance = [](double) {
    cv::Mat3f image = Constant(0.2F);
    AddNoise({.full_well = 300}, 1, 1, &image);
    return image;
  };
  const cv::Mat3b plain = CaptureImage({}, 0, 0, radiance, radiance);
  double last = 0;
  for (const int quality : {95, 70, 40}) {
    SensorOptions options;
    options.jpeg_quality = quality;
    const cv::Mat3b image = CaptureImage(options, 0, 0, radiance, radiance);
    const double error = cv::norm(image, plain, cv::NORM_L1);
    EXPECT_GT(error, last);
    last = error;
  }
}

TEST(CaptureImage, AppliesEffectsInTheOrderOfACamera) {
  SensorOptions options;
  options.motion_blur = MotionBlur{.shutter = 0.1, .moments = 2};
  options.auto_exposure = AutoExposure{.key = 0.4};
  options.dual_lens = DualLens();
  options.noise = SensorNoise();
  options.seed = 9;
  const RadianceAt radiance = [](double seconds) -> cv::Mat3f {
    return Bearings() * (0.1 + seconds);
  };
  const RadianceAt meter = [](double) { return Constant(0.1F); };
  cv::Mat3f light = StitchedFromTwoLenses(DualLens(), radiance(1));
  light *= 4;
  AddNoise(SensorNoise(), 9, 7, &light);
  const ToneCurve tone;
  const cv::Mat3b image = CaptureImage(options, 7, 1, radiance, meter);
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const cv::Vec3f& pixel = light(row, column);
      const cv::Vec3b expected = tone.Encode({pixel[2], pixel[1], pixel[0]});
      ASSERT_LE(cv::norm(image(row, column), expected, cv::NORM_INF), 1);
    }
  }
}

TEST(CaptureImage, GivesTheSameBytesForAnyNumberOfThreads) {
  SensorOptions options;
  options.motion_blur = MotionBlur();
  options.auto_exposure = AutoExposure();
  options.dual_lens = DualLens();
  options.noise = SensorNoise();
  options.jpeg_quality = 80;
  const RadianceAt radiance = [](double) -> cv::Mat3f { return Bearings() * 0.2; };
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const cv::Mat3b one = CaptureImage(options, 1, 0.05, radiance, radiance);
  omp_set_num_threads(2);
  EXPECT_EQ(Difference(one, CaptureImage(options, 1, 0.05, radiance, radiance)), 0);
  omp_set_num_threads(threads);
}

}  // namespace
}  // namespace orb360::town
