#include "slam/viewer/response_body.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <filesystem>
#include <span>
#include <system_error>
#include <utility>

#include "slam/viewer/since_query.h"

namespace orb360 {

ResponseBody::ResponseBody(const std::filesystem::path& file, const ByteRange& range)
    : file_(file, std::ios::binary), left_(range.end - range.begin) {
  file_.seekg(static_cast<std::streamoff>(range.begin));
}

std::optional<size_t> ResponseBody::Read(std::span<char> out) {
  const auto count = static_cast<size_t>(std::min<std::uint64_t>(left_, out.size()));
  if (file_.is_open()) {
    if (!file_.read(out.data(), static_cast<std::streamsize>(count))) return std::nullopt;
  } else {
    if (left_ > bytes_.size()) return std::nullopt;  // a file that could not be opened
    std::memcpy(out.data(), bytes_.data() + (bytes_.size() - left_), count);
  }
  left_ -= count;
  return count;
}

Response TextResponse(int status, std::string_view text) {
  Response response;
  response.status = status;
  response.body.emplace(std::string(text) + "\n");
  return response;
}

Response MakeResponse(const ResourceTable& resources, const ResourceRequest& request) {
  const auto found = resources.find(request.path);
  if (found == resources.end()) return TextResponse(404, "there is nothing at this address");
  const Resource& resource = found->second;
  if (resource.is_action != request.is_post) return TextResponse(405, "not with this method");
  Response response;
  response.status = 200;
  response.type = resource.type;
  try {
    if (resource.make_since) {
      const std::optional<std::uint64_t> since = ParseSince(request.query);
      if (!since) return TextResponse(400, "no such query");
      response.body.emplace(resource.make_since(*since));
      return response;
    }
    if (resource.file.empty()) {
      response.body.emplace(resource.make());
      return response;
    }
    std::error_code error;
    const std::uint64_t size = std::filesystem::file_size(resource.file, error);
    if (error) return TextResponse(500, resource.file.string() + ": " + error.message());
    ByteRange range{0, size};
    if (!request.range.empty()) {
      const std::optional<ByteRange> wanted = ParseByteRange(request.range, size);
      if (!wanted) {
        response = TextResponse(416, "no such range of bytes");
        response.content_range = "bytes */" + std::to_string(size);
        return response;
      }
      range = *wanted;
      response.status = 206;
      response.content_range = "bytes " + std::to_string(range.begin) + "-" +
                               std::to_string(range.end - 1) + "/" + std::to_string(size);
    }
    response.body.emplace(resource.file, range);
    return response;
  } catch (const std::exception& failure) {
    return TextResponse(500, failure.what());
  }
}

}  // namespace orb360
