#pragma once

#include <map>
#include <span>
#include <vector>

#include <orb360/slam/features/features.h>

namespace orb360 {

/// A tree of visual words over binary descriptors, trained on other images (Galvez-Lopez, Tardos,
/// Bags of Binary Words for Fast Place Recognition in Image Sequences, T-RO 2012): what ORB-SLAM
/// recognises places by, here to be measured against.
class BinaryVocabulary {
 public:
  /// Divides the descriptors of all views into `branches` groups around binary means, those again,
  /// `depth` times, and weighs each word by the logarithm of all views over those that show it.
  BinaryVocabulary(std::span<const std::vector<Descriptor>> views, int branches, int depth);

  int num_words() const { return static_cast<int>(weights_.size()); }
  int WordOf(const Descriptor& descriptor) const;
  double weight(int word) const { return weights_[word]; }

 private:
  struct Node {
    Descriptor center{};
    int first_child = -1;
    int num_children = 0;
    int word = -1;  // of a leaf
  };

  void Split(int node, std::vector<Descriptor> members, int branches, int depth);

  std::vector<Node> nodes_;
  std::vector<double> weights_;
};

/// Places by the words that they show: an inverted file. The similarity of two places is the L1
/// score of their weighted words.
class VocabularyIndex {
 public:
  /// `vocabulary` must outlive this.
  explicit VocabularyIndex(const BinaryVocabulary* vocabulary);

  int Add(std::span<const Descriptor> descriptors);
  int size() const { return num_places_; }
  std::vector<double> Score(std::span<const Descriptor> descriptors) const;

 private:
  struct Entry {
    int place;
    double weight;
  };

  /// By word, their sum being 1.
  std::map<int, double> WordsOf(std::span<const Descriptor> descriptors) const;

  const BinaryVocabulary* const vocabulary_;
  std::vector<std::vector<Entry>> shown_by_;  // by word
  int num_places_ = 0;
};

}  // namespace orb360
