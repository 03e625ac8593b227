#include "slam/io/octree/point_sorter.h"

#include <algorithm>
#include <fstream>
#include <queue>
#include <string>
#include <tuple>
#include <utility>

#include "slam/io/output_file.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Points read at once from each file.
constexpr size_t kBuffer = 4096;

bool Precedes(const SortedPoint& a, const SortedPoint& b) {
  return std::tie(a.code, a.index) < std::tie(b.code, b.index);
}

/// The points of a file in their order.
class PieceReader {
 public:
  PieceReader(std::filesystem::path path, std::uint64_t count)
      : path_(std::move(path)), file_(path_, std::ios::binary), left_(count) {}

  std::optional<SortedPoint> Next() {
    if (at_ == buffer_.size() && !Fill()) return std::nullopt;
    return buffer_[at_++];
  }

 private:
  bool Fill() {
    buffer_.resize(std::min<std::uint64_t>(left_, kBuffer));
    at_ = 0;
    left_ -= buffer_.size();
    file_.read(reinterpret_cast<char*>(buffer_.data()),
               static_cast<std::streamsize>(buffer_.size() * sizeof(SortedPoint)));
    if (!file_) {
      throw UserError(path_.string() +
                      ": is damaged or gone; keep the folder as it is until the octree is made");
    }
    return !buffer_.empty();
  }

  const std::filesystem::path path_;
  std::ifstream file_;
  std::uint64_t left_;
  std::vector<SortedPoint> buffer_;
  size_t at_ = 0;
};

}  // namespace

PointSorter::PointSorter(std::filesystem::path folder, size_t max_in_memory)
    : path_(std::move(folder)), max_in_memory_(max_in_memory) {
  ORB360_CHECK(max_in_memory > 0);
  points_.reserve(
      max_in_memory);  // Growing would need twice the memory; what is unused costs none.
}

std::filesystem::path PointSorter::PathOf(size_t piece) const {
  return path_ / std::to_string(piece);
}

void PointSorter::Add(const SortedPoint& point) {
  points_.push_back(point);
  if (points_.size() == max_in_memory_) WritePiece();
}

void PointSorter::WritePiece() {
  if (!folder_) folder_.emplace(path_);
  std::ranges::sort(points_, Precedes);
  OutputFile file(PathOf(pieces_.size()));
  file.Write({reinterpret_cast<const char*>(points_.data()), points_.size() * sizeof(SortedPoint)});
  pieces_.push_back(points_.size());
  points_.clear();
}

void PointSorter::Merge(const std::function<void(const SortedPoint&)>& take) {
  if (pieces_.empty()) {
    std::ranges::sort(points_, Precedes);
    std::ranges::for_each(points_, take);
    return;
  }
  if (!points_.empty()) WritePiece();
  points_.shrink_to_fit();
  std::vector<PieceReader> readers;
  readers.reserve(pieces_.size());
  using Head = std::pair<SortedPoint, size_t>;
  const auto is_later = [](const Head& a, const Head& b) { return Precedes(b.first, a.first); };
  std::priority_queue<Head, std::vector<Head>, decltype(is_later)> heads(is_later);
  const auto push_next = [&](size_t piece) {
    if (const std::optional<SortedPoint> point = readers[piece].Next())
      heads.emplace(*point, piece);
  };
  for (size_t piece = 0; piece < pieces_.size(); ++piece) {
    readers.emplace_back(PathOf(piece), pieces_[piece]);
    push_next(piece);
  }
  while (!heads.empty()) {
    const auto [point, piece] = heads.top();
    heads.pop();
    take(point);
    push_next(piece);
  }
}

}  // namespace orb360
