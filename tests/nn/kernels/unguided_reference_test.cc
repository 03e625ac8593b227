// The published unguided network against what its authors' own code computed with its published
// weights. Those are under another licence and no part of this repository: the test runs where
// somebody has put the file beside it.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <hdf5.h>

#include "nn/base/hdf5_handle.h"
#include "tests/dispatch_targets.h"
#include "tests/nn/kernels/propagation_network.h"

namespace orb360::nn {
namespace {

const std::filesystem::path kFile =
    std::filesystem::path(ORB360_SOURCE_DIR) / "../shared/reference/nconv_kitti_unguided_64x128.h5";

constexpr int kHeight = 64;
constexpr int kWidth = 128;

class Reference {
 public:
  Reference() : file_(H5Fopen(kFile.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose) {}

  std::vector<float> Values(const std::string& name) const {
    const Hdf5Handle dataset(H5Dopen2(file_.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
    const Hdf5Handle space(H5Dget_space(dataset.get()), H5Sclose);
    std::vector<float> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.get())));
    EXPECT_GE(
        H5Dread(dataset.get(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0)
        << name;
    return values;
  }
  PlainImage Image(const std::string& name, const Shape& shape) const {
    PlainImage image(shape);
    const std::vector<float> values = Values(name);
    EXPECT_EQ(values.size(), image.values.size()) << name;
    image.values.assign(values.begin(), values.end());
    return image;
  }
  NormalizedConvolution Layer(const std::string& suffix, const std::string& bias, int outputs,
                              int inputs, int size) const {
    return {Values("w/navg" + suffix + ".weight"),
            Values("w/bias" + bias),
            outputs,
            inputs,
            size,
            Padding::kZero};
  }

 private:
  Hdf5Handle file_;
};

// Depths within 1e-4 m: in double precision the network is off by up to 3.4e-5 m. Confidences,
// which no subtraction touches, within the roundings of nine layers of up to 50 taps.
void ExpectNode(const Reference& reference, const std::string& x_name, const std::string& c_name,
                const ConfidentTensor& actual) {
  SCOPED_TRACE(x_name);
  const PlainImage x = reference.Image(x_name, actual.x.shape);
  const PlainImage c = reference.Image(c_name, actual.c.shape);
  PlainImage metres(x.shape);
  PlainImage fraction(c.shape);
  for (double& allowed : metres.values) allowed = 1e-4;
  for (std::size_t i = 0; i < c.values.size(); ++i) {
    fraction.values[i] = 9 * (50 + 4) * 0x1p-24 * c.values[i];
  }
  ExpectNear(actual.x, x, metres);
  ExpectNear(actual.c, c, fraction);
}

TEST(UnguidedReference, IsReproducedNodeByNode) {
  if (!std::filesystem::exists(kFile)) {
    GTEST_SKIP() << "no " << kFile.lexically_normal()
                 << ": the published weights are not part of this repository";
  }
  const Reference reference;
  const std::vector<NormalizedConvolution> layers = {
      reference.Layer("1", "1", 2, 1, 5),   reference.Layer("2", "2", 2, 2, 5),
      reference.Layer("3", "3", 2, 2, 5),   reference.Layer("34", "34", 2, 4, 3),
      reference.Layer("23", "23", 2, 4, 3), reference.Layer("12", "12", 2, 4, 3),
      reference.Layer("4", "4", 1, 2, 1)};
  const Shape whole{1, kHeight, kWidth};
  const FilledTensor x(reference.Image("in/x", whole), Layout::kPlanar, 0);
  const FilledTensor c(reference.Image("in/c", whole), Layout::kPlanar, 0);
  ForEachDispatchTarget([&] {
    for (const int threads : {1, 2}) {
      const TensorMemory y({whole, Layout::kPlanar, DataType::kFloat, 0});
      const TensorMemory y_confidence({whole, Layout::kPlanar, DataType::kFloat, 0});
      const ConfidentTensor output{y.view, y_confidence.view};
      PropagationNetwork network = UnguidedNetwork(layers, kHeight, kWidth, threads);
      network.Run({x.view, c.view}, output);
      for (const int level : {0, 1, 2, 3}) {
        const std::string number = std::to_string(level + 1);
        ExpectNode(reference, "mid/x" + number, "mid/c" + number, network.level(level));
      }
      ExpectNode(reference, "out/x", "out/c", output);

      // The last decoder layer by itself, whose result the network's chain does not write.
      const NormalizedChain last({layers[5]});
      const Scratch scratch(last.ScratchBytes(kWidth, threads));
      const TensorMemory joined({{2, kHeight, kWidth}, Layout::kPlanar, DataType::kFloat, 0});
      const TensorMemory joined_c({{2, kHeight, kWidth}, Layout::kPlanar, DataType::kFloat, 0});
      const NormalizedInput inputs[] = {{network.joined(1), true}, {network.level(0), false}};
      last.Run(inputs, {joined.view, joined_c.view}, scratch.bytes, threads);
      ExpectNode(reference, "mid/x12", "mid/c12", {joined.view, joined_c.view});
    }
  });
}

}  // namespace
}  // namespace orb360::nn
