#include "nn/base/checksummed_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <span>
#include <system_error>

#include <hdf5.h>
#include <hdf5_hl.h>
#include <openssl/evp.h>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr std::size_t kMagicBytes = 8;
constexpr std::size_t kVersionAt = 8;
constexpr std::size_t kDigestAt = 16;
constexpr std::size_t kDigestBytes = 32;
constexpr std::size_t kHeaderBytes = 512;

static_assert(std::endian::native == std::endian::little, "numbers are read as they lie in files");

using Digest = std::array<unsigned char, EVP_MAX_MD_SIZE>;

Digest DigestOf(const void* data, std::size_t bytes) {
  Digest digest;
  unsigned size = 0;
  const int done = EVP_Digest(data, bytes, digest.data(), &size, EVP_sha256(), nullptr);
  ORB360_CHECK(done == 1 && size == kDigestBytes, size);
  return digest;
}

FileBytes ReadBytes(const std::filesystem::path& path, const ChecksummedFormat& kind) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw UserError("cannot be read: " + error.message());
  if (size > kind.max_bytes) {
    std::string reason = "has " + std::to_string(size) + " bytes, more than any ";
    throw UserError(reason += kind.name);
  }
  FileBytes bytes(static_cast<std::size_t>(size));
  std::ifstream file(path, std::ios::binary);
  if (!file) throw UserError("cannot be read: " + std::generic_category().message(errno));
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!file) throw UserError("cannot be read to its end");
  return bytes;
}

void CheckHeader(const FileBytes& bytes, const ChecksummedFormat& kind) {
  const std::string name(kind.name);
  if (bytes.size() < kHeaderBytes ||
      std::memcmp(bytes.data(), kind.magic.data(), kMagicBytes) != 0) {
    std::string reason = "is not a " + name;
    reason += " of orb360; ";
    reason += kind.made_by;
    throw UserError(reason += " writes them");
  }
  std::uint32_t version = 0;
  std::memcpy(&version, bytes.data() + kVersionAt, sizeof(version));
  if (version != kind.version) {
    std::string reason = "is a " + name;
    reason += " of version " + std::to_string(version) + ", and this program reads version " +
              std::to_string(kind.version) + "; ";
    throw UserError(reason += kind.if_other_version);
  }
  const std::span<const unsigned char> header(bytes.data(), kHeaderBytes);
  const auto is_zero = [](std::span<const unsigned char> part) {
    return std::ranges::all_of(part, [](unsigned char byte) { return byte == 0; });
  };
  if (!is_zero(
          header.subspan(kVersionAt + sizeof(version), kDigestAt - kVersionAt - sizeof(version))) ||
      !is_zero(header.subspan(kDigestAt + kDigestBytes))) {
    throw UserError("has a damaged header; copy or download it again");
  }
  const Digest digest = DigestOf(bytes.data() + kHeaderBytes, bytes.size() - kHeaderBytes);
  if (std::memcmp(digest.data(), bytes.data() + kDigestAt, kDigestBytes) != 0) {
    throw UserError("is damaged (its SHA-256 is another one); copy or download it again");
  }
}

}  // namespace

FileBytes ReadChecksummedFile(const std::filesystem::path& path, const ChecksummedFormat& kind) {
  FileBytes bytes = ReadBytes(path, kind);
  CheckHeader(bytes, kind);
  return bytes;
}

std::string MakeChecksumHeader(const ChecksummedFormat& kind, std::string_view content) {
  ORB360_CHECK(kind.magic.size() == kMagicBytes, kind.magic);
  std::string header(kHeaderBytes, '\0');
  std::memcpy(header.data(), kind.magic.data(), kMagicBytes);
  std::memcpy(header.data() + kVersionAt, &kind.version, sizeof(kind.version));
  const Digest digest = DigestOf(content.data(), content.size());
  std::memcpy(header.data() + kDigestAt, digest.data(), kDigestBytes);
  return header;
}

Hdf5Handle OpenChecksummedContent(FileBytes* bytes) {
  Hdf5Handle file(H5LTopen_file_image(bytes->data(), bytes->size(),
                                      H5LT_FILE_IMAGE_DONT_COPY | H5LT_FILE_IMAGE_DONT_RELEASE),
                  H5Fclose);
  if (!file.is_valid()) throw UserError("has no HDF5 content behind its header");
  return file;
}

Hdf5Handle CreateChecksummedContent() {
  constexpr std::size_t kGrowth = 1 << 24;  // bytes
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), kGrowth, /*backing_store=*/0);
  const Hdf5Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_userblock(creation.get(), kHeaderBytes);
  Hdf5Handle file(H5Fcreate("content", H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose);
  ORB360_CHECK(file.is_valid());
  return file;
}

std::string TakeContent(const Hdf5Handle& file) {
  ORB360_CHECK(H5Fflush(file.get(), H5F_SCOPE_LOCAL) >= 0);
  // The image lacks the user block, which will hold the header.
  const ssize_t size = H5Fget_file_image(file.get(), nullptr, 0);
  ORB360_CHECK(size > 0, size);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  ORB360_CHECK(H5Fget_file_image(file.get(), bytes.data(), bytes.size()) == size, size);
  return bytes;
}

Hdf5Handle OpenOwnDataset(hid_t group, const std::string& name) {
  H5L_info_t link;
  Hdf5Handle set(
      H5Lget_info(group, name.c_str(), &link, H5P_DEFAULT) >= 0 && link.type == H5L_TYPE_HARD
          ? H5Dopen2(group, name.c_str(), H5P_DEFAULT)
          : H5I_INVALID_HID,
      H5Dclose);
  if (!set.is_valid()) throw UserError("has no dataset \"" + name + "\"");
  const Hdf5Handle creation(H5Dget_create_plist(set.get()), H5Pclose);
  if (H5Pget_external_count(creation.get()) != 0 || H5Pget_layout(creation.get()) == H5D_VIRTUAL) {
    throw UserError("dataset \"" + name + "\" lies in another file");
  }
  return set;
}

}  // namespace orb360
