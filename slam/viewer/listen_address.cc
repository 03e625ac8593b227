#include "slam/viewer/listen_address.h"

#include <cerrno>
#include <cstring>
#include <memory>

#include <netdb.h>
#include <unistd.h>

#include <orb360/nn/base/check.h>

namespace orb360 {

std::optional<SocketAddress> ParseAddress(const std::string& address, int port) {
  if (address.find('\0') != std::string::npos) return std::nullopt;  // C would not see the rest.
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const std::string numeric = address == "localhost" ? "127.0.0.1" : address;
  if (numeric.empty() ||
      getaddrinfo(numeric.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) {
    return std::nullopt;
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> list(found, freeaddrinfo);
  SocketAddress result;
  std::memcpy(&result.storage, list->ai_addr, list->ai_addrlen);
  result.size = list->ai_addrlen;
  return result;
}

void RequireFree(const std::string& address, int port, const std::string& port_option) {
  const std::optional<SocketAddress> parsed = ParseAddress(address, port);
  if (!parsed) {
    throw UserError("--view-address: " + address +
                    " is no numeric address such as 127.0.0.1, ::1, or 0.0.0.0 for all");
  }
  const int descriptor = socket(parsed->storage.ss_family, SOCK_STREAM, 0);
  if (descriptor < 0) throw UserError("--view-address: " + address + ": " + std::strerror(errno));
  // Connections of a server that has just ended do not count.
  const int yes = 1;
  setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  int error = bind(descriptor, parsed->get(), parsed->size) == 0 ? 0 : errno;
  if (error == 0 && listen(descriptor, 1) != 0) error = errno;
  close(descriptor);
  if (error == 0) return;
  const std::string port_text = std::to_string(port);
  if (error == EADDRINUSE) {
    throw UserError("port " + port_text + " is taken; choose another with " + port_option +
                    ", where 0 is any that is free");
  }
  if (error == EACCES) {
    throw UserError("port " + port_text + " is reserved; choose one from 1024 on with " +
                    port_option);
  }
  throw UserError("--view-address: " + address + " is no address of this machine (" +
                  std::strerror(error) + ")");
}

}  // namespace orb360
