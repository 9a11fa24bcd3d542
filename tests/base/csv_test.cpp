#include "base/csv.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>

#include "../place.h"

using namespace mortise;

namespace {

Csv read(const std::string& text) {
  const std::string path = testing::TempDir() + "mortise_" + testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv";
  std::ofstream(path, std::ios::binary) << text;
  return read_csv(path);
}
std::string refused(const std::string& text) {
  try {
    read(text);
  } catch (const Error& e) {
    const std::string what = e.what();
    return what.substr(what.find(".csv") + 4);
  }
  return "";
}

}  // namespace

TEST(Csv, ReadsColumnsAndUnits) {
  const Csv t = read("\xEF\xBB\xBF# a gait\n\ntime [s], left knee [deg] ,grip\r\n0,+1.5,-2e-3\r\n# more\n 0.1 ,\t3, 4\n");
  ASSERT_EQ(t.columns.size(), 3u);
  EXPECT_EQ(t.header, 3);
  EXPECT_EQ(t.columns[1].name, "left knee");
  EXPECT_EQ(t.columns[1].unit, "deg");
  EXPECT_EQ(t.column("grip").unit, "");
  EXPECT_EQ(t.column("grip").values, (std::vector<double>{-2e-3, 4}));
  EXPECT_EQ(t.column("left knee").values, (std::vector<double>{1.5, 3}));
  EXPECT_EQ(t.lines, (std::vector<int>{4, 6}));
  const Csv quoted = read("\"time\",\"q [deg]\"\n0,1\n");
  EXPECT_EQ(quoted.column("q").unit, "deg");
  EXPECT_EQ(quoted.column("q [deg]").values, (std::vector<double>{1})) << "as the file has it";
}

TEST(Csv, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(refused(""), ":1:1: error: is empty; its first line should name the columns");
  EXPECT_EQ(refused("time,a\n"), ":1:1: error: has no line of numbers");
  EXPECT_EQ(refused("time,a\n0,1\n1\n"), ":3:1: error: has 1 entries where line 1 names 2 columns");
  EXPECT_EQ(refused("time,a\n0,x1\n"), ":2:3: error: 'x1' is not a number");
  EXPECT_EQ(refused("time,a\n0,1 2\n"), ":2:3: error: '1 2' is not a number");
  EXPECT_EQ(refused("time,a\n0,nan\n"), ":2:3: error: 'nan' is not a number");
  EXPECT_EQ(refused("time,a\n0,\n"), ":2:3: error: a number is missing");
  EXPECT_EQ(refused("time,time\n0,1\n"), ":1:6: error: two columns are called 'time'");
  EXPECT_EQ(refused("time,\n0,1\n"), ":1:6: error: a column has no name");
  EXPECT_EQ(refused("time,a [deg\n0,1\n"), ":1:6: error: 'a [deg' is not a name with a unit in brackets, as in 'elbow [deg]'");
  try {
    read("time,a\n0,1\n").column("b");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("has no column 'b'; there are: 'time', 'a'"), std::string::npos);
  }
}
