#include <string>

#include "nn/base/number_text.h"
#include "slam/io/atomic_file.h"
#include "slam/io/export/pose_text.h"
#include "slam/io/export/trajectory_formats.h"

namespace orb360 {

void ExportTum(std::span<const PosedFrame> frames, const std::filesystem::path& folder) {
  constexpr int kDecimals = 9;  // of a second
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  for (const PosedFrame& frame : frames) {
    const auto [w, x, y, z] = ScalarFirst(frame.world_from_optical.rotation);
    text += ToFixedText(frame.timestamp, kDecimals);
    AppendNumbers(frame.world_from_optical.translation, ' ', &text);
    AppendNumbers(std::array{x, y, z, w}, ' ', &text);
    text += '\n';
  }
  WriteFileAtomically(folder / "trajectory.txt", text);
}

}  // namespace orb360
