#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "export_sample.h"
#include "exporters/film.h"
#include "exporters/gltf.h"
#include "exporters/obj.h"
#include "geometry/io/read.h"
#include "render/image.h"

namespace fs = std::filesystem;

namespace mortise::exporters {
namespace {

using Json = nlohmann::json;

class Exporters : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  const std::string folder_ = (fs::temp_directory_path() / ("mortise_export_" + std::to_string(getpid()))).string();
  test::Sample sample_;
};

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// The two chunks of a .glb, taken apart by hand.
struct Glb {
  Json json;
  std::string buffer;
  explicit Glb(const std::string& path) {
    const std::string all = bytes_of(path);
    const auto number = [&](std::size_t at) {
      std::uint32_t v = 0;
      std::memcpy(&v, all.data() + at, 4);
      return v;
    };
    EXPECT_EQ(all.substr(0, 4), "glTF");
    EXPECT_EQ(number(4), 2u);
    EXPECT_EQ(number(8), all.size());
    json = Json::parse(all.substr(20, number(12)));
    EXPECT_EQ(all.substr(16, 4), "JSON");
    const std::size_t second = 20 + number(12);
    EXPECT_EQ(second % 4, 0u);
    EXPECT_EQ(all.substr(second + 4, 3), "BIN");
    buffer = all.substr(second + 8);
    EXPECT_EQ(buffer.size(), json["buffers"][0]["byteLength"].get<std::size_t>());
  }
  std::vector<float> floats(const Json& index) const {
    const Json& a = json["accessors"][index.get<std::size_t>()];
    const Json& v = json["bufferViews"][a["bufferView"].get<std::size_t>()];
    std::vector<float> out(v["byteLength"].get<std::size_t>() / 4);
    std::memcpy(out.data(), buffer.data() + v["byteOffset"].get<std::size_t>(), 4 * out.size());
    return out;
  }
  const Json& node(const std::string& name) const {
    for (const Json& n : json["nodes"])
      if (n["name"] == name) return n;
    throw std::runtime_error("no node " + name);
  }
  // Keys of a node's channel; empty: it has none.
  std::vector<float> keys(const std::string& name, const std::string& path) const {
    for (const Json& c : json["animations"][0]["channels"])
      if (json["nodes"][c["target"]["node"].get<std::size_t>()]["name"] == name && c["target"]["path"] == path)
        return floats(json["animations"][0]["samplers"][c["sampler"].get<std::size_t>()]["output"]);
    return {};
  }
};

TEST_F(Exporters, GltfHasANodePerBodyAndMovesThem) {
  render::SceneView view(sample_.root, sample_.bodies);
  write_gltf(folder_ + "/a.glb", view, sample_.frames, sample_.root, 0);
  const Glb glb(folder_ + "/a.glb");
  const std::vector<float> times = glb.floats(glb.json["animations"][0]["samplers"][0]["input"]);
  ASSERT_EQ(times.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(times[k], 0.1 * static_cast<double>(k), 1e-6);
  EXPECT_EQ(glb.json["nodes"].size(), 7u) << "a root, four bodies, two pinhole cameras";
  EXPECT_TRUE(glb.keys("post", "translation").empty() && glb.keys("post", "rotation").empty()) << "what stands still has no keys";
  EXPECT_TRUE(glb.keys("fixed", "translation").empty());
  const std::vector<float> way = glb.keys("urchin", "translation"), turn = glb.keys("urchin", "rotation");
  ASSERT_EQ(way.size(), 9u);
  ASSERT_EQ(turn.size(), 12u);
  const float half = std::sqrt(0.5f);
  const float expected[12] = {0, 0, 0, 1, 0, 0, half, half, 0, 0, 1, 0};
  for (std::size_t k = 0; k < 12; ++k) EXPECT_NEAR(turn[k], expected[k], 1e-6) << k;
  const std::vector<float> eye = glb.keys("riding", "translation");
  ASSERT_EQ(eye.size(), 9u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(eye[3 * k + 2], 5 + 3 * static_cast<double>(k), 1e-5) << "rides on the urchin";
  EXPECT_NEAR(glb.json["cameras"][0]["perspective"]["yfov"].get<double>(), 0.5, 1e-12);
  EXPECT_NEAR(glb.json["cameras"][0]["perspective"]["aspectRatio"].get<double>(), 2, 1e-12);
}

// Where nodes, targets and weights of each frame put the vertices, against where pictures draw them.
TEST_F(Exporters, GltfPutsEveryVertexWherePicturesDrawIt) {
  render::SceneView view(sample_.root, sample_.bodies);
  write_gltf(folder_ + "/a.glb", view, sample_.frames, sample_.root, 0);
  const Glb glb(folder_ + "/a.glb");
  for (std::size_t f = 0; f < 3; ++f) {
    view.move(sample_.points[f]);
    for (const render::SceneView::Moved& body : view.moved()) {
      const Json& node = glb.node(body.label->name);
      const Json& mesh = glb.json["meshes"][node["mesh"].get<std::size_t>()];
      const Json& primitive = mesh["primitives"][0];
      const std::vector<float> base = glb.floats(primitive["attributes"]["POSITION"]);
      ASSERT_EQ(base.size(), 3 * body.mesh->points.size());
      std::vector<float> place = glb.keys(body.label->name, "translation"), turn = glb.keys(body.label->name, "rotation");
      const std::vector<float> weights = glb.keys(body.label->name, "weights");
      const std::size_t targets = primitive.contains("targets") ? primitive["targets"].size() : 0;
      EXPECT_EQ(targets, body.label->type == "soft" ? 2u : 0u);
      if (place.empty() && node.contains("translation")) place = node["translation"].get<std::vector<float>>();
      if (turn.empty() && node.contains("rotation")) turn = node["rotation"].get<std::vector<float>>();
      const std::size_t at = place.size() > 3 ? 3 * f : 0, angle = turn.size() > 4 ? 4 * f : 0;
      for (std::size_t i = 0; i < body.mesh->points.size(); ++i) {
        Vec3 x(base[3 * i], base[3 * i + 1], base[3 * i + 2]);
        for (std::size_t t = 0; t < targets; ++t) {
          const std::vector<float> target = glb.floats(primitive["targets"][t]["POSITION"]);
          x += weights[f * targets + t] * Vec3(target[3 * i], target[3 * i + 1], target[3 * i + 2]);
        }
        if (!turn.empty()) x = Eigen::Quaterniond(turn[angle + 3], turn[angle], turn[angle + 1], turn[angle + 2]) * x;
        if (!place.empty()) x += Vec3(place[at], place[at + 1], place[at + 2]);
        ASSERT_LT((x - body.mesh->points[i]).norm(), 2e-6) << body.label->name << " " << i << " frame " << f;
      }
    }
  }
}

TEST_F(Exporters, GltfKeepsMaterialsTexturesAndTextureCoordinates) {
  render::SceneView view(sample_.root, sample_.bodies);
  write_gltf(folder_ + "/a.glb", view, sample_.frames, sample_.root, 24);
  const Glb glb(folder_ + "/a.glb");
  const std::vector<float> times = glb.floats(glb.json["animations"][0]["samplers"][0]["input"]);
  EXPECT_NEAR(times[2], 2 / 24.0, 1e-6) << "one frame after the other";
  const geometry::VisualMesh read = geometry::read_visual(folder_ + "/a.glb");  // by assimp
  const auto named = [&](const std::string& name) {
    for (const geometry::VisualMaterial& m : read.materials)
      if (m.name == name) return m;
    return geometry::VisualMaterial{};
  };
  EXPECT_LT((named("pad").base_color - Vec3(1, 0, 0)).norm(), 1e-6);
  EXPECT_NEAR(named("pad").roughness, 0.25, 1e-6);
  EXPECT_NEAR(named("pad").metallic, 1, 1e-6);
  EXPECT_LT((named("floor").base_color - Vec3(0, 0, 1)).norm(), 1e-6);
  ASSERT_FALSE(named("urchin").texture.bytes.empty());
  view.move(sample_.points[0]);
  const render::DrawMesh& urchin = *view.moved()[0].mesh;
  const render::Texture there = render::read_texture(named("urchin").texture.bytes, "embedded"), here = *urchin.materials[0].texture;
  EXPECT_EQ(there.rgba, here.rgba);
  // Vertices with their texture coordinates: y up in the file, z up here.
  std::size_t found = 0;
  for (std::size_t i = 0; i < urchin.points.size(); i += 97)
    for (std::size_t j = 0; j < read.points.size(); ++j) {
      const Vec3 x(read.points[j][0], -read.points[j][2], read.points[j][1]);
      if ((x - urchin.points[i]).norm() < 1e-5 && (read.uvs[j] - urchin.uvs[i]).norm() < 1e-5) {
        ++found;
        break;
      }
    }
  EXPECT_EQ(found, (urchin.points.size() + 96) / 97);
}

TEST_F(Exporters, ObjFilesHoldEachFrame) {
  render::SceneView view(sample_.root, sample_.bodies);
  write_objs(folder_ + "/run", view, sample_.frames);
  EXPECT_TRUE(fs::exists(folder_ + "/run_texture_0.png"));
  for (int f = 0; f < 3; ++f) {
    const geometry::VisualMesh read = geometry::read_visual(obj_of_frame(folder_ + "/run", 10 * f));
    view.move(sample_.points[f]);
    std::size_t triangles = 0, t = 0;
    for (const render::SceneView::Moved& body : view.moved()) triangles += body.mesh->triangles.size();
    ASSERT_EQ(read.triangles.size(), triangles);
    for (const render::SceneView::Moved& body : view.moved())
      for (const Triangle& mine : body.mesh->triangles) {
        const Triangle& theirs = read.triangles[t];
        for (int k = 0; k < 3; ++k) {
          ASSERT_LT((read.points[theirs.v[k]] - body.mesh->points[mine.v[k]]).norm(), 1e-7) << body.label->name;
          ASSERT_LT((read.normals[theirs.v[k]] - body.mesh->normals[mine.v[k]]).norm(), 1e-4) << body.label->name;
          if (!body.mesh->uvs.empty()) {
            ASSERT_LT((read.uvs[theirs.v[k]] - body.mesh->uvs[mine.v[k]]).norm(), 1e-5);
          }
        }
        EXPECT_EQ(read.materials[read.material[t]].name, body.label->name);
        ++t;
      }
  }
}

TEST_F(Exporters, FilmsAreMadeOfOnePictureAfterTheOther) {
  render::Image image{20, 11, std::vector<std::uint8_t>(20 * 11 * 3, 90)};
  for (const long frame : {0, 12, 6}) {
    char name[64];
    std::snprintf(name, sizeof name, "/front_%04ld.png", frame);
    render::write_png(folder_ + name, image);
  }
  render::write_png(folder_ + "/front_depth_0000.png", render::GrayImage{2, 2, {1, 2, 3, 4}});
  render::write_png(folder_ + "/side_12.png", image);
  const auto series = picture_series(folder_);
  ASSERT_EQ(series.size(), 1u) << "depth is no picture, and two digits are no frame";
  ASSERT_EQ(series.at("front").size(), 3u);
  EXPECT_EQ(fs::path(series.at("front")[1]).filename(), "front_0006.png");

  // A program in ffmpeg's place that keeps what it was told.
  const std::string bin = folder_ + "/bin", path = std::getenv("PATH");
  fs::create_directories(bin);
  const auto play = [&](const std::string& script) {
    std::ofstream(bin + "/ffmpeg") << "#!/bin/sh\n" << script;
    fs::permissions(bin + "/ffmpeg", fs::perms::owner_all);
  };
  setenv("PATH", bin.c_str(), 1);
  const auto message = [&] {
    try {
      write_film(folder_ + "/it's.mp4", series.at("front"), 10);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::file);
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(message().find("ffmpeg, which is not installed"), std::string::npos);
  play("for a; do last=$a; done\nwhile read line; do echo \"$line\"; done < \"" + folder_ +
       "/it's.mp4.list\" > \"$last\"\necho \"$*\" >> \"$last\"\n");
  EXPECT_EQ(message(), "");
  const std::string told = bytes_of(folder_ + "/it's.mp4");
  EXPECT_NE(told.find("file '" + folder_ + "/front_0000.png'\nduration 0.1\nfile '" + folder_ + "/front_0006.png'\n"), std::string::npos) << told;
  EXPECT_NE(told.find("-frames:v 3 "), std::string::npos) << told;
  EXPECT_FALSE(fs::exists(folder_ + "/it's.mp4.list"));
  play("echo Unknown encoder libx264 >&2\nexit 3\n");
  EXPECT_NE(message().find("(exit code 3)\nUnknown encoder libx264"), std::string::npos);
  EXPECT_EQ(bytes_of(folder_ + "/it's.mp4"), told) << "what was there stays";
  setenv("PATH", path.c_str(), 1);
}

}  // namespace
}  // namespace mortise::exporters
