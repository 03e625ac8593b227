#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/nn/tensor_memory.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/tensor.h>

namespace orb360::nn {
namespace {

float Value(int channel, int y, int x) { return static_cast<float>(100 * channel + 10 * y + x); }

void Number(const TensorView& tensor) {
  for (int c = 0; c < tensor.shape.channels; ++c) {
    for (int y = 0; y < tensor.shape.height; ++y) {
      for (int x = 0; x < tensor.shape.width; ++x) At(tensor, c, y, x) = Value(c, y, x);
    }
  }
}

TEST(Tensor, RowsAreAlignedInEveryLayout) {
  for (const Layout layout : {Layout::kPlanar, Layout::kBlocked}) {
    for (const DataType type : {DataType::kFloat, DataType::kBFloat16}) {
      for (const int halo : {0, 1, 2}) {
        const TensorMemory memory({{3, 5, 7}, layout, type, halo});
        const auto size = static_cast<std::ptrdiff_t>(SizeOf(type));
        const TensorView& view = memory.view;
        for (int plane = 0; plane < view.planes(); ++plane) {
          for (int y = -halo; y < 5 + halo; ++y) {
            const std::byte* const row = view.row<std::byte>(0, 0) +
                                         (plane * view.plane_stride + y * view.row_stride) * size;
            EXPECT_EQ(reinterpret_cast<std::uintptr_t>(row) % kAlignment, 0u);
          }
        }
      }
    }
  }
}

TEST(Tensor, PlanesLieACacheLineMoreThanTheirRowsApart) {
  for (const Layout layout : {Layout::kPlanar, Layout::kBlocked}) {
    for (const DataType type : {DataType::kFloat, DataType::kBFloat16}) {
      for (const int halo : {0, 1}) {
        const TensorFormat format{{40, 8, 16}, layout, type, halo};
        const std::ptrdiff_t line = BlockOf(type);
        EXPECT_EQ(format.plane_stride(), format.row_stride() * (8 + 2 * halo) + line);
        const std::ptrdiff_t planes = TensorMemory(format).view.planes();
        EXPECT_EQ(format.bytes(),
                  static_cast<std::size_t>(planes * format.plane_stride()) * SizeOf(type));
      }
    }
  }
}

// Where a pixel of the halo must come from, by walking over the sphere in single steps.
float Expected(Padding padding, const Shape& shape, int channel, int y, int x) {
  if (padding == Padding::kZero) return 0;
  if (padding == Padding::kWrapReplicate) {
    y = std::min(std::max(y, 0), shape.height - 1);
  } else {
    while (y < 0 || y >= shape.height) {
      y = y < 0 ? -1 - y : 2 * shape.height - 1 - y;
      x += shape.width / 2;
    }
  }
  return Value(channel, y, ((x % shape.width) + shape.width) % shape.width);
}

TEST(Tensor, HaloContinuesTheImageAsThePaddingSays) {
  for (const Layout layout : {Layout::kPlanar, Layout::kBlocked}) {
    for (const Padding padding :
         {Padding::kZero, Padding::kWrapReplicate, Padding::kWrapCrossPole}) {
      for (const Shape shape : {Shape{2, 4, 6}, Shape{17, 1, 2}}) {
        const int halo = 3;
        const TensorMemory memory({shape, layout, DataType::kFloat, halo});
        Number(memory.view);
        FillHalo(memory.view, padding, halo);
        for (int c = 0; c < shape.channels; ++c) {
          for (int y = -halo; y < shape.height + halo; ++y) {
            for (int x = -halo; x < shape.width + halo; ++x) {
              const bool inside = y >= 0 && y < shape.height && x >= 0 && x < shape.width;
              ASSERT_EQ(At(memory.view, c, y, x),
                        inside ? Value(c, y, x) : Expected(padding, shape, c, y, x))
                  << "padding " << static_cast<int>(padding) << " channel " << c << " y " << y
                  << " x " << x;
            }
          }
        }
      }
    }
  }
}

TEST(Tensor, AnOddImageHasNoOppositeMeridian) {
  const TensorMemory memory({{1, 4, 5}, Layout::kPlanar, DataType::kFloat, 1});
  EXPECT_THROW(FillHalo(memory.view, Padding::kWrapCrossPole, 1), ContractError);
}

TEST(Tensor, ReorderRoundTripsAndFillsTheLastBlockWithZeros) {
  const Shape shape{18, 3, 5};
  const TensorMemory planar({shape, Layout::kPlanar, DataType::kFloat, 1});
  const TensorMemory blocked({shape, Layout::kBlocked, DataType::kFloat, 2});
  const TensorMemory back({shape, Layout::kPlanar, DataType::kFloat, 0});
  Number(planar.view);
  Reorder(planar.view, blocked.view);
  Reorder(blocked.view, back.view);
  for (int c = 0; c < 32; ++c) {
    for (int y = 0; y < 3; ++y) {
      for (int x = 0; x < 5; ++x) {
        ASSERT_EQ(At(blocked.view, c, y, x), c < 18 ? Value(c, y, x) : 0) << c << y << x;
        if (c < 18) {
          ASSERT_EQ(At(back.view, c, y, x), Value(c, y, x));
        }
      }
    }
  }
}

TEST(Tensor, BFloat16RoundsToNearestEvenAndKeepsWhatIsNotANumber) {
  const std::vector<float> values = {1.0f,
                                     1.0f + 0x1p-8f,             // a tie, down to even
                                     1.0f + 3 * 0x1p-8f,         // a tie, up to even
                                     1.0f + 0x1p-8f + 0x1p-20f,  // above a tie
                                     -3.14159265f,
                                     std::numeric_limits<float>::infinity(),
                                     std::numeric_limits<float>::max()};
  const std::vector<float> expected = {1.0f,
                                       1.0f,
                                       1.0f + 0x1p-6f,
                                       1.0f + 0x1p-7f,
                                       -3.140625f,
                                       std::numeric_limits<float>::infinity(),
                                       std::numeric_limits<float>::infinity()};
  const Shape shape{1, 1, static_cast<int>(values.size()) + 1};
  const TensorMemory from({shape, Layout::kPlanar, DataType::kFloat, 0});
  const TensorMemory half({shape, Layout::kBlocked, DataType::kBFloat16, 0});
  const TensorMemory to({shape, Layout::kPlanar, DataType::kFloat, 0});
  for (std::size_t i = 0; i < values.size(); ++i)
    At(from.view, 0, 0, static_cast<int>(i)) = values[i];
  At(from.view, 0, 0, shape.width - 1) = std::numeric_limits<float>::quiet_NaN();
  Reorder(from.view, half.view);
  Reorder(half.view, to.view);
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(At(to.view, 0, 0, static_cast<int>(i)), expected[i]) << values[i];
  }
  EXPECT_TRUE(std::isnan(At(to.view, 0, 0, shape.width - 1)));
}

TEST(Tensor, AChannelSliceIsAWindowOnTheSameMemory) {
  const TensorMemory memory({{48, 2, 2}, Layout::kBlocked, DataType::kFloat, 1});
  Number(memory.view);
  const TensorView slice = ChannelSlice(memory.view, 16, 32);
  EXPECT_EQ(At(slice, 5, 1, 1), Value(21, 1, 1));
  EXPECT_THROW(ChannelSlice(memory.view, 8, 16), ContractError);
  EXPECT_THROW(ChannelSlice(memory.view, 32, 32), ContractError);
}

}  // namespace
}  // namespace orb360::nn
