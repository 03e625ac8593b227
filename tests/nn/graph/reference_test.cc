// Networks against what PyTorch computed in double precision (weights_tools.dump_reference), and
// against what the authors of a published one computed.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "nn/base/cpu.h"
#include "nn/base/hdf5_handle.h"
#include "tests/nn/dump.h"
#include "tests/nn/graph/dump_run.h"
#include "tests/nn/graph/reference_check.h"
#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/graph/network_file.h>

namespace orb360::nn {
namespace {

class OperationReference : public ::testing::TestWithParam<const char*> {
 protected:
  std::filesystem::path path_ = ReferenceFile(GetParam());
};

TEST_P(OperationReference, IsWhatPyTorchComputes) {
  ExpectEveryTensorOf(path_, kRoundingsOfOperation, {.threads = 2});
}

TEST_P(OperationReference, IsTheSameInANetworkMadeForSpeed) {
  ExpectOutputsOf(path_, kRoundingsOfOperation);
}

INSTANTIATE_TEST_SUITE_P(Every, OperationReference, ::testing::ValuesIn(kReferenceOperations),
                         [](const auto& suite) { return std::string(suite.param); });

TEST(Int8Reference, IsWhatPyTorchComputesFromBytes) {
  if (FindByteUnit() == ByteUnit::kNone) GTEST_SKIP() << "this processor has no unit for 8 bits";
  const std::filesystem::path path = ReferenceFile("convolution_of_bytes");
  const ExecutorOptions options{.threads = 2, .precision = DataType::kInt8};
  ExpectEveryTensorOf(path, kRoundingsOfOperation, options);
  ExpectOutputsOf(path, kRoundingsOfOperation, options);
}

class NetworkReference : public ::testing::TestWithParam<const char*> {
 protected:
  std::filesystem::path path_ = ReferenceFile(GetParam());
};

TEST_P(NetworkReference, IsReproducedNodeByNode) {
  ExpectEveryTensorOf(path_, kRoundingsOfNetwork, {.threads = 2});
}

TEST_P(NetworkReference, GivesTheSameResultWhenMadeForSpeed) {
  ExpectOutputsOf(path_, kRoundingsOfNetwork);
}

TEST_P(NetworkReference, GivesTheSameBitsForAnyNumberOfThreads) {
  const Graph graph = ReadNetwork(path_);
  const Dump inputs = ReadDumps(path_).begin()->second;
  const DumpRun one(graph, inputs, {.threads = 1});
  for (const int threads : {2, 3}) {
    const DumpRun several(graph, inputs, {.threads = threads});
    for (const auto& [name, output] : one.outputs()) {
      EXPECT_TRUE(output.values == several.outputs().at(name).values) << name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Every, NetworkReference, ::testing::ValuesIn(kReferenceNetworks),
                         [](const auto& suite) { return std::string(suite.param); });

/// Lets weights_tools write references that are too large for the repository. False where its
/// packages are not installed.
bool DumpReferences(const std::string& options, const std::filesystem::path& folder) {
  constexpr int kSkipped = 77;
  std::string command = "cd '" ORB360_SOURCE_DIR "' && ";
  command += "/usr/bin/python3 -c 'import torch, h5py' 2>/dev/null || exit 77; ";
  command += "exec /usr/bin/python3 -B -m weights_tools.dump_reference " + options + " --out '";
  command += folder.string() + "' >&2";
  const int status = std::system(command.c_str());
  if (WIFEXITED(status) && WEXITSTATUS(status) == kSkipped) return false;
  EXPECT_EQ(status, 0) << command;
  return true;
}

TEST(FullNetworkReferenceSlow, IsWhatPyTorchComputes) {
  const TempFolder folder;
  if (!DumpReferences("--full", folder.path())) {
    GTEST_SKIP() << "needs python3-torch and python3-h5py";
  }
  int networks = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder.path())) {
    ExpectOutputsOf(file.path(), kRoundingsOfNetwork);
    ++networks;
  }
  EXPECT_EQ(networks, 4);
}

TEST(ReleasedNetworkSlow, AgreesWithPyTorchWithinAThousandthOfTheLogarithm) {
  const TempFolder folder;
  if (!DumpReferences("--networks weights/*.h5", folder.path())) {
    GTEST_SKIP() << "needs python3-torch and python3-h5py";
  }
  bool is_there = false;
  for (const auto& file : std::filesystem::directory_iterator(folder.path())) {
    is_there |= file.path().filename() == "depth_completion.h5";
    const Graph graph = ReadNetwork(file.path());
    for (const auto& [name, dump] : ReadDumps(file.path())) {
      const DumpRun run(graph, dump);
      for (const Graph::Output& output : graph.outputs) {
        DumpedTensor expected =
            dump.at(graph.tensors[static_cast<std::size_t>(output.tensor)].name);
        DumpedTensor result = run.outputs().at(output.name);
        if (output.name == "depth") {
          for (float& value : expected.values) value = std::log(std::max(value, 1.0f));
          for (float& value : result.values) value = std::log(std::max(value, 1.0f));
        }
        EXPECT_EQ(WorstDifference(result, expected, 1e-3f), "")
            << file.path().filename() << " " << output.name;
      }
    }
  }
  EXPECT_TRUE(is_there);
}

// The published unguided network with its authors' weights, run by their own code in single
// precision: ../shared/reference/README.md. It is not part of the repository.
class PublishedReference : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(path_)) GTEST_SKIP() << path_ << " is not there";
  }

  DumpedTensor Read(const std::string& name) const {
    const Hdf5Handle file(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    const Hdf5Handle set(H5Dopen2(file.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
    const Hdf5Handle space(H5Dget_space(set.get()), H5Sclose);
    hsize_t sizes[4] = {1, 1, 1, 1};  // of an image: 1 x channels x height x width
    H5Sget_simple_extent_dims(space.get(), sizes, nullptr);
    DumpedTensor tensor{
        {static_cast<int>(sizes[1]), static_cast<int>(sizes[2]), static_cast<int>(sizes[3])},
        std::vector<float>(sizes[0] * sizes[1] * sizes[2] * sizes[3])};
    EXPECT_GE(
        H5Dread(set.get(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, tensor.values.data()),
        0)
        << name;
    return tensor;
  }

  const std::filesystem::path path_ = std::filesystem::path(ORB360_SOURCE_DIR) /
                                      "../shared/reference/nconv_kitti_unguided_64x128.h5";
};

TEST_F(PublishedReference, IsReproducedNodeByNodeWithinATenthOfAMillimetre) {
  // Of the layers: what the reference calls their weights (navg...) and biases.
  const std::map<std::string, std::string> layers = {
      {"n1", "1"}, {"n2", "2"}, {"n3", "3"}, {"n4", "34"}, {"n5", "23"}, {"n6", "12"}, {"n7", "4"}};
  const std::map<std::string, std::string> tensors = {
      {"level0", "mid/x1"},      {"level0.c", "mid/c1"},  {"level1", "mid/x2"},
      {"level1.c", "mid/c2"},    {"level2", "mid/x3"},    {"level2.c", "mid/c3"},
      {"level3", "mid/x4"},      {"level3.c", "mid/c4"},  {"decoded0", "mid/x12"},
      {"decoded0.c", "mid/c12"}, {"propagated", "out/x"}, {"propagated.c", "out/c"}};
  Graph graph = ReadNetwork(ReferenceFile("unguided"));
  for (Weight& weight : graph.weights) {
    const std::string layer = weight.name.substr(0, weight.name.find('.'));
    const bool is_bias = weight.name.ends_with("bias");
    const std::string& key = layers.at(layer);
    const DumpedTensor values = Read(is_bias ? "w/bias" + key : "w/navg" + key + ".weight");
    ASSERT_EQ(values.values.size(), weight.values.size()) << weight.name;
    weight.values = values.values;
  }
  const Dump inputs = {{"depth", Read("in/x")}, {"confidence", Read("in/c")}};
  const DumpRun run(graph, inputs, {.threads = 2, .keeps_tensors = true});
  for (const auto& [tensor, key] : tensors) {
    const bool is_confidence = tensor.ends_with(".c");
    const float tolerance = is_confidence ? 1e-6f : 1e-4f;  // fractions; metres
    EXPECT_EQ(WorstDifference(run.Find(tensor), Read(key), tolerance), "") << tensor;
  }
  EXPECT_EQ(WorstDifference(DumpRun(graph, inputs).outputs().at("depth"), Read("out/x"), 1e-4f),
            "");
}

}  // namespace
}  // namespace orb360::nn
