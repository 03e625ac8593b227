#include "slam/viewer/http_server.h"

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/slam/io/temp_folder.h"
#include "tests/slam/viewer/raw_http.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

using testing::HasSubstr;
using testing::Not;

class HttpServerTest : public testing::Test {
 protected:
  HttpServerTest() {
    for (int i = 0; i < 400000; ++i) large_ += static_cast<char>(i * 7 + (i >> 8));
    WriteText(folder_ / "large", large_);
    WriteText(folder_ / "secret", "secret");
    ResourceTable table;
    table[""] = {"text/html", {}, [] { return std::string("the page"); }};
    table["large"] = {"application/octet-stream", folder_ / "large", {}};
    table["views/7.jpg"] = {"image/jpeg", {}, [] { return std::string("image"); }};
    table["since"].make_since = [](std::uint64_t since) { return std::to_string(since); };
    table["act"] = {"text/plain", {}, [this] { return std::to_string(++num_actions_); }, true};
    server_.emplace(table, HttpAddress{});
    port_ = server_->port();
  }

  std::string Get(const std::string& path, const std::string& more = "") const {
    return Exchange(port_, GetRequest(port_, path, more));
  }

  /// The server still answers as it should.
  void ExpectAlive() const { EXPECT_EQ(BodyOf(Get("/")), "the page"); }

  const TempFolder folder_;
  std::string large_;
  std::atomic<int> num_actions_ = 0;
  std::optional<HttpServer> server_;
  int port_ = 0;
};

TEST_F(HttpServerTest, AnswersWithResourcesAndTheirHeaders) {
  const std::string response = Get("/views/7.jpg");
  EXPECT_EQ(StatusOf(response), 200);
  EXPECT_EQ(BodyOf(response), "image");
  EXPECT_THAT(response, HasSubstr("content-type: image/jpeg\r\n"));
  EXPECT_THAT(response, HasSubstr("content-security-policy: default-src 'none'"));
  EXPECT_THAT(response, HasSubstr("x-content-type-options: nosniff\r\n"));
  EXPECT_THAT(response, HasSubstr("cross-origin-resource-policy: same-origin\r\n"));
  EXPECT_THAT(response, Not(HasSubstr("access-control-allow-origin")));
}

TEST_F(HttpServerTest, SendsFilesAndRangesOfThem) {
  EXPECT_EQ(BodyOf(Get("/large")), large_);
  const std::string part = Get("/large", "Range: bytes=100000-300000\r\n");
  EXPECT_EQ(StatusOf(part), 206);
  EXPECT_THAT(part, HasSubstr("content-range: bytes 100000-300000/400000\r\n"));
  EXPECT_EQ(BodyOf(part), large_.substr(100000, 200001));
  EXPECT_EQ(StatusOf(Get("/large", "Range: bytes=400000-\r\n")), 416);
}

TEST_F(HttpServerTest, PassesOnWhatAPageHasAlready) {
  EXPECT_EQ(BodyOf(Get("/since?since=17")), "17");
  EXPECT_EQ(BodyOf(Get("/since")), "0");
  for (const char* query : {"since=1&since=2", "since=1&x=2", "since=", "y"}) {
    EXPECT_EQ(StatusOf(Get("/since?" + std::string(query))), 400) << query;
  }
  EXPECT_EQ(BodyOf(Get("/views/7.jpg?since=x")), "image");
  ExpectAlive();
}

TEST_F(HttpServerTest, AnswersSeveralRequestsOfOneConnection) {
  const RawConnection connection(port_);
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(connection.Send(GetRequest(port_, i % 2 == 0 ? "/large" : "/views/7.jpg")));
    const std::string response = connection.ReceiveResponse();
    ASSERT_EQ(StatusOf(response), 200) << i;
    ASSERT_EQ(BodyOf(response), i % 2 == 0 ? large_ : "image");
  }
  ASSERT_TRUE(connection.Send("HEAD /large HTTP/1.1\r\nHost: localhost:" + std::to_string(port_) +
                              "\r\n\r\n"));
  const std::string head = connection.ReceiveResponse(true);
  EXPECT_THAT(head, HasSubstr("content-length: 400000\r\n"));
  EXPECT_EQ(BodyOf(head), "");
}

TEST_F(HttpServerTest, AnswersManyConnectionsAtOnce) {
  std::vector<std::thread> readers;
  std::vector<int> good(8, 0);
  for (int& count : good) {
    readers.emplace_back([this, &count] {
      for (int i = 0; i < 10; ++i) count += BodyOf(Get("/large")) == large_ ? 1 : 0;
    });
  }
  for (std::thread& reader : readers) reader.join();
  EXPECT_THAT(good, testing::Each(10));
}

