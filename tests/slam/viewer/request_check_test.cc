#include "slam/viewer/request_check.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace orb360 {
namespace {

/// What a browser sends for a part of the page at this address.
RequestHead Request(const std::string& path, const std::string& host) {
  RequestHead head;
  head.is_get = true;
  head.path = path;
  head.host = host;
  head.fetch_site = "same-origin";
  return head;
}

int StatusOf(const RequestHead& head, const AccessRules& rules) {
  return CheckRequest(head, rules).status;
}

TEST(RequestCheck, AdmitsThePageOfThisMachine) {
  const AccessRules rules = MakeAccessRules("127.0.0.1", 8360);
  EXPECT_THAT(rules.token, testing::IsEmpty());
  for (const char* host : {"127.0.0.1:8360", "localhost:8360", "LOCALHOST:8360", "[::1]:8360"}) {
    const Admission admission = CheckRequest(Request("/run.json", host), rules);
    EXPECT_EQ(admission.status, 200) << host;
    EXPECT_EQ(admission.resource, "run.json");
  }
  EXPECT_EQ(CheckRequest(Request("/", "localhost:8360"), rules).resource, "");
}

TEST(RequestCheck, RefusesHostsThatAreNotThisMachine) {
  const AccessRules rules = MakeAccessRules("127.0.0.1", 8360);
  for (const char* host : {"", "localhost", "localhost:80", "evil.example:8360", "127.0.0.2:8360",
                           "localhost:8360.evil.example", "localhost:8360, evil.example",
                           "user@localhost:8360", "127.0.0.1:8360 ", "0x7f000001:8360"}) {
    EXPECT_EQ(StatusOf(Request("/run.json", host), rules), 421) << host;
  }
}

TEST(RequestCheck, LeavesOutThePortOfHttpOnly) {
  EXPECT_EQ(StatusOf(Request("/", "localhost"), MakeAccessRules("127.0.0.1", 80)), 200);
  EXPECT_EQ(StatusOf(Request("/", "[::1]"), MakeAccessRules("::1", 80)), 200);
  EXPECT_EQ(StatusOf(Request("/", "localhost"), MakeAccessRules("127.0.0.1", 8080)), 421);
}

TEST(RequestCheck, RefusesOtherOriginsAndSites) {
  const AccessRules rules = MakeAccessRules("127.0.0.1", 8360);
  RequestHead head = Request("/run.json", "localhost:8360");
  head.origin = "http://localhost:8360";
  EXPECT_EQ(StatusOf(head, rules), 200);
  for (const std::string origin : {"null", "http://evil.example", "https://localhost:8360",
                                   "http://127.0.0.1:8360", "http://localhost:8360.evil.example"}) {
    head.origin = origin;
    EXPECT_EQ(StatusOf(head, rules), 403) << origin;
  }
  head.origin.clear();
  for (const std::string site : {"cross-site", "same-site", "anything"}) {
    head.fetch_site = site;
    EXPECT_EQ(StatusOf(head, rules), 403) << site;
  }
  head.path =
      std::string("/");  // A link on another site leads to the page, which has no data itself.
  EXPECT_EQ(StatusOf(head, rules), 200);
}

TEST(RequestCheck, RefusesMethodsAndBodies) {
  const AccessRules rules = MakeAccessRules("127.0.0.1", 8360);
  RequestHead head = Request("/", "localhost:8360");
  head.content_length = std::string("0");
  EXPECT_EQ(StatusOf(head, rules), 200);
  head.content_length = std::string("5");
  EXPECT_EQ(StatusOf(head, rules), 413);
  head = Request("/", "localhost:8360");
  head.is_get = false;
  EXPECT_EQ(StatusOf(head, rules), 405);
}

TEST(RequestCheck, AdmitsPostsThatStateThisOrigin) {
  const AccessRules rules = MakeAccessRules("127.0.0.1", 8360);
  RequestHead head = Request("/pause", "localhost:8360");
  head.is_get = false;
  head.is_post = true;
  EXPECT_EQ(StatusOf(head, rules), 403);
  head.origin = std::string("http://localhost:8360");
  EXPECT_EQ(StatusOf(head, rules), 200);
  head.origin = std::string("http://localhost:8361");
  EXPECT_EQ(StatusOf(head, rules), 403);
}

TEST(RequestCheck, WantsTheTokenBeyondThisMachine) {
  const AccessRules rules = MakeAccessRules("0.0.0.0", 8360);
  ASSERT_EQ(rules.token.size(), 32U);
  const std::string host = "192.168.1.7:8360";
  const Admission admission = CheckRequest(Request("/" + rules.token + "/run.json", host), rules);
  EXPECT_EQ(admission.status, 200);
  EXPECT_EQ(admission.resource, "run.json");
  std::string wrong = rules.token;
  wrong.back() = wrong.back() == '0' ? '1' : '0';
  for (const std::string& path :
       {std::string("/run.json"), std::string("/"), "/" + rules.token, "/" + wrong + "/run.json",
        "//" + rules.token + "/", "/" + rules.token.substr(1) + "/", "/" + rules.token + "0/"}) {
    EXPECT_EQ(StatusOf(Request(path, host), rules), 403) << path;
  }
  // A name that somebody has pointed to this machine is refused even with the token.
  EXPECT_EQ(StatusOf(Request("/" + rules.token + "/", "evil.example:8360"), rules), 421);
  EXPECT_EQ(StatusOf(Request("/" + rules.token + "/", "192.168.1.7:99"), rules), 421);
}

TEST(RequestCheck, HasAnotherTokenEachTime) {
  std::set<std::string> tokens;
  for (int i = 0; i < 20; ++i) tokens.insert(MakeAccessRules("0.0.0.0", 1).token);
  EXPECT_EQ(tokens.size(), 20U);
}

}  // namespace
}  // namespace orb360
