#include "render/from_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "geometry/io/read.h"
#include "geometry/placement.h"
#include "geometry/rigid_motion.h"
#include "render/camera.h"
#include "render/colour_map.h"
#include "render/overlay.h"
#include "scene/field_units.h"
#include "scene/quantity.h"
#include "visual/mapper.h"
#include "visual/normals.h"

namespace mortise::render {
namespace {

constexpr double kArrowLength = 0.125;  // of the longest arrow of traction, in heights of what the picture shows at the distance of look_at
constexpr double kLeastArrow = 0.02;    // shorter ones, in the longest, are left out: dots that say nothing
constexpr double kSquare = 0.2;         // edge of the squares on slopes, in the diagonal of all that is drawn at the start
constexpr double kCrease = 0.7;         // [rad] sharper edges of simulation surfaces are drawn sharp

Vec3 linear(const Vec3& srgb) { return {linear_of_srgb(srgb[0]), linear_of_srgb(srgb[1]), linear_of_srgb(srgb[2])}; }

// The look of a body that has no materials of its own.
Material material_of(const Params& visual) { return {linear(visual.vec3("color")), visual.number("roughness"), visual.number("metallic"), nullptr}; }

std::shared_ptr<const Texture> texture_of(const geometry::Texture& t, const std::string& name) {
  if (t.empty()) return nullptr;
  return std::make_shared<Texture>(t.bytes.empty() ? read_texture(t.file) : read_texture(t.bytes, name));
}

// A visual mesh in its place in its body, and with it in the scene.
DrawMesh read_draw_mesh(const Params& body) {
  const Params& visual = body.at("visual");
  const geometry::VisualMesh file = geometry::read_visual(visual.text("mesh"));
  const Params* shape = body.find("shape");
  const Params* mesh = shape != nullptr ? shape->find("mesh") : nullptr;
  const double scale = visual.has("scale") ? visual.number("scale") : mesh != nullptr ? mesh->number("scale") : 1;
  const geometry::Placement in_body(visual), in_scene(body);
  DrawMesh out;
  for (const Vec3& x : file.points) out.points.push_back(in_scene(in_body(scale * x)));
  for (const Vec3& n : file.normals) out.normals.push_back(in_scene.R * (in_body.R * n));
  if (file.has_uvs) out.uvs = file.uvs;
  out.triangles = file.triangles;
  out.material = file.material;
  out.materials.clear();
  // Materials of the file hold; where it names none the keys of `visual` do, and `visual.texture` replaces the file's.
  for (const geometry::VisualMaterial& m : file.materials)
    out.materials.push_back(m.name.empty() ? material_of(visual) : Material{m.base_color, m.roughness, m.metallic, texture_of(m.texture, m.name)});
  if (out.materials.empty()) out.materials.push_back(material_of(visual));
  if (const Params* texture = visual.find("texture")) {
    const auto picture = std::make_shared<Texture>(read_texture(texture->as_text()));
    for (Material& m : out.materials) m.texture = picture, m.colour = Vec3::Ones();
  }
  return out;
}

}  // namespace

struct SceneView::Body {
  std::string name;
  int id = 0;                       // of its label
  std::size_t first = 0;            // among all points
  std::vector<Vec3> points, start;  // now; at the start
  std::vector<Triangle> surface;    // of the simulation
  DrawMesh mesh;
  std::unique_ptr<visual::Mapper> mapper;  // with a visual mesh
  std::vector<Index> source;               // without: simulation point of each vertex
  std::unique_ptr<visual::SmoothNormals> normals;

  explicit Body(const model::BodyInput& input) : name(input.name), points(input.nodes), start(input.nodes), surface(input.triangles) {
    const Params& visual = input.params.at("visual");
    if (visual.has("mesh")) {
      mesh = read_draw_mesh(input.params);
      mapper = std::make_unique<visual::Mapper>(points, input.triangles, mesh.points);
    } else {
      visual::SplitSurface split = visual::split_creases(points, input.triangles, kCrease);
      source = std::move(split.source);
      mesh.triangles = std::move(split.triangles);
      mesh.normals = std::move(split.normals);
      mesh.materials = {material_of(visual)};
      gather();
    }
    normals = std::make_unique<visual::SmoothNormals>(mesh.points, mesh.normals, mesh.triangles);
  }

  void gather() {
    mesh.points.resize(source.size());
    for (std::size_t i = 0; i < source.size(); ++i) mesh.points[i] = points[source[i]];
  }

  void move(std::span<const double> all) {
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = Eigen::Map<const Vec3>(all.data() + 3 * (first + i));
    if (mapper)
      mapper->map(points, mesh.points);
    else
      gather();
    normals->compute(mesh.points, mesh.normals);
  }

  geometry::Motion motion() const { return geometry::nearest_motion(start, points); }