TEST_F(HttpServerTest, ActsOnPostsOfItsOwnPageOnly) {
  const auto post = [this](const std::string& path, const std::string& more) {
    std::string request = GetRequest(port_, path, more);
    request.replace(0, 3, "POST");
    return StatusOf(Exchange(port_, request));
  };
  std::string origin("Origin: http://localhost:");
  origin += std::to_string(port_);
  origin += "\r\n";
  const std::string empty = "Content-Length: 0\r\n";
  EXPECT_EQ(StatusOf(Get("/act")), 405);
  EXPECT_EQ(post("/act", empty), 403);
  EXPECT_EQ(post("/act", empty + "Origin: http://evil.example\r\n"), 403);
  EXPECT_EQ(post("/act", origin + "Content-Length: 4\r\n"), 413);
  EXPECT_EQ(post("/large", empty + origin), 405);
  EXPECT_EQ(num_actions_, 0);
  EXPECT_EQ(post("/act", empty + origin), 200);
  EXPECT_EQ(num_actions_, 1);
  ExpectAlive();
}

TEST_F(HttpServerTest, GivesNothingToMaliciousRequests) {
  std::string host("Host: localhost:");
  host += std::to_string(port_);
  host += "\r\n";
  const std::string path = folder_.path().string();
  std::vector<std::string> requests;
  for (const std::string& target : {path + "/secret",
                                    "/" + path + "/secret",
                                    std::string("/secret"),
                                    std::string("/../secret"),
                                    std::string("/../../../../../../../../etc/passwd"),
                                    std::string("/%2e%2e/%2e%2e/etc/passwd"),
                                    std::string("/..%2f..%2fetc%2fpasswd"),
                                    std::string("/%252e%252e%252fsecret"),
                                    std::string("/views/../secret"),
                                    std::string("/views/..\\secret"),
                                    std::string("/views/7.jpg%00.html"),
                                    std::string("/views/7.jpg/"),
                                    std::string("/views/-1.jpg"),
                                    std::string("/views/"),
                                    std::string("/large%0d%0aX-Injected: yes"),
                                    std::string("file:///etc/passwd"),
                                    std::string("http://evil.example/"),
                                    std::string("*"),
                                    std::string("/%"),
                                    std::string("/%zz"),
                                    std::string("/\xff\xfe"),
                                    std::string("/").append(3000, 'a')}) {
    std::string request("GET ");
    request += target;
    request += " HTTP/1.1\r\n";
    request += host;
    requests.push_back(request + "\r\n");
  }
  requests.push_back("GET /large HTTP/1.1\r\nHost: evil.example\r\n\r\n");
  requests.push_back("GET /large HTTP/1.1\r\n\r\n");
  requests.push_back("GET /large HTTP/1.1\r\n" + host + "Host: evil.example\r\n\r\n");
  requests.push_back(GetRequest(port_, "/large", "Origin: http://evil.example\r\n"));
  requests.push_back(GetRequest(port_, "/large", "Sec-Fetch-Site: cross-site\r\n"));
  requests.push_back(GetRequest(port_, "/large", "Content-Length: 5\r\n") + "hello");
  requests.push_back(GetRequest(port_, "/large", "Transfer-Encoding: chunked\r\n") + "0\r\n\r\n");
  requests.push_back(GetRequest(port_, "/large", std::string(100000, 'x') + ": x\r\n"));
  requests.push_back("GET /large HTTP/9.9\r\n\r\n");
  for (const char* method :
       {"POST", "PUT", "DELETE", "OPTIONS", "PATCH", "CONNECT", "TRACE", "X"}) {
    requests.push_back(std::string(method) + " /large HTTP/1.1\r\n" + host + "\r\n");
  }
  requests.push_back(GetRequest(port_, "/large",
                                "Connection: Upgrade\r\nUpgrade: websocket\r\n"
                                "Sec-WebSocket-Version: 13\r\n"
                                "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"));
  requests.push_back(GetRequest(port_, "/large",
                                "Connection: Upgrade, HTTP2-Settings\r\nUpgrade: h2c\r\n"
                                "HTTP2-Settings: AAMAAABkAARAAAAAAAIAAAAA\r\n"));
  requests.push_back("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n");
  for (const std::string& request : requests) {
    const RawConnection connection(port_);
    ASSERT_TRUE(connection.is_open());
    connection.Send(request);
    const std::string response = connection.ReceiveAll(300);
    const int status = StatusOf(response);
    EXPECT_TRUE(status == 0 || (status >= 400 && status < 500))
        << request.substr(0, 200) << response.substr(0, 300);
    EXPECT_THAT(response, Not(HasSubstr("root:")));
    EXPECT_NE(BodyOf(response), "secret");
    EXPECT_THAT(response, Not(HasSubstr("\r\nX-Injected")));
    ExpectAlive();
  }
}

