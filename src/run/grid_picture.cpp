#include "run/grid_picture.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "render/image.h"
#include "render/overlay.h"
#include "run/folder.h"

namespace fs = std::filesystem;

namespace mortise::run {
namespace {

// `from` in the box of `to` whose corner is (left, top): every pixel is the mean of those that it covers.
void shrink(const render::Image& from, render::Image& to, int left, int top, int width, int height) {
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int x0 = x * from.width / width, x1 = std::max((x + 1) * from.width / width, x0 + 1), y0 = y * from.height / height,
                y1 = std::max((y + 1) * from.height / height, y0 + 1);
      for (int c = 0; c < 3; ++c) {
        long sum = 0;
        for (int j = y0; j < y1; ++j)
          for (int i = x0; i < x1; ++i) sum += from.at(i, j)[c];
        to.at(left + x, top + y)[c] = static_cast<std::uint8_t>(sum / ((x1 - x0) * (y1 - y0)));
      }
    }
}

// "pad_" of "pad_0042.png"
std::string camera_of(const std::string& name) { return name.substr(0, name.rfind('_') + 1); }

}  // namespace

void draw_side_by_side(const std::vector<Tile>& tiles, const std::string& to) {
  std::set<std::string> names;
  std::error_code ec;
  for (const Tile& tile : tiles)
    for (fs::directory_iterator it(tile.folder, ec), end; !ec && it != end; it.increment(ec))
      if (it->path().extension() == ".png" && render::is_color_png(it->path().string())) names.insert(it->path().filename().string());
  if (names.empty()) return;
  make_pictures_folder(to);
  const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(tiles.size())))),
            rows = (static_cast<int>(tiles.size()) + columns - 1) / columns;
  render::Image all;
  std::string camera;
  for (const std::string& name : names) {
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      const std::string path = tiles[i].folder + "/" + name;
      if (!fs::exists(path, ec)) continue;
      const render::Image one = render::read_png(path);
      const int width = std::max(one.width / columns, 1), height = std::max(one.height / columns, 1);
      if (camera != camera_of(name)) {
        camera = camera_of(name);
        all = {columns * width, rows * height, std::vector<std::uint8_t>(3ul * columns * width * rows * height, 255)};
      }
      if (columns * width != all.width || rows * height != all.height) continue;
      const int left = static_cast<int>(i) % columns * width, top = static_cast<int>(i) / columns * height;
      shrink(one, all, left, top, width, height);
      const double size = std::max(10.0, height * 0.08);
      render::draw_label(all, tiles[i].label, left + 0.4 * size, top + 1.2 * size, size);
    }
    guard_picture(to + "/" + name);
    render::write_png(to + "/" + name, all);
  }
}

}  // namespace mortise::run
