#pragma once

#include <optional>
#include <string>

#include <sys/socket.h>

namespace orb360 {

/// An address and a port as sockets take them.
struct SocketAddress {
  sockaddr_storage storage{};
  socklen_t size = 0;

  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
};

/// Reads a numeric address of IPv4 or IPv6, or `localhost`, which is 127.0.0.1. None for names and
/// anything else: nothing is looked up.
std::optional<SocketAddress> ParseAddress(const std::string& address, int port);

/// Throws UserError, with the option that helps (`port_option`, such as `--port N`), where nothing
/// can listen at the address and port: the port is taken or reserved, or the address is not one of
/// this machine.
void RequireFree(const std::string& address, int port, const std::string& port_option);

}  // namespace orb360
