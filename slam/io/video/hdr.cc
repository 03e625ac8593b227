#include "slam/io/video/hdr.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr double kWhite = 203.0;   // cd/m2, ITU-R BT.2408
constexpr double kPeak = 1000.0;   // cd/m2, of the display and of the compression
constexpr double kPqPeak = 10000;  // cd/m2, ITU-R BT.2100
constexpr int kCodes = 65536;

/// Light of the code x in 0..1, cd/m2: the EOTF of PQ (ITU-R BT.2100, table 4).
double PqLight(double x) {
  constexpr double kM1 = 2610.0 / 16384.0;
  constexpr double kM2 = 2523.0 / 4096.0 * 128.0;
  constexpr double kC1 = 3424.0 / 4096.0;
  constexpr double kC2 = 2413.0 / 4096.0 * 32.0;
  constexpr double kC3 = 2392.0 / 4096.0 * 32.0;
  const double power = std::pow(x, 1.0 / kM2);
  return kPqPeak * std::pow(std::max(power - kC1, 0.0) / (kC2 - kC3 * power), 1.0 / kM1);
}

/// Light of the scene for the code x, 0..1: the inverse OETF of HLG (ITU-R BT.2100, table 5).
double HlgScene(double x) {
  constexpr double kA = 0.17883277;
  constexpr double kB = 1.0 - 4.0 * kA;
  const double c = 0.5 - kA * std::log(4.0 * kA);
  return x <= 0.5 ? x * x / 3.0 : (std::exp((x - c) / kA) + kB) / 12.0;
}

/// Compressed light for light x, both in units of white.
double Compressed(double x) {
  constexpr double kKnee = 0.6;
  constexpr double kMax = (kPeak / kWhite - kKnee) / (1.0 - kKnee);
  if (x <= kKnee) return x;
  const double y = (x - kKnee) / (1.0 - kKnee);
  return kKnee + (1.0 - kKnee) * y * (1.0 + y / (kMax * kMax)) / (1.0 + y);
}

/// The transfer function of sRGB (IEC 61966-2-1).
double SrgbCode(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
}

/// Light for each code of 16 bits.
std::vector<float> LightTable(HdrTransfer transfer) {
  std::vector<float> light(kCodes);
  for (int i = 0; i < kCodes; ++i) {
    const double x = i / (kCodes - 1.0);
    light[i] = static_cast<float>(transfer == HdrTransfer::kPq ? PqLight(x) / kWhite : HlgScene(x));
  }
  return light;
}

/// Codes of 8 bits over the square root of the light up to the peak. The root spreads the dark
/// codes over as many entries as the bright ones.
class CodeTable {
 public:
  CodeTable() {
    for (int i = 0; i <= kSteps; ++i) {
      const double light = kPeak / kWhite * i * i / (1.0 * kSteps * kSteps);
      codes_[i] = cv::saturate_cast<uchar>(255.0 * SrgbCode(std::min(Compressed(light), 1.0)));
    }
  }
  uchar operator()(float light) const {
    constexpr auto kPerLight = static_cast<float>(1.0 * kSteps * kSteps * kWhite / kPeak);
    const float step = std::sqrt(std::max(light, 0.0F) * kPerLight);
    return codes_[std::min(static_cast<int>(step + 0.5F), kSteps)];
  }

 private:
  static constexpr int kSteps = 8192;
  std::array<uchar, kSteps + 1> codes_;
};

/// Factor from light of the scene to light of the display in units of white, for the scene's
/// luminance: the OOTF of HLG (ITU-R BT.2100, table 5).
float HlgGain(float luminance) {
  constexpr float kGamma = 1.2F;
  return static_cast<float>(kPeak / kWhite) * std::pow(std::max(luminance, 1e-9F), kGamma - 1.0F);
}

}  // namespace

std::optional<HdrTransfer> HdrTransferOf(int code) {
  if (code == 16) return HdrTransfer::kPq;
  if (code == 18) return HdrTransfer::kHlg;
  return std::nullopt;
}

cv::Mat ToneMapped(const cv::Mat& image, HdrTransfer transfer) {
  ORB360_CHECK(image.type() == CV_16UC3, image.type());
  static const std::array kTables = {LightTable(HdrTransfer::kPq), LightTable(HdrTransfer::kHlg)};
  static const CodeTable kCode;
  const std::vector<float>& table = kTables[transfer == HdrTransfer::kPq ? 0 : 1];
  cv::Mat mapped(image.size(), CV_8UC3);
  cv::parallel_for_({0, image.rows}, [&](const cv::Range& rows) {
    for (int row = rows.start; row < rows.end; ++row) {
      const auto* in = image.ptr<cv::Vec3w>(row);
      auto* out = mapped.ptr<cv::Vec3b>(row);
      for (int col = 0; col < image.cols; ++col) {
        const float b = table[in[col][0]];
        const float g = table[in[col][1]];
        const float r = table[in[col][2]];
        // Luminance and conversion of primaries: ITU-R BT.2100, table 5; BT.2087, matrix M2.
        const float gain =
            transfer == HdrTransfer::kHlg ? HlgGain(0.2627F * r + 0.6780F * g + 0.0593F * b) : 1.0F;
        out[col] = {kCode(gain * (-0.0182F * r - 0.1006F * g + 1.1187F * b)),
                    kCode(gain * (-0.1246F * r + 1.1329F * g - 0.0083F * b)),
                    kCode(gain * (1.6605F * r - 0.5876F * g - 0.0728F * b))};
      }
    }
  });
  return mapped;
}

}  // namespace orb360
