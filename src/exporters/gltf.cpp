#include "exporters/gltf.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "exporters/glb.h"
#include "render/camera.h"
#include "render/colour_map.h"

namespace mortise::exporters {
namespace {

using Json = Glb::Json;

constexpr double kStill = 1e-9;    // a body of this size that moves by less, in its lengths, stands still
constexpr double kPlaneReach = 3;  // half the edge of a half space's square, in radii of the scene
constexpr double kNearest = 1e-3;  // of a camera, in distances to what it looks at

struct Key {
  Vec3 place;
  Eigen::Quaterniond turn;
};

// A body's node while frames go by.
struct Track {
  int node = -1;
  bool soft = false;
  Vec3 centre = Vec3::Zero();                      // of the mesh at the start; origin of a stiff body's node
  render::DrawMesh start;                          // soft: of the first frame
  std::vector<Key> keys;                           // stiff
  std::vector<std::vector<Vec3>> points, normals;  // soft: of each further frame, less those of the first
};

Json array(const Vec3& v) { return {v[0], v[1], v[2]}; }
Json array(const Eigen::Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }

double size_of(const std::vector<Vec3>& points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points) box.extend(p);
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

class Writer {
 public:
  Writer(render::SceneView& view, const Frames& frames, const Params& scene, double fps) : view_(view), frames_(frames), scene_(scene), fps_(fps) {}

  void write(const std::string& path) {
    file_.json["asset"]["generator"] = "mortise";
    const std::size_t n = frames_.numbers.size();
    begin();
    for (std::size_t k = 0; k < n; ++k) {
      view_.move(frames_.points(k));
      see(k);
    }
    finish();
    file_.write(path);
  }

 private:
  int add_node(Json node) {
    nodes_.push_back(std::move(node));
    children_.push_back(nodes_.size());  // the root is node 0
    return static_cast<int>(nodes_.size());
  }

  // Stiff bodies keep the mesh of the start: nothing has moved yet.
  void begin() {
    for (const render::SceneView::Moved& body : view_.moved()) {
      Track& t = tracks_.emplace_back();
      t.soft = body.label->type == "soft";
      t.node = add_node({{"name", body.label->name}});
      if (t.soft) continue;
      t.start = *body.mesh;
      Eigen::AlignedBox3d box;
      for (const Vec3& p : t.start.points) box.extend(p);
      t.centre = box.isEmpty() ? Vec3(0, 0, 0) : Vec3(box.center());
      for (Vec3& p : t.start.points) p -= t.centre;
    }
    if (const Params* render = scene_.find("render"); render != nullptr && render->has("cameras"))
      for (const std::string& name : view_.cameras()) {
        const render::Camera camera = view_.camera(name);
        if (camera.model != render::Camera::Model::pinhole) continue;  // glTF has no other
        const double distance = (camera.look_at - camera.position).norm();
        const double aspect = static_cast<double>(render->integer("width")) / static_cast<double>(render->integer("height"));
        file_.json["cameras"].push_back({{"type", "perspective"},
                                         {"name", name},
                                         {"perspective", {{"yfov", camera.fov}, {"aspectRatio", aspect}, {"znear", kNearest * distance}}}});
        cameras_.emplace_back(name, Track{});
        cameras_.back().second.node = add_node({{"name", name}, {"camera", file_.json["cameras"].size() - 1}});
      }
  }

  void see(std::size_t k) {
    const std::vector<render::SceneView::Moved> moved = view_.moved();
    for (std::size_t b = 0; b < moved.size(); ++b) {
      Track& t = tracks_[b];
      const render::DrawMesh& mesh = *moved[b].mesh;
      if (!t.soft) {
        add_key(t, moved[b].motion.R * t.centre + moved[b].motion.t, moved[b].motion.R);
      } else if (k == 0) {
        t.start = mesh;
      } else {
        std::vector<Vec3> points(mesh.points.size()), normals(mesh.points.size());
        for (std::size_t i = 0; i < points.size(); ++i)
          points[i] = mesh.points[i] - t.start.points[i], normals[i] = mesh.normals[i] - t.start.normals[i];
        t.points.push_back(std::move(points)), t.normals.push_back(std::move(normals));
      }
      for (const Vec3& p : mesh.points) box_.extend(p);
    }
    for (auto& [name, track] : cameras_) {
      const render::Camera camera = view_.camera(name);
      const render::Pose pose = render::pose_of(camera);
      Mat3 axes;  // glTF's look along -z, with y up
      axes << pose.right, -pose.down, -pose.forward;
      add_key(track, camera.position, axes);
    }
  }

