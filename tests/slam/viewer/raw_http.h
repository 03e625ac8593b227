#pragma once

#include <string>

namespace orb360 {

/// A connection to a port of this machine, over which anything can be sent.
class RawConnection {
 public:
  explicit RawConnection(int port);
  ~RawConnection();
  RawConnection(const RawConnection&) = delete;
  RawConnection& operator=(const RawConnection&) = delete;

  bool is_open() const { return descriptor_ >= 0; }
  /// False where the other side has closed.
  bool Send(const std::string& bytes) const;
  /// What comes until the other side closes, or nothing has come for `milliseconds`.
  std::string ReceiveAll(int milliseconds) const;
  /// The same for one response with Content-Length; `is_head`: it has no body.
  std::string ReceiveResponse(bool is_head = false) const;

 private:
  int descriptor_ = -1;
};

/// Sends bytes on a connection of their own and returns the response.
std::string Exchange(int port, const std::string& request);

/// A GET request of a path with the Host of a server on this machine; `more` are further header
/// lines, each with its line end.
std::string GetRequest(int port, const std::string& path, const std::string& more = "");

/// The status of a response; 0 where there is none.
int StatusOf(const std::string& response);
std::string BodyOf(const std::string& response);

}  // namespace orb360
