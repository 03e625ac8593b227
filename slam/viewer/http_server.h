#pragma once

#include <memory>
#include <string>

#include "slam/viewer/resource.h"

namespace orb360 {

/// Where a server listens.
struct HttpAddress {
  std::string address = "127.0.0.1";  ///< Numeric, or localhost.
  int port = 0;                       ///< 0: any that is free.
  /// What chooses the port, for messages: `--port N` or `--view=N`.
  std::string port_option = "--port N";
};

/// An HTTP server of a table of resources, on a thread of its own for as long as the object lives.
///
/// It answers GET and HEAD, and ranges of bytes of files; POST for resources that are actions. It
/// is made for one page and the browsers
/// of few people: requests are checked (CheckRequest), headers are at most 4 KB and have to come
/// within 5 seconds, a connection without a request is closed after 60, 64 are open at once, and a
/// connection holds one piece of a file at a time. A page may only load from this server
/// (Content-Security-Policy). libwebsockets, on which it stands, makes the process ignore SIGPIPE.
class HttpServer {
 public:
  /// Starts to listen. Throws UserError where the port is taken or the address is not one of this
  /// machine.
  HttpServer(ResourceTable resources, const HttpAddress& address);
  /// Closes all connections and ends the thread.
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  int port() const;
  /// The address for a browser, with the token where one is needed.
  std::string url() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace orb360
