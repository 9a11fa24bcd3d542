#include "run/camera_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "render/camera.h"

namespace mortise::run {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDepthUnit = 1e-3;  // [m] of a count, where the scene says nothing: that of ROS's 16UC1 images (REP 118)
constexpr const char* kArrayMagic = "\x93NUMPY\x01";
constexpr const char* kArrayHeader = "{'descr': '<f4',  'fortran_order': False, 'shape': (";  // two blanks that numpy.save does not write tell ours
constexpr std::size_t kArrayAlign = 64;  // of the numbers in a file of NumPy: its format asks for it
constexpr const char* kHead = "{\n  \"filetype\": \"mortise camera\"";

bool writes(const Params& camera, const char* what) {
  const Params* outputs = camera.find("outputs");
  if (outputs == nullptr) return std::string(what) == "color";
  return std::any_of(outputs->items().begin(), outputs->items().end(), [&](const Params& o) { return o.as_text() == what; });
}

Json row(const Vec3& v, double w) { return {v[0], v[1], v[2], w}; }

}  // namespace

CameraFiles camera_files(const Params& camera, const std::string& name, long frame) {
  CameraFiles out;
  out.file = fmt::format("{}_{:04}.json", name, frame);
  if (writes(camera, "color")) out.color = fmt::format("{}_{:04}.png", name, frame);
  if (writes(camera, "depth")) out.depth = fmt::format("{}_depth_{:04}.png", name, frame);
  if (writes(camera, "depth_float")) out.depth_float = fmt::format("{}_depth_{:04}.npy", name, frame);
  if (writes(camera, "segmentation")) out.segmentation = fmt::format("{}_segmentation_{:04}.png", name, frame);
  return out;
}

double depth_unit(const Params& camera) { return camera.has("depth_unit") ? camera.number("depth_unit") : kDepthUnit; }

// Hues a golden section of the circle apart, so that neighbours in the list look unlike; every third is darker, every third paler.
std::array<std::uint8_t, 3> label_color(int id) {
  if (id == 0) return {0, 0, 0};
  const double hue = 6 * std::fmod(0.11 + 0.6180339887 * (id - 1), 1.0), saturation = id % 3 == 2 ? 0.5 : 0.85, value = id % 3 == 0 ? 0.62 : 0.95;
  std::array<std::uint8_t, 3> out{};
  for (int c = 0; c < 3; ++c) {
    const double k = std::fmod(5 - 2 * c + hue, 6.0), part = std::clamp(std::min(k, 4 - k), 0.0, 1.0);
    out[static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(std::lround(255 * value * (1 - saturation * part)));
  }
  return out;
}

render::GrayImage depth_image(const render::Measurement& seen, double unit) {
  render::GrayImage out{seen.width, seen.height, {}};
  out.values.reserve(seen.distance.size());
  for (const double d : seen.distance) {
    const double counts = std::round(d / unit);
    out.values.push_back(counts <= 65535 ? static_cast<std::uint16_t>(counts) : std::uint16_t{0});
  }
  return out;
}

// NumPy's format 1.0: magic, version, length of the header, a Python dictionary padded with blanks, the numbers.
std::string depth_array(const render::Measurement& seen) {
  std::string header = fmt::format("{}{}, {}), }}", kArrayHeader, seen.height, seen.width);
  std::string out = kArrayMagic;
  out.push_back('\0');
  constexpr std::size_t kLength = 2;
  header.append(kArrayAlign - (out.size() + kLength + header.size() + 1) % kArrayAlign, ' ');
  header.push_back('\n');
  out.push_back(static_cast<char>(header.size() & 255)), out.push_back(static_cast<char>(header.size() >> 8));
  out += header;
  std::vector<float> metres(seen.distance.begin(), seen.distance.end());
  out.append(reinterpret_cast<const char*>(metres.data()), sizeof(float) * metres.size());
  return out;
}

render::IndexedImage segmentation_image(const render::Measurement& seen, std::size_t bodies) {
  render::IndexedImage out{seen.width, seen.height, {}, {}};
  for (std::size_t id = 0; id <= bodies; ++id) out.colours.push_back(label_color(static_cast<int>(id)));
  for (const int id : seen.id) out.indices.push_back(static_cast<std::uint8_t>(id));
  return out;
}

render::GrayImage segmentation_counts(const render::Measurement& seen) {
  render::GrayImage out{seen.width, seen.height, {}};
  for (const int id : seen.id) out.values.push_back(static_cast<std::uint16_t>(id));
  return out;
}

std::string camera_json(const CameraFiles& files, const Params& camera, const std::string& name, const render::RenderJob& job,
                        const std::vector<render::BodyLabel>& bodies, long frame, double time) {
  const bool fisheye = job.camera.model == render::Camera::Model::fisheye;
  const render::Intrinsics k = render::intrinsics_of(job);
  const render::Pose pose = render::pose_of(job.camera);
  const Vec3& at = job.camera.position;
  Json j;
  j["filetype"] = "mortise camera";
  j["version"] = {1, 0};
  j["camera"] = name;
  j["frame"] = frame;
  j["time_s"] = time;
  j["width"] = job.width;
  j["height"] = job.height;
  j["model"] = fisheye ? "fisheye" : "pinhole";
  j["fx"] = k.fx, j["fy"] = k.fy, j["cx"] = k.cx, j["cy"] = k.cy;
  j["distortion_model"] = fisheye ? "equidistant" : "plumb_bob";
  j["distortion"] = std::vector<double>(fisheye ? 4 : 5, 0.0);
  if (fisheye) j["image_circle_radius"] = 0.5 * std::min(job.width, job.height);
  j["camera_to_world"] = Json::array();
  for (int i = 0; i < 3; ++i) j["camera_to_world"].push_back(row(Vec3(pose.right[i], pose.down[i], pose.forward[i]), at[i]));
  j["camera_to_world"].push_back(row(Vec3::Zero(), 1));
  j["axes"] = "x right, y down, z forward (OpenCV, ROS optical frame); lengths in m; pixel (0, 0) is the middle of the upper left pixel";
  if (const Params* carrier = camera.find("rides_on")) j["rides_on"] = carrier->as_text();
  if (!files.color.empty()) j["color"] = {{"file", files.color}};
  if (!files.depth.empty()) {
    j["depth"] = {{"file", files.depth}, {"unit_m", depth_unit(camera)}, {"measures", fisheye ? "distance along the ray" : "z"}, {"nothing", 0}};
  }
  if (!files.depth_float.empty())
    j["depth_float"] = {{"file", files.depth_float}, {"unit_m", 1}, {"measures", fisheye ? "distance along the ray" : "z"}, {"nothing", "inf"}};
  if (!files.segmentation.empty()) {
    Json& s = j["segmentation"] = {{"file", files.segmentation}, {"nothing", 0}, {"bodies", Json::array()}};
    for (const render::BodyLabel& b : bodies) s["bodies"].push_back({{"id", b.id}, {"name", b.name}, {"type", b.type}, {"color", label_color(b.id)}});
  }
  return json_text(j, 2) + "\n";
}

bool is_our_camera_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string head(std::string(kHead).size(), '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  return in && head == kHead;
}
bool is_our_depth_array(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string head(10 + std::string(kArrayHeader).size(), '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  return in && head.rfind(kArrayMagic, 0) == 0 && head.substr(10) == kArrayHeader;
}

}  // namespace mortise::run
