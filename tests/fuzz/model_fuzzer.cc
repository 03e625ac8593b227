// libFuzzer's target for what reads a reconstruction behind the digest: ModelFromArrays must refuse
// with a UserError or give a model that gives the same columns again; nothing else, whatever the
// bytes.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "slam/io/sparse_model_arrays.h"
#include "tests/fuzz/columns_input.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

void Check(std::string_view bytes) {
  const std::optional<SparseModelArrays> arrays = ReadColumnsInput<SparseModelArrays>(bytes);
  if (!arrays) return;
  try {
    const SparseModelArrays again = ToArrays(ModelFromArrays(*arrays));
    if (WriteColumnsInput(again) != WriteColumnsInput(*arrays)) std::abort();
  } catch (const UserError&) {
    // The refusal of what is not allowed.
  }
}

}  // namespace
}  // namespace orb360

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  orb360::Check({reinterpret_cast<const char*>(data), size});
  return 0;
}
