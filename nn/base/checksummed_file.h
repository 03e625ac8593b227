#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "nn/base/hdf5_handle.h"

namespace orb360 {

/// A kind of file that contains HDF5 behind a header of 512 bytes: 8 characters, the version
/// (little-endian, 4 bytes) and, from byte 16 on, the SHA-256 of everything after the header. The
/// rest of the header is 0. The HDF5 library sees only bytes whose digest is correct.
struct ChecksummedFormat {
  std::string_view magic;  // 8 characters
  std::uint32_t version;
  std::string_view name;  // "network"
  std::string_view made_by;
  std::string_view if_other_version;  // what to do
  std::uintmax_t max_bytes;
};

using FileBytes = std::vector<unsigned char>;

/// Reads the whole file. Throws UserError, which does not name the file, if it is missing, of
/// another kind or version, or damaged.
FileBytes ReadChecksummedFile(const std::filesystem::path& path, const ChecksummedFormat& kind);

/// Returns the header for HDF5 content.
std::string MakeChecksumHeader(const ChecksummedFormat& kind, std::string_view content);

/// Opens the file in memory for the HDF5 library. It uses `bytes` themselves, which must outlive
/// the handle, because copying them would take as long as the digest.
Hdf5Handle OpenChecksummedContent(FileBytes* bytes);

/// Creates a file in memory for content that follows the header of MakeChecksumHeader. TakeContent
/// returns its bytes.
Hdf5Handle CreateChecksummedContent();
std::string TakeContent(const Hdf5Handle& file);

/// Opens a dataset whose bytes are in this file and not in an external one. Throws UserError.
Hdf5Handle OpenOwnDataset(hid_t group, const std::string& name);

}  // namespace orb360
