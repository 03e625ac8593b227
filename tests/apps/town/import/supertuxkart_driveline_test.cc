#include "apps/town/import/supertuxkart_driveline.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <orb360/nn/base/check.h>

namespace orb360::town {
namespace {

using ::testing::HasSubstr;

class DrivelineTest : public testing::Test {
 protected:
  DrivelineTest()
      : folder_(std::filesystem::temp_directory_path() /
                ("driveline_test_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    Write("scene.xml", "<scene/>");
  }
  ~DrivelineTest() override { std::filesystem::remove_all(folder_); }

  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  std::vector<RoadSection> Read() const { return ReadSuperTuxKartDriveline(folder_ / "scene.xml"); }
  std::string Problem() const {
    try {
      Read();
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder_;
};

constexpr const char* kQuads =
    R"(<quads><height-testing min="-1" max="5"/>
       <quad p0="-4 1 0" p1="4 1 0" p2="5 1 9" p3="-5 1 9"/>
       <quad p0="0:3" p1="0:2" p2="6 2 20" p3="-6 2 20"/>
       <quad p0="1:3" p1="1:2" p2="0:1" p3="0:0"/>
       <quad invisible="yes" p0="0 0 0" p1="1 0 0" p2="1 0 1" p3="0 0 1"/></quads>)";
constexpr const char* kGraph =
    R"(<graph><node-list from-quad="0" to-quad="3"/><edge-loop from="0" to="2"/>
       <edge from="1" to="3"/></graph>)";

TEST_F(DrivelineTest, FollowsTheMainLoopAndCornersOfEarlierQuads) {
  Write("quads.xml", kQuads);
  Write("graph.xml", kGraph);
  const std::vector<RoadSection> sections = Read();
  ASSERT_EQ(sections.size(), 3U);
  EXPECT_EQ(sections[0].left, Eigen::Vector3f(-4, 1, 0));
  EXPECT_EQ(sections[1].left, Eigen::Vector3f(-5, 1, -9));  // z turned round
  EXPECT_EQ(sections[1].right, Eigen::Vector3f(5, 1, -9));
  EXPECT_EQ(sections[2].right, Eigen::Vector3f(6, 2, -20));
}

TEST_F(DrivelineTest, ArenasAndDamagedFilesAreRefused) {
  EXPECT_THAT(Problem(), HasSubstr("has no quads.xml: an arena has no driveline"));
  Write("quads.xml", R"(<quads><quad p0="0:3" p1="0:2" p2="0 0 0" p3="0 0 0"/></quads>)");
  EXPECT_THAT(Problem(), HasSubstr("quads.xml: quad 0: p0=\"0:3\": is not a corner of an earlier"));
  Write("quads.xml", R"(<quads><quad p0="0 0 0" p1="1 0 0" p2="0 0 0"/></quads>)");
  EXPECT_THAT(Problem(), HasSubstr("p3=\"\": the corner is missing"));
  Write("quads.xml", kQuads);
  EXPECT_THAT(Problem(), HasSubstr("graph.xml: no such file"));
  Write("graph.xml", R"(<graph><edge-loop from="0" to="4"/></graph>)");
  EXPECT_THAT(Problem(), HasSubstr("graph.xml: has no <edge-loop>"));
}

}  // namespace
}  // namespace orb360::town
