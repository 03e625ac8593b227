#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <hdf5.h>

#include "nn/base/checksummed_file.h"
#include "nn/base/hdf5_handle.h"
#include "nn/graph/input_ranges.h"
#include "nn/graph/json_object.h"
#include "nn/graph/limits.h"
#include "nn/graph/parse_graph.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/graph/network_file.h>

namespace orb360::nn {
namespace {

constexpr ChecksummedFormat kKind = {
    "ORB360NN", 1, "network", "weights_tools", "use the weights that belong to it",
    // The largest file: all accepted weights as 32-bit floats, and as many bytes for the rest.
    std::uintmax_t{limits::kWeights} * 8};

std::string ReadText(hid_t file, const std::string& name) {
  const Hdf5Handle set = OpenOwnDataset(file, name);
  const Hdf5Handle type(H5Dget_type(set.get()), H5Tclose);
  const Hdf5Handle space(H5Dget_space(set.get()), H5Sclose);
  if (H5Tget_class(type.get()) != H5T_STRING || H5Sget_simple_extent_npoints(space.get()) != 1) {
    throw UserError("dataset " + Quoted(name) + " should be one string");
  }
  const Hdf5Handle memory(H5Tcopy(type.get()), H5Tclose);
  std::string text;
  bool is_read = false;
  if (H5Tis_variable_str(type.get()) > 0) {
    char* read = nullptr;
    is_read = H5Dread(set.get(), memory.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &read) >= 0;
    if (read != nullptr) text = read;
    H5Dvlen_reclaim(memory.get(), space.get(), H5P_DEFAULT, &read);
  } else if (H5Tget_size(type.get()) <= limits::kJsonBytes) {
    text.resize(H5Tget_size(type.get()));
    is_read = H5Dread(set.get(), memory.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) >= 0;
    text.resize(std::strlen(text.c_str()));
  }
  if (!is_read) throw UserError("dataset " + Quoted(name) + " cannot be read");
  return text;
}

/// Returns the type IEEE 754 binary16, for which the HDF5 library has no constant.
Hdf5Handle HalfType() {
  Hdf5Handle type(H5Tcopy(H5T_IEEE_F32LE), H5Tclose);
  // Position and size in bits of sign, exponent and mantissa.
  H5Tset_fields(type.get(), 15, 10, 5, 0, 10);
  H5Tset_size(type.get(), 2);
  H5Tset_ebias(type.get(), 15);
  return type;
}

/// Converts a half exactly: every half is a float. The function has no branches, so that compilers
/// vectorize it.
float WidenHalf(std::uint16_t half) {
  const std::uint32_t sign = std::uint32_t{half & 0x8000u} << 16;
  // The exponent of this float is too small by the difference of the biases, 127 - 15. The product
  // restores it, for subnormal halves too.
  const float value = std::bit_cast<float>(std::uint32_t{half & 0x7fffu} << 13) * 0x1p112f;
  const std::uint32_t special = (half & 0x7c00u) == 0x7c00u ? 0x7f800000u : 0;  // infinity, NaN
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) | special | sign);
}

std::vector<int> ReadShape(hid_t set, const std::string& name) {
  constexpr int kMaxDimensions = 4;
  const Hdf5Handle space(H5Dget_space(set), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 1 || rank > kMaxDimensions) {
    throw UserError("weights " + Quoted(name) + " have " + std::to_string(rank) +
                    " dimensions and should have 1 to 4");
  }
  std::array<hsize_t, kMaxDimensions> sizes{};
  H5Sget_simple_extent_dims(space.get(), sizes.data(), nullptr);
  std::vector<int> shape;
  for (int i = 0; i < rank; ++i) {
    const hsize_t size = sizes[static_cast<std::size_t>(i)];
    if (size < 1 || size > hsize_t{limits::kChannels}) {
      throw UserError("weights " + Quoted(name) + " have a dimension of " + std::to_string(size) +
                      ", and 1 to " + std::to_string(limits::kChannels) + " are accepted");
    }
    shape.push_back(static_cast<int>(size));
  }
  return shape;
}

/// Reads a tensor of weights. `room` is the number of values that are still accepted; `halves` is
/// memory that is reused.
Weight ReadWeight(hid_t group, const std::string& name, std::int64_t room,
                  std::vector<std::uint16_t>* halves) {
  const Hdf5Handle set = OpenOwnDataset(group, name);
  Weight weight{name, ReadShape(set.get(), name), {}};
  std::int64_t count = 1;
  for (const int size : weight.shape) count *= size;
  if (count > room) {
    throw UserError("has more than " + std::to_string(limits::kWeights) + " weights");
  }
  const Hdf5Handle type(H5Dget_type(set.get()), H5Tclose);
  weight.values.resize(static_cast<std::size_t>(count));
  bool is_read = false;
  if (H5Tequal(type.get(), H5T_IEEE_F32LE) > 0) {
    is_read = H5Dread(set.get(), H5T_IEEE_F32LE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                      weight.values.data()) >= 0;
  } else if (H5Tequal(type.get(), HalfType().get()) > 0) {
    halves->resize(weight.values.size());
    is_read = H5Dread(set.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, halves->data()) >= 0;
    std::ranges::transform(*halves, weight.values.begin(), WidenHalf);
  } else {
    throw UserError("weights " + Quoted(name) +
                    " should be little-endian IEEE floats of 16 or 32 bits");
  }
  if (!is_read) throw UserError("weights " + Quoted(name) + " cannot be read");
  return weight;
}

std::vector<Weight> ReadWeights(hid_t file) {
  std::vector<Weight> weights;
  // A network may have no weights.
  if (H5Lexists(file, "weights", H5P_DEFAULT) <= 0) return weights;
  const Hdf5Handle group(H5Gopen2(file, "weights", H5P_DEFAULT), H5Gclose);
  if (!group.is_valid()) throw UserError("\"weights\" should be a group");
  std::vector<std::string> names;
  const auto add_name = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  if (H5Literate(group.get(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add_name, &names) < 0) {
    throw UserError("its weights cannot be listed");
  }
  std::int64_t room = limits::kWeights;
  std::vector<std::uint16_t> halves;
  for (const std::string& name : names) {
    weights.push_back(ReadWeight(group.get(), name, room, &halves));
    room -= static_cast<std::int64_t>(weights.back().values.size());
  }
  return weights;
}

}  // namespace

Graph ReadNetwork(const std::filesystem::path& path) {
  try {
    FileBytes bytes = ReadChecksummedFile(path, kKind);
    const Hdf5Quiet quiet;
    const Hdf5Handle file = OpenChecksummedContent(&bytes);
    const std::string json = ReadText(file.get(), "graph");
    Graph graph = ParseGraph(json, ReadWeights(file.get()));
    if (H5Lexists(file.get(), "quantization", H5P_DEFAULT) > 0) {
      AddInputRanges(ReadText(file.get(), "quantization"), &graph);
    }
    return graph;
  } catch (const UserError& reason) {
    throw UserError(path.string() + ": " + reason.what());
  }
}

}  // namespace orb360::nn
