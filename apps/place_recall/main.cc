// Measures place recognition on sequences with ground truth, for developers: how many of the places
// that the camera comes back to are recognised before the first wrong one (recall at a precision of
// 100 %), apart for the same and the opposite direction, and how long a query takes.
//
// Sequences are separate places of one index. With --vocabulary, a tree of words trained on other
// sequences is measured in the same way.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apps/place_recall/binary_vocabulary.h"
#include "slam/features/orb_extractor.h"
#include "slam/features/place_recognition.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/trajectory.h>

namespace orb360 {
namespace {

struct View {
  int sequence;
  double travelled;  // m, along the sequence
  Rigid3 pose;
  std::vector<Descriptor> descriptors;
};

double Apart(const View& a, const View& b) {
  return a.sequence == b.sequence ? (a.pose.translation - b.pose.translation).norm() : 1e9;
}

/// A frame for each metre travelled.
void ReadViews(const std::filesystem::path& folder, int sequence, std::vector<View>* views) {
  constexpr double kSpacing = 1.0;  // m
  OrbExtractor extractor{OrbOptions{}};
  double travelled = 0;
  double next = 0;
  const std::vector<StampedPose> poses = ReadTrajectory(folder / "groundtruth.txt");
  for (size_t i = 0; i < poses.size(); ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "%06zu.jpg", i);
    const Rigid3& pose = poses[i].world_from_camera;
    if (i > 0) travelled += (pose.translation - poses[i - 1].world_from_camera.translation).norm();
    if (travelled < next || !std::filesystem::exists(folder / "rgb" / name)) continue;
    next = travelled + kSpacing;
    const cv::Mat gray = cv::imread((folder / "rgb" / name).string(), cv::IMREAD_GRAYSCALE);
    views->push_back({sequence, travelled, pose, extractor.Extract(gray).descriptors});
  }
}

/// What a query found, where the camera was near a place seen long before, or not.
struct Query {
  double score;
  bool is_right;
  int kind;  // 0: a new place, 1: an old one in the same direction, 2: the opposite, 3: across
};

void Report(const std::vector<Query>& queries) {
  double worst = 0;  // the best score of what is wrong
  for (const Query& q : queries) {
    if (!q.is_right) worst = std::max(worst, q.score);
  }
  const char* const kNames[] = {"", "same direction", "opposite direction", "across"};
  for (int kind = 1; kind <= 3; ++kind) {
    int total = 0, first = 0, recalled = 0;
    for (const Query& q : queries) {
      if (q.kind != kind) continue;
      ++total;
      first += q.is_right;
      recalled += q.is_right && q.score > worst;
    }
    std::printf("%-20s %5d views  best candidate right %5.1f %%  recall at precision 1: %5.1f %%\n",
                kNames[kind], total, 100.0 * first / std::max(1, total),
                100.0 * recalled / std::max(1, total));
  }
}

std::vector<View> ReadSequences(const std::vector<std::string>& folders) {
  std::vector<View> views;
  for (size_t s = 0; s < folders.size(); ++s) {
    const size_t before = views.size();
    ReadViews(folders[s], static_cast<int>(s), &views);
    if (views.size() == before) throw UserError(folders[s] + ": has no images rgb/000000.jpg ...");
  }
  return views;
}

/// `Index` learns places and scores them, as PlaceIndex does.
template <typename Index>
void Measure(const std::vector<View>& views, Index index) {
  constexpr double kNear = 5.0;     // m: the place is the same
  constexpr double kAway = 10.0;    // m: the place is another one
  constexpr double kBefore = 50.0;  // m of travel: the place was left
  std::vector<Query> queries;
  double seconds = 0;
  for (const View& view : views) {
    const std::clock_t start = std::clock();
    const std::vector<double> scores = index.Score(view.descriptors);
    seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    int best = -1;
    int nearest = -1;
    double best_score = 0;
    for (int i = 0; i < index.size(); ++i) {
      const View& other = views[i];
      if (other.sequence == view.sequence && view.travelled - other.travelled < kBefore) continue;
      const bool is_near = Apart(view, other) < kNear;
      if (is_near && (nearest < 0 || Apart(view, other) < Apart(view, views[nearest]))) nearest = i;
      double sum = 0;  // with the views before and after it
      int count = 0;
      for (int j = std::max(0, i - 1); j <= std::min(index.size() - 1, i + 1); ++j) {
        if (views[j].sequence != other.sequence) continue;
        if (other.sequence == view.sequence && view.travelled - views[j].travelled < kBefore) {
          continue;
        }
        sum += scores[j];
        ++count;
      }
      sum /= count;
      if (sum > best_score) {
        best_score = sum;
        best = i;
      }
    }
    // In units of how alike the view before is.
    const bool follows = index.size() > 0 && views[index.size() - 1].sequence == view.sequence;
    if (best >= 0 && follows) {
      int kind = 0;
      if (nearest >= 0) {
        const Eigen::Vector3d forward(-1, 0, 0);
        const double cosine =
            (view.pose.rotation * forward).dot(views[nearest].pose.rotation * forward);
        kind = cosine > 0.5 ? 1 : cosine < -0.5 ? 2 : 3;
      }
      queries.push_back({best_score / scores.back(), Apart(view, views[best]) < kAway, kind});
    }
    index.Add(view.descriptors);
  }
  Report(queries);
  std::printf("%zu views, %.2f ms a query\n", views.size(), 1e3 * seconds / views.size());
}

// As large as a file of 4 MB could be: 10^5 words of 32 bytes, and the nodes above them.
constexpr int kBranches = 10;
constexpr int kDepth = 5;

void MeasureVocabulary(const std::vector<View>& views, const std::vector<std::string>& training) {
  std::vector<std::vector<Descriptor>> trained_on;
  for (View& view : ReadSequences(training)) trained_on.push_back(std::move(view.descriptors));
  const BinaryVocabulary vocabulary(trained_on, kBranches, kDepth);
  std::printf("\na vocabulary of %d words, trained on %zu views\n", vocabulary.num_words(),
              trained_on.size());
  Measure(views, VocabularyIndex(&vocabulary));
}

}  // namespace
}  // namespace orb360

int main(int argc, char** argv) {
  try {
    CLI::App app("Measures how well places are recognised on sequences with ground truth.");
    std::vector<std::string> sequences;
    std::vector<std::string> training;
    app.add_option("sequences", sequences, "Folders of sequences")->required();
    app.add_option("--vocabulary", training, "Other sequences, to train a vocabulary on");
    CLI11_PARSE(app, argc, argv);
    const std::vector<orb360::View> views = orb360::ReadSequences(sequences);
    orb360::Measure(views, orb360::PlaceIndex());
    if (!training.empty()) orb360::MeasureVocabulary(views, training);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::cerr << "place_recall: " << error.what() << '\n';
    return EXIT_FAILURE;
  }
}
