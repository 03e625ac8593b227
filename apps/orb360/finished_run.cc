#include "apps/orb360/finished_run.h"

#include "apps/orb360/mask.h"
#include "slam/io/sparse_model_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

FinishedRun OpenFinishedRun(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) {
    throw UserError(folder.string() + ": is no folder; give that of a finished `orb360 run`");
  }
  const std::filesystem::path summary = folder / "summary.json";
  if (!std::filesystem::exists(summary)) {
    throw UserError(folder.string() +
                    ": holds no finished run (there is no summary.json); `orb360 run INPUT --out "
                    "DIR` makes one");
  }
  const std::filesystem::path path = folder / kSparseModelName;
  if (!std::filesystem::exists(path)) {
    throw UserError(folder.string() + ": has no " + kSparseModelName +
                    ", because an older orb360 made it; run `orb360 run` again");
  }
  FinishedRun run{folder, ReadSparseModel(path), ReadSummary(summary), {}};
  const std::filesystem::path mask = folder / kMaskName;
  if (std::filesystem::exists(mask)) {
    run.mask = LoadMask(mask.string(), {run.model.width, run.model.height});
  }
  if (run.model.frames.empty()) {
    throw UserError(
        folder.string() +
        ": no frame of this run has a pose; run `orb360 run` on an input that it can track");
  }
  return run;
}

}  // namespace orb360
