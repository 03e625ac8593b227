// libFuzzer's target for what decides about a request to the viewer: the address that a server
// listens at, the rules that follow from it, the head of a request, its query and its range of
// bytes. Whatever the bytes, a request that is admitted names its path, the token and the host, and
// a range lies within the resource.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include <netinet/in.h>

#include "slam/viewer/byte_range.h"
#include "slam/viewer/listen_address.h"
#include "slam/viewer/request_check.h"
#include "slam/viewer/response_body.h"
#include "slam/viewer/since_query.h"

namespace orb360 {
namespace {

void Require(bool holds) {
  if (!holds) std::abort();
}

/// Fields of an input, which ends each with a newline.
class Fields {
 public:
  explicit Fields(std::string_view bytes) : left_(bytes) {}
  std::string Next() {
    const size_t end = std::min(left_.find('\n'), left_.size());
    const std::string field(left_.substr(0, end));
    left_.remove_prefix(std::min(end + 1, left_.size()));
    return field;
  }

 private:
  std::string_view left_;
};

/// Whether only this machine reaches an address, by its numbers.
bool IsOfThisMachine(const SocketAddress& address) {
  if (address.storage.ss_family == AF_INET) {
    const auto& ipv4 = reinterpret_cast<const sockaddr_in&>(address.storage);
    return ntohl(ipv4.sin_addr.s_addr) >> 24 == 127;
  }
  const auto& ipv6 = reinterpret_cast<const sockaddr_in6&>(address.storage);
  return IN6_IS_ADDR_LOOPBACK(&ipv6.sin6_addr);
}

/// The rules of a server at an address; without a token only this machine may reach it.
AccessRules CheckAddress(const std::string& address) {
  constexpr int kPort = 8360;
  const std::optional<SocketAddress> parsed = ParseAddress(address, kPort);
  if (!parsed) return MakeAccessRules("127.0.0.1", kPort);
  AccessRules rules = MakeAccessRules(address, kPort);
  Require(!rules.token.empty() || IsOfThisMachine(*parsed));
  return rules;
}

void CheckHead(const RequestHead& head, const AccessRules& rules) {
  const Admission admission = CheckRequest(head, rules);
  if (admission.status != 200) {
    Require(admission.resource.empty());
    return;
  }
  Require(head.is_get || (head.is_post && !head.origin.empty()));
  std::string path = "/";
  if (!rules.token.empty()) path += rules.token + "/";
  Require(head.path == path + admission.resource);
  // A name that can be pointed elsewhere is none of its hosts.
  Require(head.host.find("evil") == std::string::npos);
  Require(head.origin.empty() || head.origin.size() == head.host.size() + 7);
}

void CheckResponse(const ResourceRequest& request) {
  static const ResourceTable table = [] {
    ResourceTable resources;
    resources[""] = {"text/html", {}, [] { return std::string("page"); }};
    resources["act"] = {"text/plain", {}, [] { return std::string("done"); }, true};
    resources["live.json"] = {"application/json", {}, {}, false, [](std::uint64_t since) {
                                return std::to_string(since);
                              }};
    return resources;
  }();
  const Response response = MakeResponse(table, request);
  Require(response.body.has_value());
  Require((response.status == 404) != table.contains(request.path));
}

void CheckRange(const std::string& header, std::uint64_t size) {
  const std::optional<ByteRange> range = ParseByteRange(header, size);
  if (range) Require(range->begin < range->end && range->end <= size);
}

void Check(std::string_view bytes) {
  if (bytes.empty()) return;
  const auto flags = static_cast<unsigned char>(bytes.front());
  Fields fields(bytes.substr(1));
  AccessRules rules = CheckAddress(fields.Next());
  if (!rules.token.empty()) rules.token = "token";  // that an input can have
  RequestHead head;
  head.is_get = (flags & 1) != 0;
  head.is_post = (flags & 2) != 0;
  head.path = fields.Next();
  head.host = fields.Next();
  head.origin = fields.Next();
  head.fetch_site = fields.Next();
  head.content_length = fields.Next();
  CheckHead(head, rules);
  const std::string query = fields.Next();
  const std::optional<std::uint64_t> since = ParseSince(query);
  if (since && !query.empty()) Require(query.size() >= std::to_string(*since).size() + 6);
  const std::string range = fields.Next();
  const std::string_view path = std::string_view(head.path).substr(head.path.empty() ? 0 : 1);
  CheckResponse({path, query, range, head.is_post});
  for (const std::uint64_t size : {std::uint64_t{0}, std::uint64_t{flags}, ~std::uint64_t{0}}) {
    CheckRange(range, size);
  }
}

}  // namespace
}  // namespace orb360

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  orb360::Check({reinterpret_cast<const char*>(data), size});
  return 0;
}
