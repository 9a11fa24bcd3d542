#include "exporters/gltf.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "exporters/glb.h"
#include "geometry/bounds.h"
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
  Vec3 centre = Vec3::Zero();                       // of the mesh at the start; origin of a stiff body's node
  render::DrawMesh start;                           // soft: of the first frame
  std::vector<Key> keys;                            // stiff
  std::vector<std::vector<Vec3>> points, normals;   // soft: of each further frame, less those of the first
  std::vector<std::vector<std::uint16_t>> colours;  // of every frame, where a field colours the bodies
  bool changes_colour() const {
    return std::any_of(colours.begin(), colours.end(), [&](const auto& c) { return c != colours[0]; });
  }
};

Json array(const Vec3& v) { return {v[0], v[1], v[2]}; }
Json array(const Eigen::Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }

double size_of(const std::vector<Vec3>& points) { return points.empty() ? 0 : geometry::bounds_of(points).size().norm(); }

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
      const geometry::Bounds box = geometry::bounds_of(t.start.points);
      if (!t.start.points.empty()) t.centre = 0.5 * (box.lo + box.hi);
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
      for (const Vec3& p : mesh.points) box_.include(p);
    }
    if (frames_.colouring) colour(k);
    for (auto& [name, track] : cameras_) {
      const render::Camera camera = view_.camera(name);
      const render::Pose pose = render::pose_of(camera);
      Mat3 axes;  // glTF's look along -z, with y up
      axes << pose.right, -pose.down, -pose.forward;
      add_key(track, camera.position, axes);
    }
  }

  void colour(std::size_t k) {
    const std::vector<std::vector<double>> values = view_.at_vertices(frames_.colouring->values(k));
    for (std::size_t b = 0; b < values.size(); ++b) {
      std::vector<std::uint16_t>& out = tracks_[b].colours.emplace_back();
      for (const double v : values[b]) {
        const std::uint8_t* srgb = frames_.colouring->srgb(v);
        for (int c = 0; c < 3; ++c) out.push_back(static_cast<std::uint16_t>(std::lround(65535 * render::linear_of_srgb(srgb[c] / 255.0))));
        out.push_back(65535);
      }
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

  // What meshes of one body share: texture coordinates, and a primitive per material. Of one whose colours are those of a field the materials are
  // white: they are multiplied.
  struct Parts {
    Json attributes = Json::object(), primitives = Json::array();
  };
  Parts parts_of(const render::DrawMesh& m, const std::string& name, bool coloured) {
    Parts out;
    if (!m.uvs.empty() && !coloured) out.attributes["TEXCOORD_0"] = file_.uvs(m.uvs);
    for (std::size_t k = 0; k < m.materials.size(); ++k) {
      std::vector<std::uint32_t> corners;
      for (std::size_t t = 0; t < m.triangles.size(); ++t)
        if ((m.material.empty() ? 0 : m.material[t]) == static_cast<Index>(k))
          for (const Index v : m.triangles[t].v) corners.push_back(static_cast<std::uint32_t>(v));
      if (corners.empty()) continue;
      render::Material look = m.materials[k];
      if (coloured) look.colour = Vec3::Ones(), look.texture = nullptr;
      out.primitives.push_back(
          {{"indices", file_.indices(corners)}, {"material", material(look, m.materials.size() == 1 ? name : name + "_" + std::to_string(k))}});
    }
    return out;
  }

  int mesh(const Parts& parts, const Json& attributes, const std::string& name, const std::vector<Json>& targets) {
    Json primitives = parts.primitives;
    for (Json& one : primitives) {
      one["attributes"] = parts.attributes;
      one["attributes"].update(attributes);
      if (!targets.empty()) one["targets"] = targets;
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

  Json placed(const std::vector<Vec3>& points, const std::vector<Vec3>& normals) {
    return {{"POSITION", file_.vectors(points)}, {"NORMAL", file_.vectors(normals)}};
  }
  // All of a mesh at once; `colours` may be empty.
  int mesh(const render::DrawMesh& m, const std::string& name, const std::vector<Json>& targets,
           const std::vector<std::vector<std::uint16_t>>& colours = {}) {
    const Parts parts = parts_of(m, name, !colours.empty());
    Json attributes = placed(m.points, m.normals);
    if (!colours.empty()) attributes["COLOR_0"] = file_.colours(colours[0]);
    return mesh(parts, attributes, name, targets);
  }

  void animate(const Track& t, const char* path, int values) {
    if (times_ < 0) {
      std::vector<float> seconds;
      for (std::size_t k = 0; k < frames_.times.size(); ++k) seconds.push_back(static_cast<float>(second(k)));
      times_ = file_.numbers(seconds);
    }
    channel(t.node, path, times_, values, "LINEAR");
  }
  void channel(int node, const char* path, int times, int values, const char* interpolation) {
    samplers_.push_back({{"input", times}, {"interpolation", interpolation}, {"output", values}});
    channels_.push_back({{"sampler", samplers_.size() - 1}, {"target", {{"node", node}, {"path", path}}}});
  }

  double second(std::size_t k) const { return fps_ > 0 ? static_cast<double>(k) / fps_ : frames_.times[k] - frames_.times[0]; }

  // Colours that change: no program interpolates them, so every frame has a mesh of its own under the body's node, of which one after the other is of
  // full size and all others of none.
  void flip_book(Track& t, const std::string& name) {
    const Parts parts = parts_of(t.start, name, true);
    const Json at_rest = t.soft ? Json() : placed(t.start.points, t.start.normals);
    for (std::size_t k = 0; k < t.colours.size(); ++k) {
      Json attributes = at_rest;
      if (t.soft) {
        std::vector<Vec3> points = t.start.points, normals = t.start.normals;
        for (std::size_t i = 0; k > 0 && i < points.size(); ++i)
          points[i] += t.points[k - 1][i], normals[i] = (normals[i] + t.normals[k - 1][i]).normalized();
        attributes = placed(points, normals);
      }
      attributes["COLOR_0"] = file_.colours(t.colours[k]);
      const std::string called = name + " frame " + std::to_string(frames_.numbers[k]);
      const double size = k == 0 ? 1 : 0;
      nodes_.push_back({{"name", called}, {"mesh", mesh(parts, attributes, called, {})}, {"scale", {size, size, size}}});
      const int node = static_cast<int>(nodes_.size());
      nodes_[static_cast<std::size_t>(t.node - 1)]["children"].push_back(node);
      std::vector<float> times, sizes;
      const auto key = [&](std::size_t frame, float value) {
        times.push_back(static_cast<float>(second(frame)));
        for (int c = 0; c < 3; ++c) sizes.push_back(value);
      };
      if (k > 0) key(0, 0);
      key(k, 1);
      if (k + 1 < t.colours.size()) key(k + 1, 0);
      channel(node, "scale", file_.numbers(times), file_.numbers(sizes, "VEC3"), "STEP");
    }
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
    if (t.changes_colour()) return flip_book(t, name);
    double way = 0;
    for (const auto& frame : t.points)
      for (const Vec3& p : frame) way = std::max(way, p.norm());
    std::vector<Json> targets;
    if (way > kStill * size_of(t.start.points))
      for (std::size_t k = 0; k < t.points.size(); ++k) {
        targets.push_back({{"POSITION", file_.vectors(t.points[k])}, {"NORMAL", file_.vectors(t.normals[k])}});
        t.points[k] = {}, t.normals[k] = {};
      }
    nodes_[static_cast<std::size_t>(t.node - 1)]["mesh"] = mesh(t.start, name, targets, t.colours);
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
    const Vec3 n = g.normal.normalized(), u = n.unitOrthogonal(), v = n.cross(u), middle = empty() ? g.point : Vec3(0.5 * (box_.lo + box_.hi));
    const Vec3 foot = middle - n.dot(middle - g.point) * n;
    const double reach = empty() ? 1 : kPlaneReach * 0.5 * box_.size().norm();
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
      if (t.changes_colour())
        flip_book(t, bodies[b].label->name);
      else
        nodes_[static_cast<std::size_t>(t.node - 1)]["mesh"] = mesh(t.start, bodies[b].label->name, {}, t.colours);
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
  geometry::Bounds box_;  // of all that was seen
  bool empty() const { return box_.lo[0] > box_.hi[0]; }
  std::map<const render::Texture*, int> textures_;
  std::vector<Json> samplers_, channels_;
  int times_ = -1, weights_ = -1;
};

}  // namespace

void write_gltf(const std::string& path, render::SceneView& view, const Frames& frames, const Params& scene, double fps) {
  Writer(view, frames, scene, fps).write(path);
}

}  // namespace mortise::exporters
