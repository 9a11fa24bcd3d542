#include "run/grid_picture.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "render/image.h"

namespace mortise::run {
namespace {

namespace fs = std::filesystem;

// The middle of a tile is as it was; its number stands in its upper left corner.
TEST(GridPicture, TilesAreNumbered) {
  const std::string dir = testing::TempDir() + "/mortise_grid";
  fs::remove_all(dir);
  const render::Image white{120, 80, std::vector<std::uint8_t>(3 * 120 * 80, 255)};
  std::vector<Tile> tiles;
  for (const char* name : {"0", "1", "2"}) {
    tiles.push_back({dir + "/" + name, name});
    fs::create_directories(tiles.back().folder);
    render::write_png(tiles.back().folder + "/side_0003.png", white);
  }
  draw_side_by_side(tiles, dir + "/frames");
  const render::Image all = render::read_png(dir + "/frames/side_0003.png");
  ASSERT_EQ(all.width, 120);
  ASSERT_EQ(all.height, 80);
  const auto dark = [&](int left, int top) {
    int count = 0;
    for (int y = top; y < top + 20; ++y)
      for (int x = left; x < left + 20; ++x) count += all.at(x, y)[0] < 160;
    return count;
  };
  EXPECT_GT(dark(0, 0), 3);
  EXPECT_GT(dark(60, 0), 3);
  EXPECT_GT(dark(0, 40), 3);
  EXPECT_EQ(dark(60, 40), 0) << "there is no fourth";
  EXPECT_EQ(dark(30, 20), 0);
}

}  // namespace
}  // namespace mortise::run
