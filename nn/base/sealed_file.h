#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "nn/base/hdf5_handle.h"

namespace orb360 {

/// A sort of file that holds HDF5 behind a header of 512 bytes: 8 characters, the version
/// (little-endian, 4 bytes) and, from byte 16 on, the SHA-256 of all that follows the header; the
/// rest is 0. The HDF5 library only sees bytes whose digest is right.
struct SealedKind {
  std::string_view magic;  // 8 characters
  std::uint32_t version;
  std::string_view name;  // "network"
  std::string_view made_by;
  std::string_view if_other_version;  // what to do
  std::uintmax_t most_bytes;
};

using FileBytes = std::vector<unsigned char>;

/// The whole file. Throws UserError, which does not name the file, for one that is missing, of
/// another kind or version, or damaged.
FileBytes ReadSealedFile(const std::filesystem::path& path, const SealedKind& kind);

/// The header for HDF5 content.
std::string MakeSeal(const SealedKind& kind, std::string_view content);

/// The file in memory as the HDF5 library sees it: `bytes` themselves, which must outlive the
/// handle. (Copies of them would take as long as the digest.)
Hdf5Handle OpenSealed(FileBytes* bytes);

/// A new file in memory, for content that MakeSeal is to precede; TakeContent gives its bytes.
Hdf5Handle CreateSealedContent();
std::string TakeContent(const Hdf5Handle& file);

/// A dataset whose bytes are in this file, and nowhere else. Throws UserError.
Hdf5Handle OpenOwnDataset(hid_t group, const std::string& name);

}  // namespace orb360