  static void add_key(Track& t, const Vec3& place, const Mat3& turn) {
    Eigen::Quaterniond q(turn);
    q.normalize();
    if (!t.keys.empty() && q.dot(t.keys.back().turn) < 0) q.coeffs() = -q.coeffs();  // the short way round
    t.keys.push_back({place, q});
  }

  int material(const render::Material& m, const std::string& name) {
    Json pbr = {{"baseColorFactor", {m.colour[0], m.colour[1], m.colour[2], 1.0}}, {"metallicFactor", m.metallic}, {"roughnessFactor", m.roughness}};
    if (m.texture) {
      const auto [known, fresh] = textures_.try_emplace(m.texture.get(), 0);
      if (fresh) known->second = file_.image(render::png_bytes(*m.texture));
      pbr["baseColorTexture"] = {{"index", known->second}};
    }
    file_.json["materials"].push_back({{"name", name}, {"pbrMetallicRoughness", std::move(pbr)}, {"doubleSided", true}});
    return static_cast<int>(file_.json["materials"].size()) - 1;
  }

  // One primitive per material; all of them share the vertices.
  int mesh(const render::DrawMesh& m, const std::string& name, const std::vector<Json>& targets) {
    Json attributes = {{"POSITION", file_.vectors(m.points)}, {"NORMAL", file_.vectors(m.normals)}};
    if (!m.uvs.empty()) attributes["TEXCOORD_0"] = file_.uvs(m.uvs);
    Json primitives = Json::array();
    for (std::size_t k = 0; k < m.materials.size(); ++k) {
      std::vector<std::uint32_t> corners;
      for (std::size_t t = 0; t < m.triangles.size(); ++t)
        if ((m.material.empty() ? 0 : m.material[t]) == static_cast<Index>(k))
          for (const Index v : m.triangles[t].v) corners.push_back(static_cast<std::uint32_t>(v));
      if (corners.empty()) continue;
      Json one = {{"attributes", attributes}, {"indices", file_.indices(corners)}};
      one["material"] = material(m.materials[k], m.materials.size() == 1 ? name : name + "_" + std::to_string(k));
      if (!targets.empty()) one["targets"] = targets;
      primitives.push_back(std::move(one));
    }
    Json whole = {{"name", name}, {"primitives", std::move(primitives)}};
    if (!targets.empty()) {
      whole["weights"] = std::vector<int>(targets.size(), 0);
      for (std::size_t k = 1; k < frames_.numbers.size(); ++k)
        whole["extras"]["targetNames"].push_back("frame " + std::to_string(frames_.numbers[k]));
    }
    file_.json["meshes"].push_back(std::move(whole));
    return static_cast<int>(file_.json["meshes"].size()) - 1;
  }

  void animate(const Track& t, const char* path, int values) {
    if (times_ < 0) {
      std::vector<float> seconds;
      for (std::size_t k = 0; k < frames_.times.size(); ++k)
        seconds.push_back(static_cast<float>(fps_ > 0 ? static_cast<double>(k) / fps_ : frames_.times[k] - frames_.times[0]));
      times_ = file_.numbers(seconds);
    }
    samplers_.push_back({{"input", times_}, {"interpolation", "LINEAR"}, {"output", values}});
    channels_.push_back({{"sampler", samplers_.size() - 1}, {"target", {{"node", t.node}, {"path", path}}}});
  }

  void place(const Track& t, double length) {
    Json& node = nodes_[static_cast<std::size_t>(t.node - 1)];
    node["translation"] = array(t.keys[0].place);
    node["rotation"] = array(t.keys[0].turn);
    double way = 0, turned = 0;
    std::vector<float> places, turns;
    for (const Key& k : t.keys) {
      way = std::max(way, (k.place - t.keys[0].place).norm());
      turned = std::max(turned, (k.turn.coeffs() - t.keys[0].turn.coeffs()).norm());
      for (int c = 0; c < 3; ++c) places.push_back(static_cast<float>(k.place[c]));
      for (int c = 0; c < 4; ++c) turns.push_back(static_cast<float>(k.turn.coeffs()[c]));
    }
    if (way > kStill * length) animate(t, "translation", file_.numbers(places, "VEC3"));
    if (turned > kStill) animate(t, "rotation", file_.numbers(turns, "VEC4"));
  }

