#include "slam/io/sparse_model_file.h"

#include <string>

#include "nn/base/checksummed_file.h"
#include "nn/base/hdf5_handle.h"
#include "slam/io/atomic_file.h"
#include "slam/io/hdf5_table.h"
#include "slam/io/sparse_model_arrays.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr ChecksummedFormat kKind = {"ORB360SM",
                                     1,
                                     "reconstruction",
                                     "`orb360 run`",
                                     "run it again with this one",
                                     std::uintmax_t{1} << 36};

}  // namespace

void WriteSparseModel(const std::filesystem::path& path, const SparseModel& model) {
  std::string content;
  {
    const Hdf5Handle file = CreateChecksummedContent();
    WriteHdf5Columns(file.get(), ToArrays(model));
    content = TakeContent(file);
  }
  AtomicFile file(path);
  file.Write(MakeChecksumHeader(kKind, content));
  file.Write(content);
  file.Commit();
}

SparseModel ReadSparseModel(const std::filesystem::path& path) {
  try {
    const auto arrays = [&] {  // The bytes of the file are freed before the model is made.
      FileBytes bytes = ReadChecksummedFile(path, kKind);
      const Hdf5Quiet quiet;
      const Hdf5Handle file = OpenChecksummedContent(&bytes);
      return ReadHdf5Columns<SparseModelArrays>(file.get(), kKind.name, bytes.size());
    }();
    return ModelFromArrays(arrays);
  } catch (const UserError& reason) {
    throw UserError(path.string() + ": " + reason.what());
  }
}

}  // namespace orb360
