#include "slam/viewer/request_check.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>

#include <arpa/inet.h>
#include <openssl/rand.h>
#include <unistd.h>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr int kHttpPort = 80;  // browsers leave it out

std::string LowerCase(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// 128 random bits in hexadecimal digits.
std::string RandomToken() {
  std::array<unsigned char, 16> bytes{};
  if (RAND_bytes(bytes.data(), bytes.size()) != 1) {
    throw UserError(
        "this machine gives no random numbers for the address of the viewer; leave out "
        "--view-address");
  }
  std::string token;
  for (const unsigned char byte : bytes) {
    token += "0123456789abcdef"[byte >> 4];
    token += "0123456789abcdef"[byte & 15];
  }
  return token;
}

/// Compares all characters in any case, so that the time does not tell how many are right.
bool IsSame(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned char difference = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    difference = static_cast<unsigned char>(difference | (a[i] ^ b[i]));
  }
  return difference == 0;
}

std::vector<std::string> NamesOfThisMachine() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0) return {};
  const std::string host = LowerCase(name.data());
  return {host, host + ".local"};
}

/// Whether a text is an address in the numbers of a family, AF_INET or AF_INET6.
bool IsNumericAddress(int family, std::string_view text) {
  std::array<char, 64> buffer{};
  if (text.size() >= buffer.size()) return false;
  std::ranges::copy(text, buffer.begin());
  std::array<unsigned char, 16> bytes{};
  return inet_pton(family, buffer.data(), bytes.data()) == 1;
}

/// Whether a Host header is an address in numbers: such a name cannot be pointed elsewhere.
bool IsNumericHost(const std::string& host, int port) {
  std::string_view address = host;
  std::string suffix(1, ':');
  suffix += std::to_string(port);
  if (address.ends_with(suffix)) {
    address.remove_suffix(suffix.size());
  } else if (port != kHttpPort) {
    return false;
  }
  if (address.starts_with('[') && address.ends_with(']')) {
    return IsNumericAddress(AF_INET6, address.substr(1, address.size() - 2));
  }
  return IsNumericAddress(AF_INET, address);
}

}  // namespace

bool IsLoopback(const std::string& address) {
  return address == "localhost" || address == "::1" || address.starts_with("127.");
}

std::string HostAndPort(const std::string& address, int port) {
  const bool is_ipv6 = address.find(':') != std::string::npos;
  return (is_ipv6 ? "[" + address + "]" : address) + ":" + std::to_string(port);
}

AccessRules MakeAccessRules(const std::string& address, int port) {
  std::vector<std::string> names = {"localhost", "127.0.0.1", "::1", LowerCase(address)};
  AccessRules rules;
  rules.port = port;
  if (!IsLoopback(address)) {
    rules.token = RandomToken();
    for (std::string& name : NamesOfThisMachine()) names.push_back(std::move(name));
  }
  for (const std::string& name : names) {
    const std::string host = HostAndPort(name, port);
    rules.hosts.push_back(host);
    if (port == kHttpPort) rules.hosts.push_back(host.substr(0, host.rfind(':')));
  }
  return rules;
}

Admission CheckRequest(const RequestHead& head, const AccessRules& rules) {
  if (!head.is_get && !head.is_post) return {405, ""};
  if (!head.content_length.empty() && head.content_length != "0") return {413, ""};
  const std::string host = LowerCase(head.host);
  const bool is_numeric = !rules.token.empty() && IsNumericHost(host, rules.port);
  if (!is_numeric && std::ranges::find(rules.hosts, host) == rules.hosts.end()) return {421, ""};
  if (!head.origin.empty() && LowerCase(head.origin) != "http://" + host) return {403, ""};
  // Browsers state the origin of every POST.
  if (head.is_post && head.origin.empty()) return {403, ""};
  std::string_view path = head.path;
  if (!path.starts_with('/')) return {400, ""};
  path.remove_prefix(1);
  if (!rules.token.empty()) {
    const size_t slash = path.find('/');
    if (slash == std::string_view::npos || !IsSame(path.substr(0, slash), rules.token)) {
      return {403, ""};
    }
    path.remove_prefix(slash + 1);
  }
  const bool is_from_here =
      head.fetch_site.empty() || head.fetch_site == "same-origin" || head.fetch_site == "none";
  if (!is_from_here && !path.empty()) return {403, ""};
  return {200, std::string(path)};
}

}  // namespace orb360
