#include <string>

#include "nn/base/number_text.h"
#include "slam/io/atomic_file.h"
#include "slam/io/export/pose_text.h"
#include "slam/io/export/trajectory_formats.h"

namespace orb360 {

void ExportKitti(std::span<const PosedFrame> frames, const std::filesystem::path& folder) {
  constexpr int kDecimals = 9;  // of a second
  std::string poses;
  std::string times;
  for (const PosedFrame& frame : frames) {
    const Rigid3 first_from_camera =
        frames.front().world_from_optical.Inverse() * frame.world_from_optical;
    const Eigen::Matrix3d rotation = first_from_camera.rotation.toRotationMatrix();
    std::string line;
    for (int row = 0; row < 3; ++row) {
      AppendNumbers(std::array{rotation(row, 0), rotation(row, 1), rotation(row, 2),
                               first_from_camera.translation(row)},
                    ' ', &line);
    }
    poses += line.substr(1) + "\n";
    times += ToFixedText(frame.timestamp - frames.front().timestamp, kDecimals) + "\n";
  }
  WriteFileAtomically(folder / "poses.txt", poses);
  WriteFileAtomically(folder / "times.txt", times);
}

}  // namespace orb360
