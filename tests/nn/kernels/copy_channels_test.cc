#include "nn/kernels/copy_channels.h"

#include <gtest/gtest.h>

#include "nn/base/bfloat16.h"
#include "tests/nn/kernels/plain_image.h"
#include <orb360/nn/base/check.h>

namespace orb360::nn {
namespace {

constexpr Layout kLayouts[] = {Layout::kPlanar, Layout::kBlocked};
constexpr DataType kTypes[] = {DataType::kFloat, DataType::kBFloat16};

TEST(CopyChannels, MovesAnyChannelsBetweenAnyLayouts) {
  for (const int width : {7, 300}) {
    const PlainImage source = RandomImage({50, 3, width}, -1, 1, 1);
    struct Range {
      int from, to, count, channels;  // the last: of the target
    };
    for (const Layout from_layout : kLayouts) {
      for (const Layout to_layout : kLayouts) {
        for (const Range& range : {Range{0, 0, 50, 50}, Range{16, 32, 16, 48}, Range{3, 5, 20, 40},
                                   Range{49, 0, 1, 1}, Range{32, 16, 18, 34}, Range{32, 0, 18, 20},
                                   Range{0, 0, 24, 27}, Range{21, 5, 29, 40}}) {
          for (const int threads : {1, 2}) {
            const FilledTensor from(source, from_layout, 1);
            PlainImage expected = RandomImage({range.channels, 3, width}, 2, 3, 2);
            const FilledTensor to(expected, to_layout, 0);
            CopyChannels(from.view, range.from, to.view, range.to, range.count, threads);
            for (int i = 0; i < range.count; ++i) {
              for (int y = 0; y < 3; ++y) {
                for (int x = 0; x < width; ++x) {
                  expected.at(range.to + i, y, x) = source.at(range.from + i, y, x);
                }
              }
            }
            SCOPED_TRACE(testing::Message() << range.from << " to " << range.to);
            ExpectEqual(to.view, expected);
          }
        }
      }
    }
  }
}

TEST(CopyChannels, ClearsWhatFillsUpTheLastBlock) {
  for (const DataType type : kTypes) {
    const FilledTensor from(RandomImage({5, 2, 2}, 1, 2, 1), Layout::kPlanar, 0);
    const TensorMemory to({{20, 2, 2}, Layout::kBlocked, type, 0});  // not a zero anywhere
    CopyChannels(from.view, 0, to.view, 15, 5, 1);
    const TensorMemory back({{20, 2, 2}, Layout::kBlocked, DataType::kFloat, 0});
    Reorder(to.view, back.view);
    EXPECT_NE(At(back.view, 14, 1, 1), 0);
    const int block = BlockOf(type);
    for (int lane = 20 % block; lane < block; ++lane) {
      const std::ptrdiff_t at = block + lane;  // of the second pixel of a row
      const int plane = 20 / block;
      EXPECT_EQ(type == DataType::kFloat ? to.view.row<float>(plane, 1)[at]
                                         : ToFloat(to.view.row<BFloat16>(plane, 1)[at]),
                0)
          << lane;
    }
  }
}

TEST(CopyChannels, ClearsTheLastBlockBehindChannelsThatKeepTheirPlaces) {
  for (const DataType type : kTypes) {
    const int block = BlockOf(type);
    const int channels = block + 4;
    const PlainImage source = RandomImage({3 * block, 2, 2}, 1, 2, 1);
    const FilledTensor plain(source, Layout::kPlanar, 0);
    const TensorMemory from({source.shape, Layout::kBlocked, type, 0});
    CopyChannels(plain.view, 0, from.view, 0, 3 * block, 1);
    for (const int first : {0, 3}) {
      const TensorMemory to({{channels, 2, 2}, Layout::kBlocked, type, 0});  // not a zero anywhere
      CopyChannels(from.view, first, to.view, first, channels - first, 1);
      const auto value = [&](const TensorView& view, int plane, int lane) {
        const std::ptrdiff_t at = block + lane;  // of the second pixel of the second row
        return type == DataType::kFloat ? view.row<float>(plane, 1)[at]
                                        : ToFloat(view.row<BFloat16>(plane, 1)[at]);
      };
      for (int c = 0; c < 2 * block; ++c) {
        const float expected = c < channels ? value(from.view, c / block, c % block) : 0;
        EXPECT_EQ(value(to.view, c / block, c % block) == expected, c >= first) << c;
      }
    }
  }
}

TEST(CopyChannels, RoundsToBFloat16AndBack) {
  const PlainImage source = RandomImage({40, 2, 3}, -1, 1, 1);
  for (const Layout layout : kLayouts) {
    for (const int first : {0, 7}) {
      const FilledTensor from(source, layout, 0);
      const TensorMemory half({{33, 2, 3}, Layout::kBlocked, DataType::kBFloat16, 1});
      const TensorMemory back({{33, 2, 3}, layout, DataType::kFloat, 0});
      CopyChannels(from.view, first, half.view, 0, 33, 2);
      CopyChannels(half.view, 0, back.view, 0, 33, 2);
      PlainImage expected({33, 2, 3});
      for (int c = 0; c < 33; ++c) {
        for (int y = 0; y < 2; ++y) {
          for (int x = 0; x < 3; ++x) {
            expected.at(c, y, x) =
                ToFloat(ToBFloat16(static_cast<float>(source.at(first + c, y, x))));
          }
        }
      }
      ExpectEqual(back.view, expected);
    }
  }
}

// Whole blocks go by another way than single channels; the numbers must be the same.
TEST(CopyChannels, RoundsWholeBlocksLikeSingleChannels) {
  for (const int channels : {5, 16, 20, 32, 40, 64, 70}) {
    const PlainImage source = RandomImage({channels, 3, 5}, -1, 1, 1);
    const FilledTensor from(source, Layout::kBlocked, 1);
    const TensorMemory half({{channels, 3, 5}, Layout::kBlocked, DataType::kBFloat16, 1});
    const TensorMemory back({{channels, 3, 5}, Layout::kBlocked, DataType::kFloat, 0});
    CopyChannels(from.view, 0, half.view, 0, channels, 2);
    CopyChannels(half.view, 0, back.view, 0, channels, 2);
    PlainImage expected = source;
    for (double& value : expected.values) value = ToFloat(ToBFloat16(static_cast<float>(value)));
    SCOPED_TRACE(channels);
    ExpectEqual(back.view, expected);
    const int padded = (channels + 31) / 32 * 32;
    for (int c = channels; c < padded; ++c) {
      EXPECT_EQ(ToFloat(half.view.row<BFloat16>(c / 32, 2)[4 * 32 + c % 32]), 0) << c;
    }
  }
}

TEST(CopyChannels, RefusesChannelsThatAreNotThere) {
  const TensorMemory a({{4, 2, 2}, Layout::kPlanar, DataType::kFloat, 0});
  const TensorMemory b({{4, 2, 3}, Layout::kPlanar, DataType::kFloat, 0});
  EXPECT_THROW(CopyChannels(a.view, 2, a.view, 0, 3, 1), ContractError);
  EXPECT_THROW(CopyChannels(a.view, 0, a.view, 3, 2, 1), ContractError);
  EXPECT_THROW(CopyChannels(a.view, 0, b.view, 0, 1, 1), ContractError);
}

}  // namespace
}  // namespace orb360::nn
