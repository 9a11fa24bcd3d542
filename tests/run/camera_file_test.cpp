#include "run/camera_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

namespace mortise::run {
namespace {

using Json = nlohmann::json;

Params camera(const std::vector<std::string>& outputs) {
  Params p = Params::make_table(), list = Params::make_list();
  for (const std::string& o : outputs) list.push(Params::make_text(o));
  if (!outputs.empty()) p.set("outputs", list);
  return p;
}

TEST(CameraFile, NamesOnlyWhatIsAskedFor) {
  const CameraFiles plain = camera_files(camera({}), "front", 42), all = camera_files(camera({"segmentation", "depth"}), "front", 7);
  EXPECT_EQ(plain.file, "front_0042.json");
  EXPECT_EQ(plain.color, "front_0042.png");
  EXPECT_EQ(plain.depth + plain.segmentation, "");
  EXPECT_EQ(all.color, "");
  EXPECT_EQ(all.depth, "front_depth_0007.png");
  EXPECT_EQ(all.segmentation, "front_segmentation_0007.png");
}

TEST(CameraFile, DepthIsCountedInItsUnitAndZeroIsNothing) {
  const double far = 65.535, none = std::numeric_limits<double>::infinity();
  const render::Measurement seen{5, 1, {1, 1, 1, 1, 0}, {0.5004, 0.5006, far, far + 0.001, none}};
  EXPECT_EQ(depth_image(seen, 1e-3).values, (std::vector<std::uint16_t>{500, 501, 65535, 0, 0}));
  EXPECT_EQ(depth_image(seen, 1e-4).values[0], 5004);
}

TEST(CameraFile, DepthInMetresIsAnArrayOfNumPy) {
  const render::Measurement seen{3, 2, {1, 1, 0, 1, 1, 1}, {0.5, 1.25, std::numeric_limits<double>::infinity(), 2, 3, 4}};
  const std::string bytes = depth_array(seen);
  ASSERT_EQ(bytes.size(), 128u + 6 * sizeof(float)) << "numbers begin at a multiple of 64";
  EXPECT_EQ(bytes.substr(0, 10), std::string("\x93NUMPY\x01\x00\x76\x00", 10));
  EXPECT_EQ(bytes.substr(10, 60), "{'descr': '<f4',  'fortran_order': False, 'shape': (2, 3), }");
  EXPECT_EQ(bytes[127], '\n');
  EXPECT_EQ(bytes.find_first_not_of(' ', 70), 127u);
  float values[6];
  std::memcpy(values, bytes.data() + 128, sizeof values);
  EXPECT_EQ(values[1], 1.25f);
  EXPECT_TRUE(std::isinf(values[2]));
  const std::string path = (std::filesystem::temp_directory_path() / ("mortise_depth_" + std::to_string(getpid()))).string();
  std::ofstream(path, std::ios::binary) << bytes;
  EXPECT_TRUE(is_our_depth_array(path));
  std::ofstream(path, std::ios::binary) << std::string(bytes).replace(26, 1, "");
  EXPECT_FALSE(is_our_depth_array(path)) << "as numpy.save writes it: somebody else's";
  std::filesystem::remove(path);
  EXPECT_EQ(camera_files(camera({"depth_float"}), "front", 3).depth_float, "front_depth_0003.npy");
}

TEST(CameraFile, BodiesHaveColoursOfTheirOwn) {
  std::set<std::array<std::uint8_t, 3>> colours;
  for (int id = 0; id <= 255; ++id) colours.insert(label_color(id));
  EXPECT_GT(colours.size(), 250u);
  EXPECT_EQ(label_color(0), (std::array<std::uint8_t, 3>{0, 0, 0}));
  const render::IndexedImage image = segmentation_image({2, 1, {0, 2}, {0, 1}}, 2);
  EXPECT_EQ(image.indices, (std::vector<std::uint8_t>{0, 2}));
  ASSERT_EQ(image.colours.size(), 3u);
  EXPECT_EQ(image.colours[2], label_color(2));
}

TEST(CameraFile, SaysWhereTheCameraIsAndHowItProjects) {
  render::RenderJob job;
  job.width = 640, job.height = 480;
  job.camera.position = {1, 2, 3}, job.camera.look_at = {1, 5, 3};  // along +y: x is to the right, -z down
  job.camera.fov = 2 * std::atan(0.5);
  Params p = camera({"color", "depth", "segmentation"});
  p.set("depth_unit", Params::make_number(1e-4));
  const std::vector<render::BodyLabel> bodies{{1, "pad", "soft"}, {2, "floor", "half_space"}};
  const Json j = Json::parse(camera_json(camera_files(p, "front", 3), p, "front", job, bodies, 3, 0.06));
  EXPECT_EQ(j["model"], "pinhole");
  EXPECT_EQ(j["distortion_model"], "plumb_bob");
  EXPECT_NEAR(j["fx"].get<double>(), 480, 1e-9);
  EXPECT_EQ(j["fy"], j["fx"]);
  EXPECT_EQ(j["cx"], 319.5);
  EXPECT_EQ(j["cy"], 239.5);
  EXPECT_EQ(j["camera_to_world"], Json::parse("[[1,0,0,1],[0,0,1,2],[0,-1,0,3],[0,0,0,1]]"));
  EXPECT_EQ(j["frame"], 3);
  EXPECT_EQ(j["time_s"], 0.06);
  EXPECT_EQ(j["depth"]["unit_m"], 1e-4);
  EXPECT_EQ(j["depth"]["measures"], "z");
  EXPECT_EQ(j["segmentation"]["bodies"][1]["name"], "floor");
  EXPECT_EQ(j["segmentation"]["bodies"][1]["id"], 2);
  job.camera.model = render::Camera::Model::fisheye;
  job.camera.fov = 3;
  const Json f = Json::parse(camera_json(camera_files(camera({}), "front", 3), camera({}), "front", job, bodies, 3, 0.06));
  EXPECT_EQ(f["model"], "fisheye");
  EXPECT_EQ(f["distortion_model"], "equidistant");
  EXPECT_EQ(f["distortion"], Json::parse("[0,0,0,0]"));
  EXPECT_EQ(f["fx"], 160);
  EXPECT_EQ(f["image_circle_radius"], 240);
  EXPECT_FALSE(f.contains("depth"));
}

TEST(CameraFile, KnowsItsOwn) {
  const std::string path = (std::filesystem::temp_directory_path() / ("mortise_camera_" + std::to_string(getpid()) + ".json")).string();
  std::ofstream(path) << camera_json({}, camera({}), "front", {}, {}, 0, 0);
  EXPECT_TRUE(is_our_camera_file(path));
  std::ofstream(path) << "{\"filetype\": 1}";
  EXPECT_FALSE(is_our_camera_file(path));
  std::filesystem::remove(path);
  EXPECT_FALSE(is_our_camera_file(path));
}

}  // namespace
}  // namespace mortise::run