TEST_F(HttpServerTest, SurvivesRandomRequests) {
  std::mt19937 random(5);
  const std::string good = GetRequest(
      port_, "/large", "Range: bytes=5-10\r\nOrigin: http://localhost:1\r\nConnection: close\r\n");
  for (int i = 0; i < 400; ++i) {
    std::string request = good;
    for (unsigned edits = 1 + random() % 8; edits > 0; --edits) {
      const size_t at = random() % request.size();
      switch (random() % 4) {
        case 0:
          request[at] = static_cast<char>(random());
          break;
        case 1:
          request.erase(at, 1 + random() % 20);
          break;
        case 2:
          request.insert(at, std::string(random() % 300, static_cast<char>(random())));
          break;
        default:
          request.insert(at, request.substr(random() % request.size()));
          break;
      }
      if (request.empty()) request.push_back('x');
    }
    const RawConnection connection(port_);
    ASSERT_TRUE(connection.is_open());
    connection.Send(request);
    connection.ReceiveAll(2);
  }
  ExpectAlive();
}

TEST_F(HttpServerTest, EndsConnectionsThatSendNothing) {
  const RawConnection silent(port_);
  const RawConnection slow(port_);
  ASSERT_TRUE(slow.Send("GET / HT"));
  // Both are closed from the other side, long before this waiting would end.
  constexpr int kPatience = 30000;
  EXPECT_EQ(silent.ReceiveAll(kPatience), "");
  EXPECT_EQ(StatusOf(slow.ReceiveAll(kPatience)) / 100 == 2, false);
  ExpectAlive();
}

TEST_F(HttpServerTest, LimitsTheNumberOfConnections) {
  std::vector<std::unique_ptr<RawConnection>> connections;
  for (int i = 0; i < 200; ++i) connections.push_back(std::make_unique<RawConnection>(port_));
  int answered = 0;
  for (const auto& connection : connections) {
    if (!connection->is_open() || !connection->Send(GetRequest(port_, "/"))) continue;
    answered += StatusOf(connection->ReceiveAll(20)) == 200 ? 1 : 0;
  }
  EXPECT_GE(answered, 10);
  EXPECT_LE(answered, 70);
  connections.clear();
  ExpectAlive();
}

TEST_F(HttpServerTest, EndsWhileAReaderIsStalled) {
  const RawConnection stalled(port_);
  ASSERT_TRUE(stalled.Send(GetRequest(port_, "/large")));
  server_.reset();
  EXPECT_FALSE(RawConnection(port_).is_open());
}

TEST_F(HttpServerTest, SaysThatAPortIsTakenAndAnAddressIsNotOfThisMachine) {
  const auto message = [](const HttpAddress& address) {
    return MessageOf<UserError>([&] { const HttpServer server({}, address); });
  };
  EXPECT_THAT(message({"127.0.0.1", port_}),
              testing::AllOf(HasSubstr("port " + std::to_string(port_) + " is taken"),
                             HasSubstr("--port")));
  EXPECT_THAT(message({"127.0.0.1", port_, "--view=N"}),
              testing::AllOf(HasSubstr("--view=N"), testing::Not(HasSubstr("--port"))));
  EXPECT_THAT(message({"203.0.113.5", 0}), HasSubstr("is no address of this machine"));
  EXPECT_THAT(message({"my-computer", 0}), HasSubstr("is no numeric address"));
}

TEST_F(HttpServerTest, HasATokenInItsAddressBeyondThisMachine) {
  EXPECT_EQ(server_->url(), "http://127.0.0.1:" + std::to_string(port_) + "/");
  ResourceTable table;
  table["x"] = {"text/plain", {}, [] { return std::string("data"); }};
  const HttpServer open(table, {"0.0.0.0", 0});
  const std::string url = open.url();
  const std::string token = url.substr(url.size() - 33, 32);
  EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos);
  const int port = open.port();
  EXPECT_EQ(BodyOf(Exchange(port, GetRequest(port, "/" + token + "/x"))), "data");
  EXPECT_EQ(StatusOf(Exchange(port, GetRequest(port, "/x"))), 403);
}

}  // namespace
}  // namespace orb360
