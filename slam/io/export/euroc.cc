#include <cmath>
#include <string>

#include "nn/base/number_text.h"
#include "slam/io/atomic_file.h"
#include "slam/io/export/pose_text.h"
#include "slam/io/export/trajectory_formats.h"

namespace orb360 {

void ExportEuroc(std::span<const PosedFrame> frames, const std::filesystem::path& folder) {
  std::string text =
      "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],"
      "q_RS_z []\n";
  for (const PosedFrame& frame : frames) {
    text += ToFixedText(std::round(1e9 * frame.timestamp), 0);
    AppendNumbers(frame.world_from_optical.translation, ',', &text);
    AppendNumbers(ScalarFirst(frame.world_from_optical.rotation), ',', &text);
    text += '\n';
  }
  WriteFileAtomically(folder / "trajectory.csv", text);
}

}  // namespace orb360
