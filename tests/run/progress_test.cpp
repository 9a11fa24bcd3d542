// What a terminal shows of a run: lines that never wrap, at any width.
#include "run/progress.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <vector>

namespace {

using namespace mortise;

// The standard error as a terminal of `columns`; what is written there comes back when it ends.
class TerminalOf {
 public:
  explicit TerminalOf(int columns) {
    own_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    grantpt(own_), unlockpt(own_);
    const int other = open(ptsname(own_), O_RDWR | O_NOCTTY);
    before_ = dup(STDERR_FILENO);
    dup2(other, STDERR_FILENO);
    close(other);
    resize(columns);
  }
  void resize(int columns) {
    winsize size = {};
    size.ws_row = 24, size.ws_col = static_cast<unsigned short>(columns);
    ioctl(own_, TIOCSWINSZ, &size);
  }
  std::string read_all() {
    std::string text;
    char bytes[4096];
    for (ssize_t n; (n = read(own_, bytes, sizeof bytes)) > 0;) text.append(bytes, static_cast<std::size_t>(n));
    return text;
  }
  ~TerminalOf() {
    dup2(before_, STDERR_FILENO);
    close(before_), close(own_);
  }

 private:
  int own_ = -1, before_ = -1;
};

class Progress : public testing::Test {
 protected:
  void SetUp() override {
    const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
    if (terminal < 0) GTEST_SKIP() << "no terminal can be made here: is /dev/pts mounted?";
    close(terminal);
  }
};

// Columns that a text takes: characters of UTF-8 without escape sequences.
int width_of(const std::string& text) {
  int width = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\033')
      while (i + 1 < text.size() && !std::isalpha(static_cast<unsigned char>(text[++i]))) {
      }
    else
      width += (static_cast<unsigned char>(text[i]) & 0xC0) != 0x80;
  }
  return width;
}

solver::StepReport everything_is_long() {
  solver::StepReport r;
  r.step = 99998, r.time = 1.2345e-5, r.newton = 1234, r.lag = 100, r.cg = 123456, r.substeps = 64, r.residual = 1.23e-10;
  return r;
}

// The line that a step leaves behind.
std::string shown(int columns, bool long_figures = true) {
  setenv("TERM", "xterm", 1);
  TerminalOf terminal(columns);
  const auto progress = run::make_progress(false, false);
  progress->start("scene", "summary", 100000);
  terminal.read_all();
  solver::StepReport r = everything_is_long();
  if (!long_figures) r.newton = 3, r.lag = r.cg = 0, r.substeps = 1;
  progress->step(r, {123456, 1.23e-5});
  std::string text = terminal.read_all();
  return text.substr(text.rfind("\033[K") + 3);
}

TEST_F(Progress, NeverWraps) {
  for (int columns = 4; columns <= 300; ++columns) {
    const std::string line = shown(columns);
    EXPECT_LT(width_of(line), columns) << line;
    EXPECT_FALSE(line.empty());
  }
}

TEST_F(Progress, LeavesOutTheLeastImportantFiguresFirst) {
  const std::string at80 = shown(80), at110 = shown(110), wide = shown(200);
  for (const char* figure : {"99999/100000", "t 1.234e-05 s", "newton 1234", " left"}) {
    EXPECT_NE(at80.find(figure), std::string::npos) << at80;
    EXPECT_NE(at110.find(figure), std::string::npos) << at110;
  }
  EXPECT_EQ(at80.find("cg"), std::string::npos) << at80;
  EXPECT_EQ(at110.find("cg"), std::string::npos) << at110;
  EXPECT_NE(at110.find("substeps 64"), std::string::npos) << at110;
  for (const char* figure : {"cg 123456", "lag 100", "contacts 123456", "gap 12.3 um", "residual 1.2e-10 N"})
    EXPECT_NE(wide.find(figure), std::string::npos) << wide;
  EXPECT_NE(at80.find("█"), std::string::npos) << at80;
}

// Minutes of a fine mesh went by without a word.
TEST_F(Progress, SaysThatItIsAtTheFirstStep) {
  setenv("TERM", "xterm", 1);
  TerminalOf terminal(80);
  auto progress = run::make_progress(false, false);
  progress->start("scene", "summary", 10);
  EXPECT_EQ(terminal.read_all(), "scene: summary\r\nthe first step ...");
  progress->note("warning: odd");
  EXPECT_EQ(terminal.read_all(), "\r\033[Kwarning: odd\r\nthe first step ...");
  progress.reset();
  EXPECT_EQ(terminal.read_all(), "\r\033[K");
}

TEST_F(Progress, FollowsTheTerminalAndTakes80WhereItsWidthIsUnknown) {
  setenv("TERM", "xterm", 1);
  TerminalOf terminal(200);
  const auto progress = run::make_progress(false, false);
  progress->start("scene", "summary", 100000);
  for (const int columns : {150, 60, 0, 120}) {
    terminal.resize(columns);
    terminal.read_all();
    progress->step(everything_is_long(), {123456, 1.23e-5});
    const std::string text = terminal.read_all(), line = text.substr(text.rfind("\033[K") + 3);
    const int allowed = columns > 0 ? columns : 80;
    EXPECT_LT(width_of(line), allowed) << line;
    EXPECT_GT(width_of(line), allowed - 30) << line;  // it uses what there is
  }
}

}  // namespace
