#include "slam/io/export/colmap.h"

#include "slam/io/export/colmap_model.h"
#include "slam/io/export/make_folder.h"

namespace orb360 {

void ExportColmap(const ExportScene& scene, ColmapFiles files,
                  const std::filesystem::path& folder) {
  const std::filesystem::path sparse = folder / "sparse" / "0";
  MakeFolder(sparse);
  const ColmapModel model = MakeColmapModel(scene);
  (files == ColmapFiles::kText ? WriteColmapText : WriteColmapBinary)(scene, model, sparse);
}

}  // namespace orb360
