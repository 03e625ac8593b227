#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "nn/graph/cpu_backend.h"
#include "tests/slam/pipeline/propagation_network.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/depth/depth_completer.h>

namespace {

/// Whether the aligned memory in which networks work is used up.
std::atomic<bool> aligned_memory_is_full = false;

}  // namespace

void* operator new(std::size_t bytes, std::align_val_t alignment) {
  const auto multiple = static_cast<std::size_t>(alignment);
  void* const memory = aligned_memory_is_full
                           ? nullptr
                           : std::aligned_alloc(multiple, (bytes / multiple + 1) * multiple);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace orb360 {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// When a device fails.
struct Failure {
  bool at_preparation = false;
  bool at_allocation = false;
  int after_runs = 1000;
  bool takes_memory = false;  // when it fails in a run
};

/// The CPU's program until the device fails.
class FailingProgram : public nn::Program {
 public:
  FailingProgram(std::unique_ptr<const nn::Program> program, const Failure& failure)
      : program_(std::move(program)), failure_(failure), runs_left_(failure.after_runs) {}

  std::unique_ptr<nn::ProgramMemory> Allocate() const override {
    if (failure_.at_allocation) throw nn::DeviceError("it has too little memory");
    return program_->Allocate();
  }
  void Run(std::span<const std::span<const float>> inputs,
           std::span<const std::span<float>> outputs, nn::ProgramMemory* memory) const override {
    if (runs_left_-- == 0) {
      aligned_memory_is_full = failure_.takes_memory;
      throw nn::DeviceError("it was lost");
    }
    program_->Run(inputs, outputs, memory);
  }
  nn::TensorView Find(const nn::ProgramMemory& memory, int value) const override {
    return program_->Find(memory, value);
  }
  std::vector<double> Times(const nn::ProgramMemory& memory) const override {
    return program_->Times(memory);
  }
  std::size_t planned_bytes() const override { return program_->planned_bytes(); }
  std::size_t naive_bytes() const override { return program_->naive_bytes(); }

 private:
  std::unique_ptr<const nn::Program> program_;
  Failure failure_;
  mutable int runs_left_;
};

class FailingBackend : public nn::CpuBackend {
 public:
  explicit FailingBackend(const Failure& failure) : CpuBackend(1), failure_(failure) {}

  std::unique_ptr<const nn::Program> MakeProgram(const nn::Graph& graph,
                                                 std::span<const nn::FusedNode> nodes,
                                                 nn::Lowered lowered, int height, int width,
                                                 const nn::ProgramOptions& options) const override {
    if (failure_.at_preparation) throw nn::DeviceError("it has no shaders");
    return std::make_unique<FailingProgram>(
        CpuBackend::MakeProgram(graph, nodes, std::move(lowered), height, width, options),
        failure_);
  }

 private:
  Failure failure_;
};

class DepthCompleterTest : public ::testing::Test {
 protected:
  DepthCompleter Make(const nn::Device& device) const {
    return DepthCompleter(weights_, {.size = size_, .device = device});
  }
  DepthCompleter MakeFailing(const Failure& failure) const {
    return Make({"test device", std::make_shared<FailingBackend>(failure)});
  }

  /// One point at column `x`.
  DenseDepth Complete(DepthCompleter* completer, int x) const {
    SparseDepth sparse{cv::Mat::zeros(size_, CV_32F), cv::Mat::zeros(size_, CV_32F)};
    sparse.range.at<float>(16, x) = static_cast<float>(x);
    sparse.confidence.at<float>(16, x) = 1;
    return completer->Complete(cv::Mat(size_, CV_8UC3, cv::Scalar(1, 2, 3)), sparse);
  }

  void ExpectSameAsCpu(DepthCompleter* completer, int x) const {
    DepthCompleter cpu = Make({});
    const DenseDepth expected = Complete(&cpu, x);
    const DenseDepth actual = Complete(completer, x);
    EXPECT_EQ(cv::norm(actual.range, expected.range, cv::NORM_INF), 0) << x;
    EXPECT_EQ(cv::norm(actual.confidence, expected.confidence, cv::NORM_INF), 0) << x;
    EXPECT_EQ(expected.range.at<float>(16, x), static_cast<float>(x));
  }

  TempFolder folder_;
  const std::filesystem::path weights_ = WritePropagation(folder_);
  const cv::Size size_{64, 32};
};

TEST_F(DepthCompleterTest, UsesTheDeviceAsLongAsItWorks) {
  DepthCompleter completer = MakeFailing({});
  for (const int x : {5, 9, 20}) ExpectSameAsCpu(&completer, x);
  EXPECT_EQ(completer.device(), "test device");
  EXPECT_THAT(completer.device_failure(), IsEmpty());
}

TEST_F(DepthCompleterTest, GoesOnWithTheCpuWhereADeviceIsLost) {
  DepthCompleter completer = MakeFailing({.after_runs = 2});
  // Its file is not needed any more.
  std::filesystem::remove(weights_);
  Complete(&completer, 5);
  Complete(&completer, 9);
  EXPECT_EQ(completer.device(), "test device");
  WritePropagation(folder_);  // for the CPU that is compared
  for (const int x : {20, 30}) ExpectSameAsCpu(&completer, x);
  EXPECT_EQ(completer.device(), "cpu");
  EXPECT_EQ(completer.device_failure(), "it was lost; the network runs on the CPU instead");
}

TEST_F(DepthCompleterTest, WhereTheCpuHasTooLittleMemoryToGoOnTheNextImageTriesAgain) {
  DepthCompleter completer = MakeFailing({.after_runs = 1, .takes_memory = true});
  Complete(&completer, 5);
  EXPECT_ANY_THROW(Complete(&completer, 9));
  EXPECT_ANY_THROW(Complete(&completer, 9));
  EXPECT_THAT(completer.device_failure(), IsEmpty());
  aligned_memory_is_full = false;
  for (const int x : {20, 30}) ExpectSameAsCpu(&completer, x);
  EXPECT_EQ(completer.device(), "cpu");
  EXPECT_EQ(completer.device_failure(), "it was lost; the network runs on the CPU instead");
}

TEST_F(DepthCompleterTest, BeginsWithTheCpuWhereADeviceHasTooLittleMemory) {
  for (const Failure& failure : {Failure{.at_preparation = true}, {.at_allocation = true}}) {
    DepthCompleter completer = MakeFailing(failure);
    EXPECT_EQ(completer.device(), "cpu");
    EXPECT_THAT(completer.device_failure(), HasSubstr("the network runs on the CPU instead"));
    ExpectSameAsCpu(&completer, 7);
  }
}

}  // namespace
}  // namespace orb360
