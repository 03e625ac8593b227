#include "apps/place_recall/binary_vocabulary.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <set>
#include <utility>

#include "slam/features/hamming.h"

namespace orb360 {
namespace {

int NearestOf(const Descriptor& descriptor, std::span<const Descriptor> centers) {
  std::vector<uint16_t> distances(centers.size());
  HammingDistances(descriptor, centers, distances);
  return static_cast<int>(std::ranges::min_element(distances) - distances.begin());
}

// Each bit is the one that most members have.
Descriptor MeanOf(std::span<const Descriptor> members) {
  std::vector<size_t> ones(256, 0);
  for (const Descriptor& member : members) {
    for (size_t bit = 0; bit < ones.size(); ++bit)
      ones[bit] += (member[bit / 64] >> (bit % 64)) & 1;
  }
  Descriptor mean{};
  for (size_t bit = 0; bit < ones.size(); ++bit) {
    if (2 * ones[bit] > members.size()) mean[bit / 64] |= uint64_t{1} << (bit % 64);
  }
  return mean;
}

struct Groups {
  std::vector<Descriptor> centers;
  std::vector<std::vector<Descriptor>> members;
};

Groups Divide(std::span<const Descriptor> members, int count) {
  constexpr int kIterations = 10;
  std::mt19937_64 random(members.size());
  Groups groups;
  std::ranges::sample(members, std::back_inserter(groups.centers), count, random);
  for (int i = 0; i < kIterations; ++i) {
    groups.members.assign(groups.centers.size(), {});
    for (const Descriptor& member : members) {
      groups.members[NearestOf(member, groups.centers)].push_back(member);
    }
    for (size_t g = 0; g < groups.centers.size(); ++g) {
      if (!groups.members[g].empty()) groups.centers[g] = MeanOf(groups.members[g]);
    }
  }
  return groups;
}

}  // namespace

BinaryVocabulary::BinaryVocabulary(std::span<const std::vector<Descriptor>> views, int branches,
                                   int depth) {
  std::vector<Descriptor> all;
  for (const std::vector<Descriptor>& view : views) all.insert(all.end(), view.begin(), view.end());
  nodes_.emplace_back();
  Split(0, std::move(all), branches, depth);

  std::vector<int> shown(weights_.size(), 0);
  for (const std::vector<Descriptor>& view : views) {
    std::set<int> words;
    for (const Descriptor& descriptor : view) words.insert(WordOf(descriptor));
    for (const int word : words) ++shown[word];
  }
  for (size_t w = 0; w < weights_.size(); ++w) {
    weights_[w] = std::log(static_cast<double>(views.size()) / std::max(1, shown[w]));
  }
}

void BinaryVocabulary::Split(int node, std::vector<Descriptor> members, int branches, int depth) {
  if (depth == 0 || static_cast<int>(members.size()) <= branches) {
    nodes_[node].word = num_words();
    weights_.push_back(0);
    return;
  }
  Groups groups = Divide(members, branches);
  members = {};
  const int first = static_cast<int>(nodes_.size());
  nodes_[node].first_child = first;
  nodes_[node].num_children = static_cast<int>(groups.centers.size());
  for (const Descriptor& center : groups.centers) nodes_.push_back({.center = center});
  for (size_t g = 0; g < groups.members.size(); ++g) {
    Split(first + static_cast<int>(g), std::move(groups.members[g]), branches, depth - 1);
  }
}

int BinaryVocabulary::WordOf(const Descriptor& descriptor) const {
  int node = 0;
  while (nodes_[node].word < 0) {
    int best = -1;
    int best_distance = NearestTwo::kNone;
    for (int c = 0; c < nodes_[node].num_children; ++c) {
      const int child = nodes_[node].first_child + c;
      const int distance = HammingDistance(descriptor, nodes_[child].center);
      if (distance < best_distance) {
        best_distance = distance;
        best = child;
      }
    }
    node = best;
  }
  return nodes_[node].word;
}

VocabularyIndex::VocabularyIndex(const BinaryVocabulary* vocabulary)
    : vocabulary_(vocabulary), shown_by_(vocabulary->num_words()) {}

std::map<int, double> VocabularyIndex::WordsOf(std::span<const Descriptor> descriptors) const {
  std::map<int, double> words;
  double sum = 0;
  for (const Descriptor& descriptor : descriptors) {
    const int word = vocabulary_->WordOf(descriptor);
    words[word] += vocabulary_->weight(word);
    sum += vocabulary_->weight(word);
  }
  for (auto& [word, weight] : words) weight /= std::max(sum, 1e-12);
  return words;
}

int VocabularyIndex::Add(std::span<const Descriptor> descriptors) {
  for (const auto& [word, weight] : WordsOf(descriptors)) {
    shown_by_[word].push_back({num_places_, weight});
  }
  return num_places_++;
}

std::vector<double> VocabularyIndex::Score(std::span<const Descriptor> descriptors) const {
  std::vector<double> scores(num_places_, 0.0);
  for (const auto& [word, weight] : WordsOf(descriptors)) {
    for (const Entry& entry : shown_by_[word])
      scores[entry.place] += std::min(weight, entry.weight);
  }
  return scores;
}

}  // namespace orb360
