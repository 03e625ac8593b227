// Networks against what PyTorch computed in double precision (weights_tools.dump_reference), and
// against what the authors of a published one computed.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "nn/base/hdf5_handle.h"
#include "tests/nn/dump.h"
#include "tests/nn/graph/dump_run.h"
#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/graph/network_file.h>

namespace orb360::nn {
namespace {

constexpr float kEpsilon = std::numeric_limits<float>::epsilon();

const std::filesystem::path kData = std::filesystem::path(ORB360_SOURCE_DIR) / "tests/nn/data";

/// The largest finite magnitude: the norm that errors of a tensor are measured by.
float LargestOf(const DumpedTensor& tensor) {
  float largest = 0;
  for (const float value : tensor.values) {
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  }
  return largest;
}

/// The worst element of `result` when it is farther than `tolerance` from `expected`, which may
/// hold fewer channels; "" otherwise. NaN and infinity must be where they are expected.
std::string WorstDifference(const DumpedTensor& result, const DumpedTensor& expected,
                            float tolerance) {
  const auto [channels, height, width] = expected.shape;
  if (result.shape.channels < channels || result.shape.height != height ||
      result.shape.width != width) {
    return "has another shape";
  }
  float worst = tolerance;
  std::string text;
  for (std::size_t i = 0; i < expected.values.size(); ++i) {
    const float a = result.values[i];
    const float b = expected.values[i];
    if (a == b || (std::isnan(a) && std::isnan(b))) continue;
    const float difference = std::abs(a - b);
    if (difference <= worst) continue;
    // NaN where a number should be, or the other way round, is as bad as it gets.
    worst = std::isnan(difference) ? std::numeric_limits<float>::infinity() : difference;
    const int pixel = static_cast<int>(i) % (height * width);
    text = "channel " + std::to_string(static_cast<int>(i) / (height * width));
    text += " row " + std::to_string(pixel / width) + " column " + std::to_string(pixel % width);
    text += ": " + std::to_string(a) + " instead of " + std::to_string(b) + ", tolerance " +
            std::to_string(tolerance);
  }
  return text;
}

/// What errors of a tensor are measured by: its norm and those of what its node reads, from which
/// it may be small by cancellation.
float NormOf(const Graph& graph, const Dump& dump, const std::string& tensor) {
  const auto norm = [&](int index) {
    const auto found = dump.find(graph.tensors[static_cast<std::size_t>(index)].name);
    return found == dump.end() ? 0 : LargestOf(found->second);
  };
  float largest = LargestOf(dump.at(tensor));
  for (const Node& node : graph.nodes) {
    const bool is_writer = std::ranges::any_of(node.outputs, [&](int output) {
      return graph.tensors[static_cast<std::size_t>(output)].name == tensor;
    });
    if (!is_writer) continue;
    for (const int input : node.inputs) largest = std::max(largest, norm(input));
  }
  return largest;
}

/// Every tensor of the dumps in a file against those of runs that keep them. `roundings`: how often
/// a value of the size of the norm may have been rounded.
void ExpectEveryTensorOf(const std::filesystem::path& path, float roundings) {
  const Graph graph = ReadNetwork(path);
  for (const auto& [name, dump] : ReadDumps(path)) {
    const DumpRun run(graph, dump, {.threads = 2, .keeps_tensors = true});
    for (const auto& [tensor, expected] : dump) {
      const float tolerance = roundings * kEpsilon * NormOf(graph, dump, tensor);
      EXPECT_EQ(WorstDifference(run.Find(tensor), expected, tolerance), "")
          << path.stem() << " " << name << " " << tensor;
    }
  }
}

/// The same for outputs of runs as fast as they can be.
void ExpectOutputsOf(const std::filesystem::path& path, float roundings) {
  const Graph graph = ReadNetwork(path);
  for (const auto& [name, dump] : ReadDumps(path)) {
    const DumpRun run(graph, dump);
    for (const Graph::Output& output : graph.outputs) {
      const std::string& tensor = graph.tensors[static_cast<std::size_t>(output.tensor)].name;
      const float tolerance = roundings * kEpsilon * NormOf(graph, dump, tensor);
      EXPECT_EQ(WorstDifference(run.outputs().at(output.name), dump.at(tensor), tolerance), "")
          << path.stem() << " " << name << " " << output.name;
    }
  }
}

/// Sums of up to 450 products, each rounded: sqrt(450) if all were of the norm's size.
constexpr float kRoundingsOfOperation = 20;
/// Errors that add up over some fifty nodes.
constexpr float kRoundingsOfNetwork = 64;

class OperationReference : public ::testing::TestWithParam<const char*> {
 protected:
  std::filesystem::path path_ = kData / (std::string(GetParam()) + ".h5");
};

TEST_P(OperationReference, IsWhatPyTorchComputes) {
  ExpectEveryTensorOf(path_, kRoundingsOfOperation);
}

TEST_P(OperationReference, IsTheSameInANetworkMadeForSpeed) {
  ExpectOutputsOf(path_, kRoundingsOfOperation);
}

INSTANTIATE_TEST_SUITE_P(Every, OperationReference,
                         ::testing::Values("convolution", "convolution_across_poles",
                                           "normalized_convolution",
                                           "normalized_convolution_across_poles", "pooling",
                                           "upsampling", "upsampling_across_poles", "elementwise",
                                           "panorama"),
                         [](const auto& suite) { return std::string(suite.param); });

class NetworkReference : public ::testing::TestWithParam<const char*> {
 protected:
  std::filesystem::path path_ = kData / (std::string(GetParam()) + ".h5");
};

TEST_P(NetworkReference, IsReproducedNodeByNode) {
  ExpectEveryTensorOf(path_, kRoundingsOfNetwork);
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

INSTANTIATE_TEST_SUITE_P(Every, NetworkReference,
                         ::testing::Values("unguided", "encoder_decoder", "multi_stream",
                                           "depth_completion"),
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
  Graph graph = ReadNetwork(kData / "unguided.h5");
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