  void soft(Track& t, const std::string& name) {
    double way = 0;
    for (const auto& frame : t.points)
      for (const Vec3& p : frame) way = std::max(way, p.norm());
    std::vector<Json> targets;
    if (way > kStill * size_of(t.start.points))
      for (std::size_t k = 0; k < t.points.size(); ++k) {
        targets.push_back({{"POSITION", file_.vectors(t.points[k])}, {"NORMAL", file_.vectors(t.normals[k])}});
        t.points[k] = {}, t.normals[k] = {};
      }
    nodes_[static_cast<std::size_t>(t.node - 1)]["mesh"] = mesh(t.start, name, targets);
    if (targets.empty()) return;
    if (weights_ < 0) {  // of frame k the target k - 1 alone; the same for all bodies
      const std::size_t n = frames_.numbers.size();
      std::vector<float> weights(n * (n - 1), 0);
      for (std::size_t k = 1; k < n; ++k) weights[k * (n - 1) + k - 1] = 1;
      weights_ = file_.numbers(weights);
    }
    animate(t, "weights", weights_);
  }

  void plane(const render::BodyLabel& label, const render::GroundPlane& g) {
    const Vec3 n = g.normal.normalized(), u = n.unitOrthogonal(), v = n.cross(u), middle = box_.isEmpty() ? g.point : Vec3(box_.center());
    const Vec3 foot = middle - n.dot(middle - g.point) * n;
    const double reach = box_.isEmpty() ? 1 : kPlaneReach * 0.5 * box_.diagonal().norm();
    render::DrawMesh m;
    m.points = {-reach * u - reach * v, reach * u - reach * v, reach * u + reach * v, -reach * u + reach * v};
    m.normals.assign(4, n);
    m.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
    m.materials[0].colour = Vec3(render::linear_of_srgb(g.colour[0]), render::linear_of_srgb(g.colour[1]), render::linear_of_srgb(g.colour[2]));
    m.materials[0].roughness = 1;
    const int index = mesh(m, label.name, {});
    add_node({{"name", label.name}, {"mesh", index}, {"translation", array(foot)}});
  }

  void finish() {
    const std::vector<render::SceneView::Moved> bodies = view_.moved();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      Track& t = tracks_[b];
      if (t.soft) {
        soft(t, bodies[b].label->name);
        continue;
      }
      nodes_[static_cast<std::size_t>(t.node - 1)]["mesh"] = mesh(t.start, bodies[b].label->name, {});
      place(t, size_of(t.start.points));
    }
    for (const auto& [name, track] : cameras_) place(track, 1);
    for (const auto& [label, g] : view_.planes()) plane(*label, g);
    const Eigen::Quaterniond upright(Eigen::AngleAxisd(-0.5 * M_PI, Vec3::UnitX()));  // z up -> y up
    Json root = {{"name", scene_.text("name")}, {"rotation", array(upright)}, {"children", children_}};
    file_.json["nodes"] = Json::array({std::move(root)});
    for (Json& node : nodes_) file_.json["nodes"].push_back(std::move(node));
    file_.json["scene"] = 0;
    file_.json["scenes"] = Json::array({{{"name", scene_.text("name")}, {"nodes", {0}}}});
    if (!channels_.empty()) file_.json["animations"] = Json::array({{{"name", "run"}, {"samplers", samplers_}, {"channels", channels_}}});
  }

  render::SceneView& view_;
  const Frames& frames_;
  const Params& scene_;
  double fps_;
  Glb file_;
  std::vector<Json> nodes_;
  std::vector<std::size_t> children_;
  std::vector<Track> tracks_;
  std::vector<std::pair<std::string, Track>> cameras_;
  Eigen::AlignedBox3d box_;
  std::map<const render::Texture*, int> textures_;
  std::vector<Json> samplers_, channels_;
  int times_ = -1, weights_ = -1;
};

}  // namespace

void write_gltf(const std::string& path, render::SceneView& view, const Frames& frames, const Params& scene, double fps) {
  Writer(view, frames, scene, fps).write(path);
}

}  // namespace mortise::exporters
