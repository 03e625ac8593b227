#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slam/viewer/byte_range.h"
#include "slam/viewer/resource.h"

namespace orb360 {

/// What is left to send of a response: bytes in memory, or a part of a file, which is read piece by
/// piece.
class ResponseBody {
 public:
  explicit ResponseBody(std::string bytes) : bytes_(std::move(bytes)), left_(bytes_.size()) {}
  /// `range` lies within the file.
  ResponseBody(const std::filesystem::path& file, const ByteRange& range);

  std::uint64_t left() const { return left_; }
  /// Copies the next bytes to `out`. Returns how many: 0 at the end, none where the file has become
  /// shorter or cannot be read.
  std::optional<size_t> Read(std::span<char> out);

 private:
  std::string bytes_;
  std::ifstream file_;
  std::uint64_t left_ = 0;
};

/// Status, headers and body of a response.
struct Response {
  int status = 404;
  std::string type = "text/plain; charset=utf-8";
  std::string content_range;  ///< Empty: none.
  std::optional<ResponseBody> body;
};

/// What a request asks for.
struct ResourceRequest {
  std::string_view path = {};  ///< Key of the table.
  std::string_view query =
      {};  ///< Without its question mark; looked at for Resource::make_since only.
  std::string_view range = {};  ///< Header Range, empty where there is none.
  bool is_post = false;         ///< POST, not GET or HEAD.
};

/// Answers a request from the table: 404 where that has no such path, 405 where the method does not
/// fit Resource::is_action, 400 for a query that ParseSince does not read, 416 for a range that
/// ParseByteRange does not read. What fails gives the status 500 with the reason as its text.
Response MakeResponse(const ResourceTable& resources, const ResourceRequest& request);

/// A response that is one line of text.
Response TextResponse(int status, std::string_view text);

}  // namespace orb360
