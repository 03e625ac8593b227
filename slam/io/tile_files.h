#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "slam/io/output_file.h"
#include "slam/io/temporary_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {

/// Items on disk while the object lives, in one file for each tile of space. Their number is
/// limited by the disk only. Throws UserError if the disk fails.
template <typename Item>
requires std::is_trivially_copyable_v<Item>
class TileFiles {
 public:
  explicit TileFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  const std::filesystem::path& folder() const { return folder_.path(); }

  void Append(std::uint64_t tile, std::span<const Item> items) {
    OutputFile file(PathOf(tile), OutputFile::Mode::kAppend);
    file.Write({reinterpret_cast<const char*>(items.data()), items.size_bytes()});
    counts_[tile] += items.size();
  }

  /// Passes on the items of each tile in the order in which they were appended, tile by tile in the
  /// order of their numbers.
  void ForEach(const std::function<void(std::uint64_t tile, std::vector<Item> items)>& take) const {
    for (const auto& [tile, count] : counts_) {
      std::vector<Item> items(count);
      std::ifstream file(PathOf(tile), std::ios::binary);
      file.read(reinterpret_cast<char*>(items.data()),
                static_cast<std::streamsize>(count * sizeof(Item)));
      if (!file) {
        throw UserError(PathOf(tile).string() +
                        ": is damaged or gone; keep the folder as it is until the run has ended");
      }
      take(tile, std::move(items));
    }
  }

 private:
  std::filesystem::path PathOf(std::uint64_t tile) const {
    return folder_.path() / std::to_string(tile);
  }

  const TemporaryFolder folder_;
  std::map<std::uint64_t, std::uint64_t> counts_;  // of items appended, by tile
};

}  // namespace orb360
