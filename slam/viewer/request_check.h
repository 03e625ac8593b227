#pragma once

#include <string>
#include <vector>

namespace orb360 {

/// What decides about a request. Headers are empty where they are missing.
struct RequestHead {
  bool is_get = false;         ///< GET or HEAD.
  bool is_post = false;        ///< POST.
  std::string path;            ///< Decoded, with a leading slash, without a query.
  std::string host;            ///< Header Host.
  std::string origin;          ///< Header Origin.
  std::string fetch_site;      ///< Header Sec-Fetch-Site.
  std::string content_length;  ///< Header Content-Length.
};

/// Whom a server answers.
struct AccessRules {
  /// Values of Host under which a browser may reach the server, lower case. A page of another name
  /// that resolves to this machine (DNS rebinding) sends its own.
  std::vector<std::string> hosts;
  int port = 0;  ///< With a token, any address in numbers with this port is a host as well.
  /// First part of every path; empty: none is needed.
  std::string token;
};

/// The rules of a server at an address and port. Beyond loopback they have a random token, and the
/// name of this machine is a host besides.
AccessRules MakeAccessRules(const std::string& address, int port);

/// Whether only this machine reaches an address: 127.0.0.0/8, ::1 or localhost.
bool IsLoopback(const std::string& address);

/// `ADDRESS:PORT` as it stands in an URL, an IPv6 address in brackets.
std::string HostAndPort(const std::string& address, int port);

/// The decision about a request.
struct Admission {
  int status = 403;      ///< 200: the table of resources decides.
  std::string resource;  ///< Path without the token and the leading slash.
};

/// Refuses what is not GET, HEAD or POST (405), has a body (413), a Host that is none of the rules
/// (421), an Origin other than that host (403), a POST without one (403), lacks the token (403), or
/// comes from another site (403). The page itself has no data, so links of other sites may lead to
/// it.
Admission CheckRequest(const RequestHead& head, const AccessRules& rules);

}  // namespace orb360
