#include "apps/town/sensor/sensor.h"

#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "apps/town/render/tone.h"
#include "apps/town/sensor/auto_exposure.h"
#include "apps/town/sensor/dual_lens.h"
#include "apps/town/sensor/motion_blur.h"
#include "apps/town/sensor/sensor_noise.h"

namespace orb360::town {
namespace {

cv::Mat3b Encode(const cv::Mat3f& radiance) {
  const ToneCurve tone;
  cv::Mat3b image(radiance.size());
#pragma omp parallel for schedule(static)
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const cv::Vec3f& pixel = radiance(row, column);
      image(row, column) = tone.Encode({pixel[2], pixel[1], pixel[0]});
    }
  }
  return image;
}

cv::Mat3b Compressed(const cv::Mat3b& image, int quality) {
  std::vector<uchar> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return cv::imdecode(bytes, cv::IMREAD_COLOR);
}

}  // namespace

cv::Mat3b CaptureImage(const SensorOptions& options, int frame, double seconds,
                       const RadianceAt& radiance, const RadianceAt& meter) {
  cv::Mat3f light =
      options.motion_blur ? Blurred(*options.motion_blur, seconds, radiance) : radiance(seconds);
  if (options.dual_lens) light = StitchedFromTwoLenses(*options.dual_lens, light);
  if (options.auto_exposure) light *= ExposureGainAt(*options.auto_exposure, seconds, meter);
  if (options.noise) AddNoise(*options.noise, options.seed, frame, &light);
  const cv::Mat3b image = Encode(light);
  return options.jpeg_quality ? Compressed(image, *options.jpeg_quality) : image;
}

}  // namespace orb360::town
