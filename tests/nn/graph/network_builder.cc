#include "tests/nn/graph/network_builder.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <utility>

#include <hdf5.h>
#include <openssl/sha.h>

#include "nn/base/hdf5_handle.h"
#include "nn/graph/parse_graph.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

constexpr std::size_t kHeaderBytes = 512;

Hdf5Handle HalfType() {
  Hdf5Handle type(H5Tcopy(H5T_IEEE_F32LE), H5Tclose);
  H5Tset_fields(type.get(), 15, 10, 5, 0, 10);
  H5Tset_size(type.get(), 2);
  H5Tset_ebias(type.get(), 15);
  return type;
}

void WriteDataset(hid_t group, const char* name, hid_t file_type, hid_t memory_type,
                  const std::vector<hsize_t>& shape, const void* data) {
  const Hdf5Handle space(
      shape.empty() ? H5Screate(H5S_SCALAR)
                    : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
      H5Sclose);
  const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation.get(), false);
  const Hdf5Handle set(
      H5Dcreate2(group, name, file_type, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT),
      H5Dclose);
  ORB360_CHECK(H5Dwrite(set.get(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0, name);
}

}  // namespace

NetworkBuilder::NetworkBuilder(int size_multiple, unsigned seed)
    : json({{"name", "test"},
            {"size_multiple", size_multiple},
            {"inputs", nlohmann::json::array()},
            {"nodes", nlohmann::json::array()},
            {"outputs", nlohmann::json::array()},
            {"normalisation", nlohmann::json::object()},
            {"provenance", {{"seed", seed}}}}),
      random_(seed) {}

std::string NetworkBuilder::Input(const std::string& name, int channels) {
  json["inputs"].push_back({{"name", name}, {"channels", channels}});
  return name;
}

std::string NetworkBuilder::Node(const std::string& name, const std::string& op,
                                 const std::vector<std::string>& inputs,
                                 const nlohmann::json& attributes, int outputs) {
  nlohmann::json node = {{"name", name}, {"op", op}, {"inputs", inputs}};
  for (int i = 0; i < outputs; ++i) {
    node["outputs"].push_back(i == 0 ? name : name + "." + std::to_string(i));
  }
  if (!attributes.empty()) node["attributes"] = attributes;
  json["nodes"].push_back(std::move(node));
  return name;
}

std::string NetworkBuilder::Convolution(const std::string& name, const std::string& input,
                                        int inputs, int outputs, int kernel, int stride,
                                        const std::string& padding) {
  Node(name, "convolution", {input}, {{"stride", stride}, {"padding", padding}});
  json["nodes"].back()["weights"] = {{"weight", name + ".weight"}, {"bias", name + ".bias"}};
  const float range = std::sqrt(3.0f / static_cast<float>(inputs * kernel * kernel));
  AddWeight(name + ".weight", {outputs, inputs, kernel, kernel}, -range, range);
  AddWeight(name + ".bias", {outputs}, -0.5f, 0.5f);
  return name;
}

std::string NetworkBuilder::NormalizedConvolution(const std::string& name, const std::string& x,
                                                  const std::string& c, int inputs, int outputs,
                                                  int kernel, const std::string& padding) {
  Node(name, "normalized_convolution", {x, c}, {{"padding", padding}}, 2);
  json["nodes"].back()["weights"] = {{"weight", name + ".weight"}, {"bias", name + ".bias"}};
  AddWeight(name + ".weight", {outputs, inputs, kernel, kernel}, 0.01f, 1.0f);
  AddWeight(name + ".bias", {outputs}, -0.5f, 0.5f);
  return name;
}

std::string NetworkBuilder::Dense(const std::string& name, const std::string& input, int inputs,
                                  int outputs) {
  Node(name, "dense", {input});
  json["nodes"].back()["weights"] = {{"weight", name + ".weight"}, {"bias", name + ".bias"}};
  const float range = std::sqrt(3.0f / static_cast<float>(inputs));
  AddWeight(name + ".weight", {outputs, inputs}, -range, range);
  AddWeight(name + ".bias", {outputs}, -0.5f, 0.5f);
  return name;
}

void NetworkBuilder::Output(const std::string& name, const std::string& tensor) {
  json["outputs"].push_back({{"name", name}, {"tensor", tensor}});
}

void NetworkBuilder::AddWeight(const std::string& name, const std::vector<int>& shape, float low,
                               float high) {
  std::size_t count = 1;
  for (const int size : shape) count *= static_cast<std::size_t>(size);
  Weight weight{name, shape, std::vector<float>(count)};
  for (float& value : weight.values) {
    value = low + (high - low) * static_cast<float>(random_() >> 8) * 0x1p-24f;
  }
  weights.push_back(std::move(weight));
}

Graph NetworkBuilder::Build() const { return ParseGraph(json.dump(), weights); }

void NetworkBuilder::Write(const std::filesystem::path& path, bool is_half) const {
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), 1 << 16, /*backing_store=*/0);
  const Hdf5Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_userblock(creation.get(), kHeaderBytes);
  const Hdf5Handle file(H5Fcreate("test", H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose);
  const std::string text = json.dump();
  const Hdf5Handle string_type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(string_type.get(), text.size());
  H5Tset_cset(string_type.get(), H5T_CSET_UTF8);
  WriteDataset(file.get(), "graph", string_type.get(), string_type.get(), {}, text.data());
  const Hdf5Handle group(H5Gcreate2(file.get(), "weights", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                         H5Gclose);
  const Hdf5Handle half = HalfType();
  for (const Weight& weight : weights) {
    WriteDataset(group.get(), weight.name.c_str(), is_half ? half.get() : H5T_IEEE_F32LE,
                 H5T_NATIVE_FLOAT, {weight.shape.begin(), weight.shape.end()},
                 weight.values.data());
  }
  H5Fflush(file.get(), H5F_SCOPE_LOCAL);
  std::string bytes(static_cast<std::size_t>(H5Fget_file_image(file.get(), nullptr, 0)), '\0');
  ORB360_CHECK(H5Fget_file_image(file.get(), bytes.data(), bytes.size()) >= 0);
  // The image lacks the user block.
  WriteWithHeader(path, std::string(kHeaderBytes, '\0') + bytes);
}

void WriteWithHeader(const std::filesystem::path& path, std::string content) {
  ORB360_CHECK(content.size() >= kHeaderBytes, content.size());
  std::string header(kHeaderBytes, '\0');
  header.replace(0, 8, "ORB360NN");
  header[8] = 1;  // version
  auto* const digest = reinterpret_cast<unsigned char*>(header.data() + 16);
  SHA256(reinterpret_cast<const unsigned char*>(content.data()) + kHeaderBytes,
         content.size() - kHeaderBytes, digest);
  content.replace(0, kHeaderBytes, header);
  std::ofstream(path, std::ios::binary) << content;
}

}  // namespace orb360::nn
