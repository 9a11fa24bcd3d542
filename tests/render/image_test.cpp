#include "render/image.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "render/colour_map.h"
#include "render/font.h"
#include "render/overlay.h"

namespace mortise::render {
namespace {

std::string temporary(const std::string& name) { return (std::filesystem::path(testing::TempDir()) / name).string(); }

Image gradient() {
  Image image{37, 21, std::vector<std::uint8_t>(37 * 21 * 3)};
  for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = static_cast<std::uint8_t>(i * 7 % 251);
  return image;
}

TEST(Png, ReadsBackWhatWasWritten) {
  const std::string path = temporary("mortise_gradient.png");
  write_png(path, gradient());
  const Image back = read_png(path);
  EXPECT_EQ(back.width, 37);
  EXPECT_EQ(back.height, 21);
  EXPECT_EQ(back.rgb, gradient().rgb);
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
  const Texture texture = read_texture(path);
  EXPECT_EQ(texture.width, 37);
  EXPECT_EQ(texture.rgba[4 * 40 + 1], gradient().rgb[3 * 40 + 1]);
  EXPECT_EQ(texture.rgba[4 * 40 + 3], 255);
}

TEST(Png, CountsAndIndicesKeepTheirValues) {
  const std::string path = temporary("mortise_counts.png");
  const auto byte = [&](long at) {
    std::ifstream in(path, std::ios::binary);
    in.seekg(at);
    return in.get();
  };
  write_png(path, GrayImage{2, 1, {0x1234, 0xffff}});
  EXPECT_EQ(byte(24), 16);
  EXPECT_EQ(byte(25), 0) << "grey";
  EXPECT_TRUE(is_our_png(path));
  EXPECT_FALSE(is_color_png(path));
  IndexedImage image{3, 1, {0, 255, 7}, {}};
  for (int i = 0; i < 256; ++i) image.colours.push_back({static_cast<std::uint8_t>(i), 0, static_cast<std::uint8_t>(255 - i)});
  write_png(path, image);
  EXPECT_EQ(byte(25), 3) << "a palette";
  EXPECT_TRUE(is_our_png(path)) << "behind 256 colours";
  EXPECT_EQ(read_png(path).rgb, (std::vector<std::uint8_t>{0, 0, 255, 255, 0, 0, 7, 0, 248}));
  write_png(path, gradient());
  EXPECT_TRUE(is_color_png(path));
}

TEST(Png, FailuresNameTheFile) {
  try {
    write_png("/nowhere/at/all.png", gradient());
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::file);
    EXPECT_NE(std::string(e.what()).find("/nowhere/at/all.png"), std::string::npos);
  }
  const std::string path = temporary("mortise_no_picture.png");
  std::ofstream(path) << "text";
  EXPECT_THROW(read_png(path), Error);
  EXPECT_THROW(read_texture(path), Error);
  EXPECT_THROW(read_texture(temporary("mortise_absent.png")), Error);
}

double lightness(const ColourMap& m, int i) {  // CIE L* / 100 of an sRGB colour
  const double y =
      0.2126 * linear_of_srgb(m[3 * i] / 255.0) + 0.7152 * linear_of_srgb(m[3 * i + 1] / 255.0) + 0.0722 * linear_of_srgb(m[3 * i + 2] / 255.0);
  return 1.16 * std::cbrt(y) - 0.16;
}

TEST(ColourMap, LightnessRisesSteadilyFromANeutralZero) {
  const ColourMap m = sequential_map();
  EXPECT_LT(std::max({m[0], m[1], m[2]}) - std::min({m[0], m[1], m[2]}), 6);
  for (int i = 16; i < 256; ++i) EXPECT_GT(lightness(m, i), lightness(m, i - 16) + 0.02) << i;
  EXPECT_LT(lightness(m, 0), 0.2);
  EXPECT_GT(lightness(m, 255), 0.9);
}

TEST(ColourMap, ZeroIsGreyWhereTheRangeStraddlesIt) {
  const ColourMap m = map_for(-1, 3);
  const int zero = 64;  // a quarter of the way
  EXPECT_LT(std::max({m[3 * zero], m[3 * zero + 1], m[3 * zero + 2]}) - std::min({m[3 * zero], m[3 * zero + 1], m[3 * zero + 2]}), 6);
  EXPECT_GT(m[3 * 0 + 2], m[3 * 0]);      // blue below
  EXPECT_GT(m[3 * 255], m[3 * 255 + 2]);  // orange above
  EXPECT_EQ(map_for(0, 1), sequential_map());
}

TEST(Ticks, AreRoundAndInside) {
  for (const auto& [low, high] : {std::pair{0.0, 20.0}, {0.0, 0.37}, {-3.0, 8.0}, {1e-7, 9e-7}, {0.0, 4.2e9}, {12.0, 12.5}}) {
    const auto list = ticks(low, high);
    EXPECT_GE(list.size(), 4u) << high;
    EXPECT_LE(list.size(), 9u) << high;
    for (const auto& [value, label] : list) {
      EXPECT_GE(value, low - 1e-9 * (high - low));
      EXPECT_LE(value, high + 1e-9 * (high - low));
      EXPECT_NEAR(std::stod(label), value, 1e-6 * (high - low));
    }
  }
  EXPECT_EQ(ticks(0, 20).front().second, "0");
  EXPECT_EQ(ticks(0, 20).back().second, "20");
  for (const auto& [value, label] : ticks(-1e-5, 4e-5)) EXPECT_NE(label, "-0");
  for (const auto& [value, label] : ticks(-1e-7, 1)) EXPECT_NE(label, "-0.0");
}

TEST(Text, DrawsGlyphsOfTheRightWidth) {
  Image image{300, 40, std::vector<std::uint8_t>(300 * 40 * 3, 255)};
  const std::uint8_t black[3] = {0, 0, 0};
  const double width = text_width("µ = 0.5 → 3 kPa", 20);
  draw_text(image, "µ = 0.5 → 3 kPa", 10, 30, 20, black);
  int first = 300, last = 0;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 300; ++x)
      if (image.at(x, y)[0] < 128) first = std::min(first, x), last = std::max(last, x);
  EXPECT_NEAR(first, 11, 2);
  EXPECT_NEAR(last, 10 + width, 3);
  EXPECT_LT(text_width("i", 20), text_width("m", 20));
}

}  // namespace
}  // namespace mortise::render
