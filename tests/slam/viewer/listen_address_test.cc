#include "slam/viewer/listen_address.h"

#include <string>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>

namespace orb360 {
namespace {

TEST(ParseAddress, ReadsNumbersAndTheNameOfThisMachineOnly) {
  const auto ipv4 = ParseAddress("localhost", 8360);
  ASSERT_TRUE(ipv4);
  const auto& loopback = reinterpret_cast<const sockaddr_in&>(ipv4->storage);
  EXPECT_EQ(loopback.sin_family, AF_INET);
  EXPECT_EQ(ntohl(loopback.sin_addr.s_addr), INADDR_LOOPBACK);
  EXPECT_EQ(ntohs(loopback.sin_port), 8360);
  const auto ipv6 = ParseAddress("::1", 80);
  ASSERT_TRUE(ipv6);
  EXPECT_EQ(ipv6->storage.ss_family, AF_INET6);
  for (const std::string& name :
       {std::string("example.org"), std::string("127.0.0.1.example.org"), std::string("127.x"),
        std::string(""), std::string(" 127.0.0.1"), std::string("127.0.0.1\0x", 11)}) {
    EXPECT_FALSE(ParseAddress(name, 80)) << name;
  }
}

}  // namespace
}  // namespace orb360
