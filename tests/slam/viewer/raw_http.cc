#include "tests/slam/viewer/raw_http.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace orb360 {

RawConnection::RawConnection(int port) : descriptor_(socket(AF_INET, SOCK_STREAM, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    close(descriptor_);
    descriptor_ = -1;
  }
}

RawConnection::~RawConnection() {
  if (descriptor_ >= 0) close(descriptor_);
}

bool RawConnection::Send(const std::string& bytes) const {
  size_t sent = 0;
  while (sent < bytes.size()) {
    const ssize_t count = send(descriptor_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (count <= 0) return false;
    sent += static_cast<size_t>(count);
  }
  return true;
}

std::string RawConnection::ReceiveAll(int milliseconds) const {
  std::string bytes;
  std::array<char, 65536> piece{};
  while (true) {
    pollfd waiting{descriptor_, POLLIN, 0};
    if (poll(&waiting, 1, milliseconds) <= 0) return bytes;
    const ssize_t count = recv(descriptor_, piece.data(), piece.size(), 0);
    if (count <= 0) return bytes;
    bytes.append(piece.data(), static_cast<size_t>(count));
  }
}

std::string RawConnection::ReceiveResponse(bool is_head) const {
  constexpr int kPatience = 5000;  // ms: what this test waits for comes at once
  std::string bytes;
  std::array<char, 65536> piece{};
  while (true) {
    const size_t end = bytes.find("\r\n\r\n");
    if (end != std::string::npos) {
      const size_t length = bytes.find("content-length: ");
      const size_t size =
          is_head || length > end ? 0 : std::strtoull(bytes.c_str() + length + 16, nullptr, 10);
      if (bytes.size() >= end + 4 + size) return bytes;
    }
    pollfd waiting{descriptor_, POLLIN, 0};
    if (poll(&waiting, 1, kPatience) <= 0) return bytes;
    const ssize_t count = recv(descriptor_, piece.data(), piece.size(), 0);
    if (count <= 0) return bytes;
    bytes.append(piece.data(), static_cast<size_t>(count));
  }
}

std::string Exchange(int port, const std::string& request) {
  const RawConnection connection(port);
  if (!connection.is_open() || !connection.Send(request)) return {};
  return connection.ReceiveResponse();
}

std::string GetRequest(int port, const std::string& path, const std::string& more) {
  return "GET " + path + " HTTP/1.1\r\nHost: localhost:" + std::to_string(port) + "\r\n" + more +
         "\r\n";
}

int StatusOf(const std::string& response) {
  return response.starts_with("HTTP/1.1 ") ? std::atoi(response.c_str() + 9) : 0;
}

std::string BodyOf(const std::string& response) {
  const size_t end = response.find("\r\n\r\n");
  return end == std::string::npos ? "" : response.substr(end + 4);
}

}  // namespace orb360
