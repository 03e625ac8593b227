#include <string>
#include <system_error>

#include <orb360/nn/base/check.h>
#include <orb360/nn/models/default_weights.h>

namespace orb360::nn {

std::filesystem::path DefaultWeights() {
  constexpr const char* kName = "depth_completion.h5";
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  std::string places;
  for (const std::filesystem::path& folder :
       {program.parent_path().parent_path() / ORB360_DATA_FOLDER / "weights",
        std::filesystem::path(ORB360_SOURCE_WEIGHTS),
        std::filesystem::path(ORB360_INSTALL_PREFIX) / ORB360_DATA_FOLDER / "weights"}) {
    std::filesystem::path path = folder / kName;
    if (std::filesystem::is_regular_file(path, error)) return path;
    places += places.empty() ? "" : ", ";
    places += folder.string();
  }
  throw UserError(std::string(kName) + ": no such file in " + places +
                  "; install the library's data or name a network");
}

}  // namespace orb360::nn
