#include "apps/town/sensor/motion_blur.h"

namespace orb360::town {

cv::Mat3f Blurred(const MotionBlur& options, double seconds, const RadianceAt& radiance) {
  cv::Mat3f sum;
  for (int i = 0; i < options.moments; ++i) {
    const double offset = options.shutter * ((i + 0.5) / options.moments - 0.5);
    const cv::Mat3f moment = radiance(seconds + offset);
    if (i == 0) {
      sum = moment.clone();
    } else {
      sum += moment;
    }
  }
  return sum / options.moments;
}

}  // namespace orb360::town