  std::vector<double> scalar(std::span<const double> all) const {
    const auto mine = all.subspan(first, points.size());
    std::vector<double> out;
    if (mapper) {
      mapper->interpolate(mine, out);
    } else {
      for (const Index i : source) out.push_back(mine[i]);
    }
    return out;
  }
};

Camera camera_of(const Params& p) {
  Camera c;
  c.position = p.vec3("position"), c.look_at = p.vec3("look_at"), c.up = p.vec3("up"), c.fov = p.number("fov");
  if (!has_pose(c)) c.up = Vec3::UnitY();  // straight down, and nothing is said of it (scene/tables.cpp)
  if (const Params* model = p.find("model"); model != nullptr && model->as_text() == "fisheye") c.model = Camera::Model::fisheye;
  return c;
}

GroundPlane ground_of(const Params& body) {
  GroundPlane g{body.vec3("point"), body.vec3("normal").normalized()};
  g.colour = body.at("visual").vec3("color");
  return g;
}

// Only what is drawn on a slope shows that it is one.
bool slopes(const GroundPlane& g) { return g.normal.cwiseAbs().maxCoeff() < 1 - 1e-6; }

ColourBar bar_of(const Params& camera, double low, double high) {
  ColourBar bar{camera.text("colour_by"), "", low, high, 1};
  std::replace(bar.label.begin(), bar.label.end(), '_', ' ');
  bar.unit = scene::unit_of_field(camera.text("colour_by")).symbol;
  const Params* unit = camera.find("unit");
  if (unit == nullptr || unit->as_text() == bar.unit) return bar;
  const scene::Quantity one = scene::parse_quantity("1 " + unit->as_text(), Unit::any);
  if (!one.error.empty()) throw Error(Exit::scene, unit->where(), "the unit of a colour scale " + one.error);
  bar.unit = unit->as_text(), bar.scale = 1 / one.value;
  return bar;
}

SceneView::SceneView(const Params& scene, const std::vector<model::BodyInput>& bodies)
    : render_(scene.has("render") ? scene.at("render") : Params::make_table()) {
  if (const Params* cameras = render_.find("cameras"))
    for (const auto& [name, camera] : cameras->entries()) cameras_.push_back(name);
  Eigen::AlignedBox3d box;
  for (const model::BodyInput& input : bodies) {
    labels_.push_back({static_cast<int>(labels_.size()) + 1, input.name, input.params.text("type")});
    if (input.type == model::BodyType::half_space) {
      planes_[input.name] = ground_of(input.params);
      planes_[input.name].id = labels_.back().id;
      continue;
    }
    try {
      bodies_.push_back(std::make_unique<Body>(input));
    } catch (const Error& e) {
      if (e.located()) throw;
      throw Error(e.code(), input.params.where(), "body '" + input.name + "': " + e.what());
    }
    bodies_.back()->id = labels_.back().id;
    bodies_.back()->first = points_;
    points_ += input.nodes.size();
    for (const Vec3& x : input.nodes) box.extend(x);
  }
  for (auto& [name, plane] : planes_)
    if (slopes(plane) && !box.isEmpty()) plane.checker = kSquare * box.diagonal().norm();
}

SceneView::~SceneView() = default;

void SceneView::move(std::span<const double> points) {
  if (points.size() != 3 * points_) throw Error(Exit::internal, "pictures got the positions of another model");
  for (const auto& body : bodies_) body->move(points);
}

std::vector<SceneView::Moved> SceneView::moved() const {
  std::vector<Moved> out;
  for (const auto& body : bodies_) out.push_back({&labels_[static_cast<std::size_t>(body->id - 1)], &body->mesh, body->motion()});
  return out;
}

std::vector<double> SceneView::magnitudes(const std::vector<double>& field) const {
  if (field.size() == points_) return field;
  std::vector<double> out;
  if (field.size() == 3 * points_)
    for (std::size_t i = 0; i < points_; ++i) out.push_back(Eigen::Map<const Vec3>(field.data() + 3 * i).norm());
  return out;
}

std::vector<std::vector<double>> SceneView::at_vertices(const std::vector<double>& field) const {
  const std::vector<double> one = magnitudes(field);
  std::vector<std::vector<double>> out;
  if (one.empty()) return out;
  for (const auto& body : bodies_) {
    out.push_back(body->scalar(one));
    for (double& v : out.back())
      if (!std::isfinite(v)) v = 0;
  }
  return out;
}

std::vector<std::pair<const BodyLabel*, GroundPlane>> SceneView::planes() const {
  std::vector<std::pair<const BodyLabel*, GroundPlane>> out;
  for (const auto& [name, plane] : planes_) out.emplace_back(&labels_[static_cast<std::size_t>(plane.id - 1)], plane);
  return out;
}

Camera SceneView::camera(const std::string& name) const {
  const Params& p = render_.at("cameras").at(name);
  Camera out = camera_of(p);
  const Params* carrier = p.find("rides_on");
  if (carrier == nullptr) return out;
  for (const auto& body : bodies_)
    if (body->name == carrier->as_text()) {
      const geometry::Motion way = body->motion();
      for (Vec3* place : {&out.position, &out.look_at}) *place = way.R * *place + way.t;
      out.up = way.R * out.up;
    }
  return out;
}

void SceneView::add_traction(RenderJob& job, const std::string& name, const std::map<std::string, std::vector<double>>& fields,
                             const std::function<bool(const std::string&)>& shown) {
  const Params* asked = render_.at("cameras").at(name).find("traction");
  if (asked == nullptr) return;
  std::vector<std::pair<Vec3, Vec3>> all;  // place, traction
  double largest = 0;
  for (const auto& body : bodies_) {
    if (!shown(body->name)) continue;
    std::vector<double> area(body->points.size(), 0);  // a third of the triangles around
    for (const Triangle& t : body->surface) {
      const Vec3 &a = body->points[t.v[0]], &b = body->points[t.v[1]], &c = body->points[t.v[2]];
      for (const Index v : t.v) area[v] += (b - a).cross(c - a).norm() / 6;
    }
    for (std::size_t i = 0; i < area.size(); ++i) {
      Vec3 force = Vec3::Zero();
      for (const Params& f : asked->at("of").items())
        if (const auto found = fields.find(f.as_text()); found != fields.end() && found->second.size() == 3 * points_)
          force += Eigen::Map<const Vec3>(found->second.data() + 3 * (body->first + i));
      if (!(area[i] > 0) || !force.allFinite() || force.isZero(0)) continue;
      all.emplace_back(body->points[i], force / area[i]);
      largest = std::max(largest, all.back().second.norm());
    }
  }
  double& longest = longest_[name];
  longest = asked->has("longest") ? asked->number("longest") : std::max(longest, largest);
  if (!(longest > 0)) return;
  const double away = (job.camera.look_at - job.camera.position).norm(),
               height = job.camera.model == Camera::Model::fisheye ? 2 * away : 2 * away * std::tan(0.5 * job.camera.fov);
  const double length = asked->has("length") ? asked->number("length") : kArrowLength * height;
  for (const auto& [place, traction] : all)
    if (traction.norm() > kLeastArrow * longest) job.arrows.push_back({place, place + length / longest * traction});
  const auto [unit, scale] = pressure_unit(longest);
  job.caption += fmt::format("{}longest arrow {:.3g} {}", job.caption.empty() ? "" : "     ", longest * scale, unit);
}

RenderJob SceneView::job(const std::string& name, const std::map<std::string, std::vector<double>>& fields, std::string caption) {
  const Params& p = render_.at("cameras").at(name);
  RenderJob job;
  job.width = static_cast<int>(render_.integer("width")), job.height = static_cast<int>(render_.integer("height"));
  job.camera = camera(name);
  job.caption = std::move(caption);
  if (const Params* annotate = p.find("annotate")) job.annotated = annotate->as_flag();
  const Params* own = p.find("background");
  job.background_top = own != nullptr ? own->as_vec3() : render_.vec3("background");
  job.background_bottom = 0.76 * job.background_top;
  std::vector<std::string> hidden;
  if (const Params* hide = p.find("hide"))
    for (const Params& body : hide->items()) hidden.push_back(body.as_text());
  const auto shown = [&](const std::string& body) { return std::find(hidden.begin(), hidden.end(), body) == hidden.end(); };

  const Params* by = p.find("colour_by");
  const auto field = by != nullptr ? fields.find(by->as_text()) : fields.end();
  std::vector<double> scalars;
  if (field != fields.end()) scalars = magnitudes(field->second);
  const bool coloured = points_ > 0 && scalars.size() == points_;
  double low = 0, high = 0;
  for (const auto& body : bodies_) {
    if (!shown(body->name)) continue;
    Drawn& drawn = job.meshes.emplace_back();
    drawn.mesh = &body->mesh;
    drawn.id = body->id;
    if (!coloured) continue;
    drawn.scalar = body->scalar(scalars);
    for (double& v : drawn.scalar) {
      if (!std::isfinite(v)) v = 0;
      low = std::min(low, v), high = std::max(high, v);
    }
  }
  for (const auto& [body, plane] : planes_)
    if (shown(body)) job.planes.push_back(plane);
  add_traction(job, name, fields, shown);
  if (!coloured) return job;
  if (const Params* range = p.find("range")) {
    low = range->items()[0].as_number(), high = range->items()[1].as_number();
  } else {
    auto& [lowest, highest] = extremes_[name];
    low = lowest = std::min(lowest, low), high = highest = std::max(highest, high);
    if (!(high > low)) high = low + 1;
  }
  job.bar = bar_of(p, low, high);
  return job;
}

}  // namespace mortise::render
