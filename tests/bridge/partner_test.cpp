#include "bridge/partner.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>

#include "bridge/exit.h"

namespace mortise::bridge {
namespace {

const auto kGoOn = [] { return false; };

double seconds_of(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::string error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), kPartnerFailed);
    return e.what();
  }
  return "no error";
}

}  // namespace

TEST(BridgePartner, AnswersLineByLine) {
  Partner cat("cat", 10);
  EXPECT_EQ(cat.ask("one", "it", kGoOn), "one");
  cat.say("two");
  EXPECT_EQ(cat.ask("three", "it", kGoOn), "two");
  EXPECT_EQ(cat.ask("four", "it", kGoOn), "three") << "lines that come early wait";
  EXPECT_EQ(Partner("printf 'a\\r\\nb\\n'; cat >/dev/null", 10).ask("x", "it", kGoOn), "a");
}

// Much more than pipes hold, both ways, at once.
TEST(BridgePartner, NobodyWaitsForSomebodyWhoWaits) {
  const std::string much(900000, 'x');
  Partner echo("cat", 20);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(echo.ask(much, "it", kGoOn), much);
  // Speaks before it reads.
  Partner talker("head -c 500000 /dev/zero | tr '\\0' y; echo; cat >/dev/null", 20);
  EXPECT_EQ(talker.ask(much, "it", kGoOn).size(), 500000u);
}

TEST(BridgePartner, ThatEndsIsToldWithItsExitCode) {
  EXPECT_NE(error_of([] { Partner("exit 3", 10).ask("x", "step 5", kGoOn); }).find("ended with exit code 3 before it answered step 5"),
            std::string::npos);
  EXPECT_NE(error_of([] { Partner("kill -9 $$", 10).ask("x", "it", kGoOn); }).find("by signal 9"), std::string::npos);
  EXPECT_NE(error_of([] { Partner("no_such_program_at_all 2>/dev/null", 10).ask("x", "it", kGoOn); }).find("exit code 127"), std::string::npos);
  Partner once("read a; echo $a", 10);
  EXPECT_EQ(once.ask("x", "it", kGoOn), "x");
  EXPECT_NE(error_of([&] { once.ask("y", "step 7", kGoOn); }).find("ended with exit code 0 before it answered step 7"), std::string::npos);
  // What it said before it went is heard.
  Partner last("echo good bye; exec <&-", 10);
  EXPECT_EQ(last.ask(std::string(300000, 'x'), "it", kGoOn), "good bye");
}

TEST(BridgePartner, ThatIsSilentOrDeafIsGivenUpInTime) {
  std::string why;
  EXPECT_LT(seconds_of([&] { why = error_of([] { Partner("exec sleep 100", 0.3).ask("x", "step 2", kGoOn); }); }), 20);
  EXPECT_NE(why.find("did not answer step 2 within 0.3 s"), std::string::npos) << why;
  why = error_of([] { Partner("exec sleep 100", 0.3).ask(std::string(300000, 'x'), "step 2", kGoOn); });
  EXPECT_NE(why.find("did not read step 2 within 0.3 s"), std::string::npos) << why;
}

TEST(BridgePartner, ThatNeverEndsItsLineIsCutOff) {
  EXPECT_NE(error_of([] { Partner("yes | tr -d '\\n'", 20).ask("x", "step 2", kGoOn); }).find("longer than"), std::string::npos);
  EXPECT_NE(error_of([] { Partner("yes", 20).ask(std::string(300000, 'x'), "step 2", kGoOn); }).find("without reading"), std::string::npos);
}

TEST(BridgePartner, WaitingEndsWhereTheRunIsAskedToStop) {
  Partner silent("exec sleep 100", 0);
  EXPECT_LT(seconds_of([&] { EXPECT_THROW(silent.ask("x", "it", [] { return true; }), Partner::Stopped); }), 5);
}

// With the shell its children go, also those that do not want to.
TEST(BridgePartner, LeavesNobodyBehind) {
  pid_t child = 0;
  {
    Partner stubborn("trap '' TERM; sleep 1000 & echo $!; wait; wait; sleep 1000", 10);
    child = static_cast<pid_t>(std::stol(stubborn.ask("x", "it", kGoOn)));
    EXPECT_EQ(kill(child, 0), 0);
  }
  for (int i = 0; i < 100 && kill(child, 0) == 0; ++i) usleep(20000);  // an orphan is waited for by somebody else
  const std::string state = "/proc/" + std::to_string(child) + "/stat";
  char text[256] = {};
  if (FILE* f = std::fopen(state.c_str(), "r")) {
    (void)!std::fread(text, 1, sizeof text - 1, f);
    std::fclose(f);
  }
  const std::string s = text;
  EXPECT_TRUE(s.empty() || s.find(") Z") != std::string::npos) << s;
}

}  // namespace mortise::bridge
