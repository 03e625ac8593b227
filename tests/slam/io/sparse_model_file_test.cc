#include "slam/io/sparse_model_file.h"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "nn/base/checksummed_file.h"
#include "slam/io/sparse_model_arrays.h"
#include "tests/slam/io/synthetic_model.h"
#include "tests/slam/io/temp_folder.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string Refusal(const std::filesystem::path& path) {
  const std::string message = MessageOf<UserError>([&] { ReadSparseModel(path); });
  EXPECT_THAT(message, StartsWith(path.string() + ": "));
  return message;
}

TEST(SparseModelFile, ReadsBackExactlyWhatWasWritten) {
  const TempFolder folder;
  SparseModel model = MakeSyntheticModel();
  model.frames[4].map = 1;
  WriteSparseModel(folder / "a.h5", model);
  const SparseModel read = ReadSparseModel(folder / "a.h5");
  EXPECT_EQ(read.width, 1024);
  EXPECT_EQ(read.height, 512);
  ASSERT_EQ(read.frames.size(), model.frames.size());
  for (size_t f = 0; f < model.frames.size(); ++f) {
    const PosedFrame& was = model.frames[f];
    const PosedFrame& is = read.frames[f];
    EXPECT_EQ(is.index, was.index);
    EXPECT_EQ(is.timestamp, was.timestamp);
    EXPECT_EQ(is.map, was.map);
    EXPECT_EQ(is.is_keyframe, was.is_keyframe);
    EXPECT_EQ(is.world_from_optical.translation, was.world_from_optical.translation);
    EXPECT_EQ(is.world_from_optical.rotation.coeffs(), was.world_from_optical.rotation.coeffs());
    ASSERT_EQ(is.observations.size(), was.observations.size());
    for (size_t o = 0; o < was.observations.size(); ++o) {
      EXPECT_EQ(is.observations[o].pixel, was.observations[o].pixel);
      EXPECT_EQ(is.observations[o].point, was.observations[o].point);
    }
  }
  ASSERT_EQ(read.points.size(), model.points.size());
  EXPECT_EQ(read.points.back().position, model.points.back().position);
  EXPECT_EQ(read.points.back().color, model.points.back().color);
}

TEST(SparseModelFile, TheSameModelGivesTheSameBytesAgain) {
  const TempFolder folder;
  WriteSparseModel(folder / "a.h5", MakeSyntheticModel());
  WriteSparseModel(folder / "b.h5", ReadSparseModel(folder / "a.h5"));
  EXPECT_EQ(ReadText(folder / "a.h5"), ReadText(folder / "b.h5"));
}

TEST(SparseModelFile, ARunWithoutAPoseGivesAFileWithoutFrames) {
  const TempFolder folder;
  WriteSparseModel(folder / "a.h5", {64, 32, {}, {}});
  const SparseModel read = ReadSparseModel(folder / "a.h5");
  EXPECT_EQ(read.width, 64);
  EXPECT_TRUE(read.frames.empty());
}

TEST(SparseModelFile, RefusesWhatIsMissingDamagedOrOfAnotherKindOrVersion) {
  const TempFolder folder;
  WriteSparseModel(folder / "model.h5", MakeSyntheticModel());
  const std::string good = ReadText(folder / "model.h5");
  const auto refuse = [&](const std::string& bytes) {
    WriteText(folder / "bad.h5", bytes);
    return Refusal(folder / "bad.h5");
  };
  std::string bad = good;
  bad[good.size() / 2] ^= 1;
  EXPECT_THAT(refuse(bad), HasSubstr("is damaged"));
  EXPECT_THAT(refuse(good.substr(0, good.size() / 2)), HasSubstr("is damaged"));
  EXPECT_THAT(refuse(""), HasSubstr("is not a reconstruction of orb360; `orb360 run` writes them"));
  bad = good;
  bad[8] = 9;
  EXPECT_THAT(refuse(bad), AllOf(HasSubstr("version 9"), HasSubstr("reads version 1")));
  EXPECT_THAT(Refusal(folder / "none.h5"), HasSubstr("cannot be read"));
}

