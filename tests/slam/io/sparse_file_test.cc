#include "slam/io/sparse_file.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

class SparseFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::path(testing::TempDir()) /
        (std::string("sparse_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
    sample_.image = cv::Mat(16, 32, CV_8UC3);
    cv::randu(sample_.image, 0, 256);
    sample_.sparse = {cv::Mat::zeros(16, 32, CV_32F), cv::Mat::zeros(16, 32, CV_32F)};
    sample_.sparse.range.at<float>(3, 7) = 4.25f;
    sample_.sparse.confidence.at<float>(3, 7) = 0.75f;
    sample_.frame_index = 12;
    sample_.timestamp = 0.4;
    sample_.world_from_camera = {ExpSo3({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0}};
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static std::string Bytes(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  std::filesystem::path folder_;
  SparseSample sample_;
};

TEST_F(SparseFile, ReadsBackWhatWasWritten) {
  WriteSparseSample(folder_ / "a.h5", sample_);
  const SparseSample back = ReadSparseSample(folder_ / "a.h5");
  EXPECT_EQ(cv::norm(back.image, sample_.image, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(back.sparse.range, sample_.sparse.range, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(back.sparse.confidence, sample_.sparse.confidence, cv::NORM_INF), 0.0);
  EXPECT_EQ(back.frame_index, 12);
  EXPECT_EQ(back.timestamp, 0.4);
  EXPECT_EQ(back.world_from_camera.translation, sample_.world_from_camera.translation);
  EXPECT_EQ(back.world_from_camera.rotation.coeffs(), sample_.world_from_camera.rotation.coeffs());
}

TEST_F(SparseFile, SameSampleGivesTheSameBytes) {
  WriteSparseSample(folder_ / "a.h5", sample_);
  WriteSparseSample(folder_ / "b.h5", sample_);
  EXPECT_EQ(Bytes(folder_ / "a.h5"), Bytes(folder_ / "b.h5"));
}

TEST_F(SparseFile, RefusesWhatIsNotASample) {
  EXPECT_THROW(ReadSparseSample(folder_ / "missing.h5"), UserError);
  std::ofstream(folder_ / "text.h5") << "not HDF5";
  EXPECT_THROW(ReadSparseSample(folder_ / "text.h5"), UserError);
  WriteSparseSample(folder_ / "a.h5", sample_);
  std::string bytes = Bytes(folder_ / "a.h5");
  std::ofstream(folder_ / "cut.h5", std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  EXPECT_THROW(ReadSparseSample(folder_ / "cut.h5"), UserError);
}

TEST_F(SparseFile, AnUnwritableFolderIsTheUsersError) {
  EXPECT_THROW(WriteSparseSample(folder_ / "none" / "a.h5", sample_), UserError);
}

}  // namespace
}  // namespace orb360
