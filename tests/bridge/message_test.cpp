#include "bridge/message.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "bridge/exit.h"

namespace mortise::bridge {
namespace {

const std::vector<Drive> kDrives{{"elbow", Drive::Mode::pd, false, -1, 1},
                                 {"lift", Drive::Mode::kinematic, true, 0, 0.2},
                                 {"grip", Drive::Mode::effort, true, -INFINITY, INFINITY}};

Message read(const std::string& line) { return read_message(line, "message 3", kDrives); }

}  // namespace

TEST(BridgeMessage, ReadsWhatReadmeSays) {
  const Message m = read(R"( {"targets": {"elbow": -0.25, "lift": 1e-1}, "efforts": {"grip": 5}} )");
  EXPECT_EQ(m.values, (std::map<std::string, double>{{"elbow", -0.25}, {"lift", 0.1}, {"grip", 5}}));
  EXPECT_FALSE(m.reset || m.end);
  EXPECT_TRUE(read("{}").values.empty());
  EXPECT_TRUE(read(R"({"reset":true})").reset);
  EXPECT_TRUE(read(R"({"end":true})").end);
  EXPECT_EQ(read(R"({"targets":{"elbow":99}})").values.at("elbow"), 99) << "a motor may aim beyond a stop";
}

TEST(BridgeMessage, RefusesEverythingElse) {
  const std::tuple<const char*, const char*> cases[] = {
      {"", "empty line"},
      {"hello", "is no JSON at character 1"},
      {"{\"targets\": {\"elbow\": NaN}}", "NaN and Infinity are no JSON"},
      {"{\"targets\": {\"elbow\": -Infinity}}", "NaN and Infinity are no JSON"},
      {"{\"targets\": {\"elbow\": 1e999}}", "too large"},
      {"{\"targets\": {\"elbow\": 0.1}} {}", "is no JSON"},
      {"{\"targets\": {\"elbow\": 0.1}", "is no JSON"},
      {"{'targets': {}}", "is no JSON"},
      {"[0.1, 0.2]", "is a list, not an object"},
      {"0.3", "is a number, not an object"},
      {"null", "is null"},
      {"{\"target\": {}}", "unknown key 'target'; did you mean 'targets'?"},
      {"{\"targets\": [0.1]}", "targets is a list"},
      {"{\"targets\": {\"elbwo\": 0.1}}", "no drive of the scene moves a joint 'elbwo'; did you mean 'elbow'?"},
      {"{\"targets\": {\"elbow\": \"0.1\"}}", "targets.elbow is a text, not a number [rad]"},
      {"{\"targets\": {\"elbow\": true}}", "targets.elbow is true"},
      {"{\"targets\": {\"elbow\": null}}", "targets.elbow is null"},
      {"{\"targets\": {\"elbow\": 0.1, \"elbow\": 0.2}}", "the key 'elbow' stands twice"},
      {"{\"targets\": {\"grip\": 1}}", "its drive is of mode effort, which takes 'efforts' [N]"},
      {"{\"efforts\": {\"elbow\": 1}}", "its drive is of mode pd, which takes 'targets' [rad]"},
      {"{\"targets\": {\"lift\": 0.2}}", "not between the limits of the joint, 0 and 0.2 m"},
      {"{\"reset\": false}", "reset is false; it can only be true"},
      {"{\"end\": 1}", "end is a number"},
      {"{\"end\": true, \"targets\": {}}", "stand alone"},
      {"{\"end\": true, \"reset\": true}", "stand alone"},
      {"{\"targets\": {\"elbow\": \"\xff\"}}", "is no JSON"},
  };
  for (const auto& [line, what] : cases) {
    try {
      read(line);
      ADD_FAILURE() << line << " is accepted";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), kPartnerFailed);
      EXPECT_EQ(std::string(e.what()).find("message 3: "), 0u) << e.what();
      EXPECT_NE(std::string(e.what()).find(what), std::string::npos) << line << " gives: " << e.what();
    }
  }
}

// A long line is not shown whole, and deep nesting is no danger.
TEST(BridgeMessage, ExcerptsAreShort) {
  for (const std::string& line : {std::string(100000, 'x'), "{\"targets\":" + std::string(200000, '[')}) {
    try {
      read(line);
      ADD_FAILURE();
    } catch (const Error& e) {
      EXPECT_LT(std::string(e.what()).size(), 300u);
    }
  }
}

}  // namespace mortise::bridge
