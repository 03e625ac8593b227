#include "slam/features/tangent_sampling.h"

#include <algorithm>

namespace orb360 {
namespace {

// Rounds to the nearest integer by truncation, which vectorizes; x > -4096.
int RoundOffset(float x) { return static_cast<int>(x + 4096.5f) - 4096; }

}  // namespace

void TangentSampling::Offsets(std::span<const float> a, std::span<const float> b, int u_index,
                              int v_index, ptrdiff_t stride, int32_t* offsets) const {
  const int step = static_cast<int>(stride);
  const int count = static_cast<int>(a.size());
  if (!exact_) {
    const float shear = -k_ * tangent_;
    const float sag = 0.5f * k_ * tangent_;
    for (int i = 0; i < count; ++i) {
      const int du = RoundOffset(a[i] * inverse_cosine_ * (1.0f + shear * b[i]));
      const int dv = RoundOffset((b[i] + sag * a[i] * a[i]) * vertical_);
      offsets[i] = dv * step + du;
    }
    return;
  }
  // Exactly: the point on the tangent plane, in a frame whose meridian is the patch's own, so that
  // the result does not depend on the longitude.
  const double sine = std::sin(latitude_);
  const double cosine = std::cos(latitude_);
  const int width = camera_->width();
  const int height = camera_->height();
  for (int i = 0; i < count; ++i) {
    const double east = a[i] * static_cast<double>(k_);
    const double south = b[i] * static_cast<double>(k_);
    const double forward = cosine + sine * south;  // towards the patch's meridian
    const double up = sine - cosine * south;
    const double longitude = std::atan2(east, forward);
    const double latitude = std::atan2(up, std::hypot(east, forward));
    const int v = std::clamp(static_cast<int>(std::floor(camera_->fy() * latitude + camera_->cy())),
                             0, height - 1);
    int u = u_index + static_cast<int>(std::floor(camera_->fx() * longitude + 0.5));
    if (u < 0) u += width;
    if (u >= width) u -= width;
    offsets[i] = (v - v_index) * step + (u - u_index);
  }
}

}  // namespace orb360
