#pragma once

#include <optional>

#include <opencv2/core.hpp>

namespace orb360 {

/// Transfer functions of high dynamic range (ITU-R BT.2100).
enum class HdrTransfer { kPq, kHlg };

/// Returns the transfer function of high dynamic range that a code of ITU-T H.273, table 3, means;
/// nullopt for all others.
std::optional<HdrTransfer> HdrTransferOf(int code);

/// Maps an image of high dynamic range, CV_16UC3 with BT.2020 primaries, BGR, non-linear as coded
/// (65535 is code 1), to the 8 bits of BT.709 primaries and the transfer function of sRGB, CV_8UC3.
///
/// Light is measured in units of 203 cd/m2, the white of graphics (ITU-R BT.2408). HLG is shown as
/// on a display of 1000 cd/m2, with the system gamma 1.2. Primaries are converted by BT.2087. Each
/// channel x is then compressed: it stays up to 0.6, and above that becomes 0.6 + 0.4 y (1 + y /
/// m^2) / (1 + y), y = (x - 0.6) / 0.4, which continues it with the same slope and reaches 1 at
/// 1000 cd/m2, y = m.
cv::Mat ToneMapped(const cv::Mat& image, HdrTransfer transfer);

}  // namespace orb360
