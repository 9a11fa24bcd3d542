// Every way to write a bad scene, and what the user then reads. bad/<case>.txt holds the exit code and the expected stderr;
// lines "# --set a.b=c" at the top of a scene become arguments. MORTISE_UPDATE_GOLDEN=1 rewrites the expectations.
#include <unistd.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include "program.h"

namespace mortise::cli {
namespace {

namespace fs = std::filesystem;
const std::string kFolder = kSource + "/tests/cli/bad";

std::vector<std::string> cases() {
  std::vector<std::string> out;
  for (const auto& entry : fs::directory_iterator(kFolder))
    if (entry.path().extension() == ".yaml") out.push_back(entry.path().stem());
  std::sort(out.begin(), out.end());
  return out;
}

class Bad : public testing::TestWithParam<std::string> {};

TEST_P(Bad, MessageIsAsExpected) {
  const std::string scene = GetParam() + ".yaml", golden = kFolder + "/" + GetParam() + ".txt";
  std::string arguments = "check " + scene;
  std::istringstream lines(read_text(kFolder + "/" + scene));
  const std::string mark = "# --set ";
  for (std::string line; std::getline(lines, line) && line.rfind(mark, 0) == 0;)
    arguments += " --set " + quoted(line.substr(mark.size()));

  const Result r = mortise(arguments, kFolder);
  EXPECT_EQ(r.out, "") << "results only on stdout";
  EXPECT_NE(r.code, 0);
  const std::string seen = std::to_string(r.code) + "\n" + r.err;
  if (std::getenv("MORTISE_UPDATE_GOLDEN")) std::ofstream(golden, std::ios::binary) << seen;
  EXPECT_EQ(seen, read_text(golden));
}

INSTANTIATE_TEST_SUITE_P(Scene, Bad, testing::ValuesIn(cases()), [](const auto& info) { return info.param; });

TEST(BadScenes, ThereAreMany) { EXPECT_GE(cases().size(), 30u); }

}  // namespace
}  // namespace mortise::cli