// The digest is no protection from a file that somebody made on purpose.
TEST(SparseModelFile, RefusesADatasetThatClaimsMoreThanTheFileHoldsBeforeMemoryIsTaken) {
  const TempFolder folder;
  std::string content;
  {
    const Hdf5Handle file = CreateChecksummedContent();
    const hsize_t size[2] = {hsize_t{1} << 38, 2};  // 2 TiB, none of which is stored
    const Hdf5Handle space(H5Screate_simple(2, size, nullptr), H5Sclose);
    const Hdf5Handle set(H5Dcreate2(file.get(), "image_size", H5T_STD_I32LE, space.get(),
                                    H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                         H5Dclose);
    content = TakeContent(file);
  }
  constexpr ChecksummedFormat kKind = {"ORB360SM", 1, "", "", "", 0};
  WriteText(folder / "claim.h5", MakeChecksumHeader(kKind, content) + content);
  EXPECT_THAT(Refusal(folder / "claim.h5"), HasSubstr("image_size is of another type or shape"));
}

// What stands behind a right digest can still be no reconstruction.
TEST(SparseModelArrays, RefusesColumnsThatAreNotAReconstruction) {
  const SparseModelArrays good = ToArrays(MakeSyntheticModel());
  const auto refuse = [&](const auto& spoil) -> std::string {
    SparseModelArrays bad = good;
    spoil(&bad);
    try {
      ModelFromArrays(bad);
    } catch (const UserError& error) {
      return error.what();
    }
    return "accepted";
  };
  using Arrays = SparseModelArrays;
  EXPECT_EQ(refuse([](Arrays*) {}), "accepted");
  EXPECT_THAT(refuse([](Arrays* a) { a->image_size[1] = 0; }), HasSubstr("size of images"));
  EXPECT_THAT(refuse([](Arrays* a) { a->image_size[0] = 70000; }), HasSubstr("size of images"));
  EXPECT_THAT(refuse([](Arrays* a) { a->image_size.clear(); }), HasSubstr("size of images"));
  EXPECT_THAT(refuse([](Arrays* a) { a->timestamp.pop_back(); }), HasSubstr("columns of frames"));
  EXPECT_THAT(refuse([](Arrays* a) { a->pose.pop_back(); }), HasSubstr("columns of frames"));
  EXPECT_THAT(refuse([](Arrays* a) { a->pixel.pop_back(); }), HasSubstr("of observations"));
  EXPECT_THAT(refuse([](Arrays* a) { a->color.pop_back(); }), HasSubstr("columns of points"));
  EXPECT_THAT(refuse([](Arrays* a) { a->frame_index[3] = 2; }), HasSubstr("index of frame 3"));
  EXPECT_THAT(refuse([](Arrays* a) { a->frame_index[0] = -1; }), HasSubstr("index of frame 0"));
  EXPECT_THAT(refuse([](Arrays* a) { a->map[1] = -1; }), HasSubstr("map of frame 1"));
  EXPECT_THAT(refuse([](Arrays* a) { a->is_keyframe[1] = 2; }), HasSubstr("map of frame 1"));
  EXPECT_THAT(refuse([](Arrays* a) { a->pose[3] = 2.0; }), HasSubstr("pose of frame 0"));
  EXPECT_THAT(refuse([](Arrays* a) { a->timestamp[1] = NAN; }), HasSubstr("pose of frame 1"));
  EXPECT_THAT(refuse([](Arrays* a) { a->observations_end[0] = -1; }), HasSubstr("frame 0"));
  EXPECT_THAT(refuse([](Arrays* a) { a->is_keyframe[0] = 0; }),
              HasSubstr("number of observations of frame 0"));
  EXPECT_THAT(refuse([](Arrays* a) { a->observations_end.back() -= 1; }), HasSubstr("frame"));
  EXPECT_THAT(refuse([](Arrays* a) { a->pixel[4] = -1; }), HasSubstr("observation 2"));
  EXPECT_THAT(refuse([](Arrays* a) { a->pixel[5] = NAN; }), HasSubstr("observation 2"));
  EXPECT_THAT(refuse([](Arrays* a) { a->observed_point[2] = 1 << 20; }),
              HasSubstr("observation 2"));
  EXPECT_THAT(refuse([](Arrays* a) { a->observed_point[2] = a->observed_point[1]; }),
              HasSubstr("observes twice, of observation 2"));
  EXPECT_THAT(refuse([](Arrays* a) { a->position[9] = INFINITY; }), HasSubstr("point 3"));
}

}  // namespace
}  // namespace orb360
