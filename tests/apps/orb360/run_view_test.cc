#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "tests/apps/orb360/run_fixture.h"
#include "tests/slam/viewer/raw_http.h"

namespace orb360 {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A run that is shown while it goes on.
class RunViewTest : public RunTest {
 protected:
  RunViewTest() { WriteRoom(); }

  std::vector<std::string> Arguments(const std::string& out) const {
    return {"run", Input(),     "--out", folder_ / out, "--threads",
            "2",   "--weights", "none",  "--view=0"};
  }

  /// Waits for the address of a run and returns its port.
  static int PortOf(Program* run) {
    EXPECT_TRUE(run->WaitForOutput("/\n"));
    const std::string out = run->Output();
    const std::string before = "this run is at http://127.0.0.1:";
    const size_t at = out.find(before);
    return at == std::string::npos ? 0 : std::atoi(out.c_str() + at + before.size());
  }

  static int Post(int port, const std::string& path) {
    std::string more("Content-Length: 0\r\nOrigin: http://localhost:");
    more += std::to_string(port);
    more += "\r\n";
    std::string request = GetRequest(port, path, more);
    request.replace(0, 3, "POST");
    return StatusOf(Exchange(port, request));
  }

  /// The state of a run that is paused, as soon as it has come to a stop.
  static nlohmann::json StateWhenWaiting(int port) {
    nlohmann::json json;
    for (int i = 0; i < 6000; ++i) {
      json = nlohmann::json::parse(BodyOf(Exchange(port, GetRequest(port, "/live.json"))), nullptr,
                                   false);
      if (json.is_object() && json["isWaiting"] == true) return json;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << "the run does not wait: " << json;
    return json;
  }
};

TEST_F(RunViewTest, HasTheSameResultWhileItIsLookedAt) {
  // With the dense cloud, which a page shows as it grows.
  WriteMeanNetwork(folder_ / "net.h5");
  // A point must be seen by three keyframes; the room is small and the way short.
  WriteText(folder_ / "dense.yaml", "keyframe:\n  max_motion: 0.02\n");
  std::vector<std::string> dense = {"--weights", folder_ / "net.h5", "--config",
                                    folder_ / "dense.yaml"};
  const ProgramResult unseen = Run(dense);
  EXPECT_EQ(unseen.status, 0) << unseen.err;
  EXPECT_THAT(unseen.out, testing::Not(HasSubstr("http"))) << "nobody asked for a page";
  dense.insert(dense.end(), {"--out", folder_ / "shown", "--threads", "2", "--view=0"});
  dense.insert(dense.begin(), {"run", Input()});
  Program shown(dense);
  const int port = PortOf(&shown);
  std::atomic<bool> has_ended = false;
  std::atomic<int> num_seen = 0;
  std::atomic<size_t> num_dense_bytes = 0;
  std::thread page([&] {
    while (!has_ended) {
      for (const char* path : {"/live.json?since=1", "/live.points", "/live.image"}) {
        num_seen += StatusOf(Exchange(port, GetRequest(port, path))) == 200 ? 1 : 0;
      }
      const size_t size = BodyOf(Exchange(port, GetRequest(port, "/live.cloud?since=0"))).size();
      num_dense_bytes = std::max<size_t>(num_dense_bytes, size);
    }
  });
  const ProgramResult result = shown.Wait();
  has_ended = true;
  page.join();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_GT(num_seen, 3);
  EXPECT_GT(num_dense_bytes, 16 * 1000U) << "no depth of a view was shown";
  for (const char* name :
       {"trajectory.txt", "keyframes.txt", "cloud.ply", "cloud.octree", "reconstruction.h5"}) {
    EXPECT_EQ(ReadText(folder_ / ("shown/" + std::string(name))), ReadText(OutFile(name))) << name;
  }
}

TEST_F(RunViewTest, IsPausedStepsAndEndsEarly) {
  Program run(Arguments("out"));
  const int port = PortOf(&run);
  EXPECT_EQ(Post(port, "/pause"), 200);
  StateWhenWaiting(port);  // A frame may have been under way.
  EXPECT_EQ(Post(port, "/step"), 200);
  const int first = StateWhenWaiting(port)["frame"];
  const int last = std::max(first + 3, 14);
  ASSERT_LT(last, kFrames);
  for (int frame = first + 1; frame <= last; ++frame) {
    EXPECT_EQ(Post(port, "/step"), 200);
    const nlohmann::json state = StateWhenWaiting(port);
    EXPECT_EQ(state["frame"], frame);
    EXPECT_EQ(state["isPaused"], true);
  }
  EXPECT_EQ(Post(port, "/finish"), 200);
  const ProgramResult result = run.Wait();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(Summary()["frames"], last + 1);
  EXPECT_EQ(Summary()["warnings"][0], "ended early from the viewer");
}

TEST_F(RunViewTest, SaysThatAPortIsTakenBeforeAnyWork) {
  Program first(Arguments("first"));
  const int port = PortOf(&first);
  Post(port, "/pause");
  EXPECT_THAT(Refusal({"--view=" + std::to_string(port)}),
              AllOf(HasSubstr("is taken"), HasSubstr("--view=N")));
  EXPECT_EQ(Post(port, "/resume"), 200);
  EXPECT_EQ(first.Wait().status, 0);
}

}  // namespace
}  // namespace orb360
