// libFuzzer's target for what reads a map behind the digest: FromArrays must refuse with a
// UserError or give a map that is consistent and gives the same columns again; nothing else,
// whatever the bytes.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "slam/io/map_arrays.h"
#include "tests/fuzz/columns_input.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

void Check(std::string_view bytes) {
  const std::optional<MapArrays> arrays = ReadColumnsInput<MapArrays>(bytes);
  if (!arrays) return;
  try {
    const Map map = FromArrays(*arrays);
    map.CheckConsistency();
    if (WriteColumnsInput(ToArrays(map)) != WriteColumnsInput(*arrays)) std::abort();
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
