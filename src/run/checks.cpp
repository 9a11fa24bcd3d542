#include "run/checks.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/pass_on.h"
#include "geometry/topology.h"

namespace mortise::run {
namespace {

using Json = nlohmann::ordered_json;
using Fields = std::map<std::string, std::vector<double>>;

Vec3 at(const std::vector<double>& v, std::size_t i) { return {v[3 * i], v[3 * i + 1], v[3 * i + 2]}; }

// A point field of the state, or null where no effect reported it.
const std::vector<double>* field(const Fields& fields, const char* name) {
  const auto it = fields.find(name);
  return it == fields.end() || it->second.empty() ? nullptr : &it->second;
}

const char* outcome_of(Exit status) {
  if (status == Exit::done) return "done";
  if (status == Exit::scene) return "scene_error";
  if (status == Exit::solve) return "step_failed";
  return "other";
}

}  // namespace

// Mass and mesh of a body, and where its points are among all points.
struct Checks::Body {
  std::string name;
  std::size_t first = 0, count = 0;
  std::vector<Tet> tets;            // soft
  std::vector<Triangle> triangles;  // stiff
  std::vector<double> mass;         // of the points, lumped (soft)
  double density = 0, volume = 0;   // at rest

  double volume_at(const std::vector<double>& points) const {
    if (tets.empty()) return geometry::mass_properties(surface(points)).volume;
    double sum = 0;
    for (const Tet& t : tets) {
      const Vec3 x = at(points, first + t.v[0]);
      sum += (at(points, first + t.v[1]) - x).cross(at(points, first + t.v[2]) - x).dot(at(points, first + t.v[3]) - x) / 6;
    }
    return sum;
  }
  // Weighted mean of a field of vectors that is affine on stiff bodies: the value at the centre of mass.
  Vec3 mean(const std::vector<double>& values, const std::vector<double>& points) const {
    Vec3 sum = Vec3::Zero();
    if (!tets.empty()) {
      double total = 0;
      for (std::size_t i = 0; i < count; ++i) sum += mass[i] * at(values, first + i), total += mass[i];
      return sum / total;
    }
    // The affine map from points to values, at the centroid.
    const Vec3 centre = geometry::mass_properties(surface(points)).centroid;
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Matrix<double, 4, 3> right = Eigen::Matrix<double, 4, 3>::Zero();
    for (std::size_t i = 0; i < count; ++i) {
      Eigen::Vector4d row;
      row << 1, at(points, first + i) - centre;
      normal += row * row.transpose();
      right += row * at(values, first + i).transpose();
    }
    return normal.ldlt().solve(right).row(0).transpose();
  }
  Vec3 sum(const std::vector<double>& values) const {
    Vec3 s = Vec3::Zero();
    for (std::size_t i = 0; i < count; ++i) s += at(values, first + i);
    return s;
  }
  // Angular velocity of the rigid motion nearest to the points' velocities (least squares, all points alike).
  Vec3 spin(const std::vector<double>& velocity, const std::vector<double>& points) const {
    const Vec3 x = sum(points) / static_cast<double>(count), v = sum(velocity) / static_cast<double>(count);
    Mat3 inertia = Mat3::Zero();
    Vec3 momentum = Vec3::Zero();
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 r = at(points, first + i) - x;
      inertia += r.squaredNorm() * Mat3::Identity() - r * r.transpose();
      momentum += r.cross(at(velocity, first + i) - v);
    }
    return inertia.ldlt().solve(momentum);
  }

  // Kinetic energy (stiff) about the mean of the points, where the velocity, being linear in space, is the mean of theirs: the body
  // is cut into tetrahedra from there.
  double turning_energy(const std::vector<double>& velocity, const std::vector<double>& points) const {
    const Vec3 x = sum(points) / static_cast<double>(count), v = sum(velocity) / static_cast<double>(count);
    double twice = 0;
    for (const Triangle& t : triangles) {
      Vec3 r[3], total = Vec3::Zero();
      double squares = 0;
      for (int k = 0; k < 3; ++k) {
        r[k] = at(points, first + t.v[k]) - x;
        const Vec3 w = at(velocity, first + t.v[k]) - v;
        total += w, squares += w.squaredNorm();
      }
      twice += density * r[0].cross(r[1]).dot(r[2]) / 6 / 20 * (squares + total.squaredNorm());
    }
    return 0.5 * twice;
  }

 private:
  geometry::TriMesh surface(const std::vector<double>& points) const {
    geometry::TriMesh mesh;
    for (std::size_t i = 0; i < count; ++i) mesh.points.push_back(at(points, first + i));
    mesh.triangles = triangles;
    return mesh;
  }
};

struct Checks::State {
  Fields fields;
  std::map<std::string, double> scalars;
  std::vector<double> points;
  double energy = NAN;
};

class Checks::Watch : public PassOn {
 public:
  using PassOn::PassOn;
  void points(std::string_view name, std::string_view unit, int components, std::span<const double> values) override {
    PassOn::points(name, unit, components, values);
    if (components == 3) seen.fields[std::string(name)].assign(values.begin(), values.end());
  }
  void scalar(std::string_view group, std::string_view name, std::string_view unit, double value) override {
    PassOn::scalar(group, name, unit, value);
    seen.scalars[std::string(group) + "/" + std::string(name)] = value;
  }
  State seen;
};

Checks::Checks(const model::ModelInput& input) {
  if (const Params* list = input.scene.find("checks"))
    for (const Params& p : list->items()) {
      Criterion c;
      c.params = p;
      c.quantity = p.text("quantity");
      if (const Params* body = p.find("body")) c.body = body->as_text();
      if (const Params* when = p.find("when")) c.when = when->as_text();
      if (const Params* axis = p.find("axis")) c.axis = axis->as_text() == "size" ? 3 : axis->as_text()[0] - 'x';
      criteria_.push_back(std::move(c));
    }
  if (criteria_.empty()) return;
  force_tolerance_ = input.scene.at("solver").number("force_tolerance");
  for (const model::BodyInput& b : input.bodies) {
    if (b.type == model::BodyType::half_space) continue;
    Body body;
    body.name = b.name, body.first = start_.size() / 3, body.count = b.nodes.size();
    body.tets = b.tets, body.triangles = b.triangles;
    body.density = b.material.number("density");
    for (const Vec3& x : b.nodes) start_.insert(start_.end(), x.data(), x.data() + 3);
    body.mass.assign(body.count, 0.0);
    for (const Tet& t : body.tets)
      for (Index v : t.v) body.mass[v] += body.density * geometry::tet_volume(b.nodes, t) / 4;
    body.volume = body.volume_at(start_);
    bodies_.push_back(std::move(body));
  }
}

Checks::~Checks() = default;

FieldSink* Checks::watch(FieldSink* next) {
  if (empty()) return next;
  watch_ = std::make_unique<Watch>(next);
  return watch_.get();
}

void Checks::Criterion::take(double v) {
  if (count++ == 0) first = v;
  last = v;
  sum += v;
  least = std::fmin(least, v), most = std::fmax(most, v);
  if (!std::isfinite(v)) not_finite = true;
}

bool Checks::wants(const std::string& quantity, const std::string& body) const {
  for (const Criterion& c : criteria_)
    if (c.quantity == quantity && c.body == body) return true;
  return false;
}
void Checks::take(const std::string& quantity, double v) { take(quantity, "", v); }
void Checks::take(const std::string& quantity, const std::string& body, double v) {
  for (Criterion& c : criteria_)
    if (c.quantity == quantity && c.body == body) c.take(v);
}
void Checks::take(const std::string& quantity, const std::string& body, const Vec3& v) {
  for (Criterion& c : criteria_)
    if (c.quantity == quantity && c.body == body) c.take(c.axis == 3 ? v.norm() : v[c.axis]);
}

void Checks::state(const std::vector<double>& points) {
  if (empty() || !watch_) return;
  State now = std::move(watch_->seen);
  watch_.reset();
  now.points = points;
  double distance = INFINITY;
  for (const auto& [name, v] : now.scalars)
    if (name.ends_with("/min_distance")) distance = std::isnan(v) ? v : std::min(distance, v);
  if (std::isfinite(distance)) take("min_distance", distance);
  const auto scalar = [&](const char* name) {
    const auto it = now.scalars.find(name);
    return it == now.scalars.end() ? NAN : it->second;
  };
  if (now.scalars.count("elasticity/det_F_min")) take("min_det_f", scalar("elasticity/det_F_min"));
  if (now.scalars.count("mortar_contact/clip_partition_defect")) take("clip_defect", scalar("mortar_contact/clip_partition_defect"));
  if (now.scalars.count("inertia/kinetic_energy")) take("kinetic_energy", scalar("inertia/kinetic_energy"));
  if (now.scalars.count("balance/defect_x")) {
    double largest = 0;
    for (const auto& [name, v] : now.scalars) {
      // Forces inside of a closed system have no resultant; what each body is held with has one.
      if ((!name.starts_with("balance/") && !name.starts_with("supports/")) || !name.ends_with("_x") || name == "balance/defect_x") continue;
      const std::string stem = name.substr(0, name.size() - 1);
      largest = std::max(largest, std::hypot(v, scalar((stem + "y").c_str()), scalar((stem + "z").c_str())));
    }
    const double defect = std::hypot(scalar("balance/defect_x"), scalar("balance/defect_y"), scalar("balance/defect_z"));
    // Of forces that are no larger than what a step may leave unbalanced there is no share.
    take("force_balance", largest > 1e3 * force_tolerance_ ? defect / largest : 0);
  }
  if (now.scalars.count("inertia/momentum_x")) {
    const Vec3 p(scalar("inertia/momentum_x"), scalar("inertia/momentum_y"), scalar("inertia/momentum_z"));
    if (!before_) momentum_first_ = p;
    double size = 0;
    if (const auto* v = field(now.fields, "velocity"))
      for (const Body& b : bodies_) size += b.density * b.volume * b.mean(*v, points).norm();
    momentum_scale_ = std::max(momentum_scale_, size);
    if (momentum_scale_ > 0) take("momentum_drift", (p - momentum_first_).norm() / momentum_scale_);
  }
  now.energy = energies(now);
  for (const Body& b : bodies_) measure(b, now);
  before_ = std::make_unique<State>(std::move(now));
}

void Checks::step(const solver::StepReport& r) {
  take("newton_iterations", r.newton);
  take("substeps", r.substeps);
  take("step_length", r.alpha);
  if (r.tolerance > 0) take("residual", r.residual / r.tolerance);
}

// Total energy. Gain of a step: the change of kinetic and stored energy less the work of the supports.
double Checks::energies(const State& now) {
  double total = 0, largest = scale_;
  for (const auto& [name, v] : now.scalars) {
    const std::string leaf = name.substr(name.find('/') + 1);
    if (leaf != "energy" && leaf != "kinetic_energy") continue;
    total += v;
    if (name != "gravity/energy") {  // which is arbitrary up to a constant
      largest = std::max(largest, v);
      continue;
    }
    if (std::isnan(gravity_first_)) gravity_first_ = v;
    largest = std::max(largest, std::abs(v - gravity_first_));
  }
  // What a pinned body turns with is the doing of its pins, whose moment is not reported.
  if (const auto* v = field(now.fields, "velocity"))
    for (const Body& b : bodies_)
      if (b.tets.empty() && now.scalars.count("supports/" + b.name + "_x")) total -= b.turning_energy(*v, now.points);
  scale_ = largest;
  if (!before_ || !wants("energy_gain", "")) return total;
  const double work = support_work(now);
  work_ += work;
  scale_ = std::max(scale_, std::abs(work_));
  take("energy_gain", total - before_->energy - work);  // divided by the scale at the end
  return total;
}

double Checks::support_work(const State& now) const {
  double work = 0;
  const auto moved = [&](std::size_t i) { return Vec3(at(now.points, i) - at(before_->points, i)); };
  if (const auto* f = field(now.fields, "support_force"))
    for (std::size_t i = 0; i < f->size() / 3; ++i) work += at(*f, i).dot(moved(i));
  // A pinned stiff body: its resultant on the way of its centre, and against the contact on what it turns.
  const auto *contact = field(now.fields, "contact_force"), *friction = field(now.fields, "friction_force");
  for (const Body& b : bodies_) {
    const auto x = now.scalars.find("supports/" + b.name + "_x");
    if (!b.tets.empty() || x == now.scalars.end()) continue;
    const Vec3 force(x->second, now.scalars.at("supports/" + b.name + "_y"), now.scalars.at("supports/" + b.name + "_z"));
    const Vec3 way = b.mean(now.points, now.points) - b.mean(before_->points, before_->points);
    work += force.dot(way);
    for (std::size_t i = b.first; i < b.first + b.count; ++i)
      for (const auto* f : {contact, friction})
        if (f) work -= at(*f, i).dot(moved(i) - way);
  }
  return work;
}

void Checks::measure(const Body& b, const State& now) {
  const std::vector<double>& x = now.points;
  if (wants("volume_change", b.name)) take("volume_change", b.name, b.volume_at(x) / b.volume - 1);
  if (wants("movement", b.name)) {
    double most = 0;
    for (std::size_t i = b.first; i < b.first + b.count; ++i) most = std::max(most, (at(x, i) - at(start_, i)).norm());
    take("movement", b.name, most);
  }
  if (wants("position", b.name)) take("position", b.name, b.mean(x, x));
  if (wants("displacement", b.name)) take("displacement", b.name, Vec3(b.mean(x, x) - b.mean(start_, start_)));
  if (wants("lowest", b.name) || wants("highest", b.name)) {
    Vec3 lo = Vec3::Constant(INFINITY), hi = -lo;
    for (std::size_t i = b.first; i < b.first + b.count; ++i) lo = lo.cwiseMin(at(x, i)), hi = hi.cwiseMax(at(x, i));
    take("lowest", b.name, lo), take("highest", b.name, hi);
  }
  if (const auto* v = field(now.fields, "velocity")) {
    if (wants("velocity", b.name)) take("velocity", b.name, b.mean(*v, x));
    if (wants("spin", b.name)) take("spin", b.name, b.spin(*v, x));
  }
  Vec3 contact = Vec3::Zero(), support = Vec3::Zero(), friction = Vec3::Zero();
  bool touched = false, held = false, rubbed = false;
  for (const auto& [name, value] : now.scalars)
    for (int c = 0; c < 3; ++c) {
      const std::string tail = std::string("_") + "xyz"[c];
      if (name.ends_with("_contact/force_" + b.name + tail)) contact[c] += value, touched = true;
      if (name == "supports/" + b.name + tail) support[c] = value, held = true;
      if (name == "friction/force_" + b.name + tail) friction[c] = value, rubbed = true;
    }
  if (touched) take("contact_force", b.name, contact);
  if (held) take("support_force", b.name, support);
  if (rubbed) take("friction_force", b.name, friction);
}

double Checks::value(const Criterion& c) const {
  if (c.count == 0 || c.not_finite) return NAN;
  double v = c.last;
  if (c.when == "start") v = c.first;
  if (c.when == "mean") v = c.sum / static_cast<double>(c.count);
  if (c.when == "always") {
    const Params *near = c.params.find("near"), *above = c.params.find("above"), *below = c.params.find("below");
    // The worst: furthest from `near`, or furthest beyond the bound; between two bounds the one that is missed by more.
    if (near)
      v = std::abs(c.least - near->as_number()) > std::abs(c.most - near->as_number()) ? c.least : c.most;
    else if (above && below)
      v = above->as_number() - c.least > c.most - below->as_number() ? c.least : c.most;
    else
      v = above ? c.least : c.most;
  }
  return c.quantity == "energy_gain" && scale_ > 0 ? v / scale_ : v;
}

Checks::Verdict Checks::judge(const Criterion& c, Exit status, const std::string& message) const {
  Verdict out;
  if (c.quantity == "outcome") {
    out.found = outcome_of(status);
    out.text = "outcome is " + c.params.text("is");
    out.pass = out.found == c.params.text("is");
    if (const Params* says = c.params.find("says"))
      for (const Params& piece : says->items()) {
        out.text += ", says '" + piece.as_text() + "'";
        out.pass = out.pass && message.find(piece.as_text()) != std::string::npos;
      }
    return out;
  }
  out.text = c.quantity;
  if (!c.body.empty()) out.text += " of " + c.body;
  if (c.axis >= 0) out.text += c.axis == 3 ? " (size)" : fmt::format(" ({})", "xyz"[c.axis]);
  if (c.when != "always") out.text += ", " + c.when;
  out.value = value(c);
  out.pass = std::isfinite(out.value);
  const auto bound = [&](const char* key, bool holds) {
    out.text += fmt::format(" {} {:.6g}", key, c.params.number(key));
    out.pass = out.pass && holds;
  };
  if (c.params.has("above")) bound("above", out.value > c.params.number("above"));
  if (c.params.has("below")) bound("below", out.value < c.params.number("below"));
  if (!c.params.has("near")) return out;
  const double near = c.params.number("near");
  const double room = c.params.has("share") ? c.params.number("share") * std::abs(near) : c.params.number("tolerance");
  bound("near", std::abs(out.value - near) <= room);
  out.text += fmt::format(" +- {:.3g}", room);
  return out;
}

std::vector<Checks::Verdict> Checks::verdicts(Exit status, const std::string& message) const {
  std::vector<Verdict> out;
  for (const Criterion& c : criteria_) out.push_back(judge(c, status, message));
  return out;
}

std::string Checks::add_to(const std::string& certificate, const std::vector<Verdict>& verdicts) {
  if (verdicts.empty()) return certificate;
  Json j = Json::parse(certificate);
  j["criteria"] = Json::array();
  for (const Verdict& v : verdicts) {
    Json value = nullptr;
    if (!v.found.empty()) value = v.found;
    if (std::isfinite(v.value)) value = v.value;
    j["criteria"].push_back({{"criterion", v.text}, {"value", value}, {"pass", v.pass}});
  }
  return j.dump(1) + "\n";
}

}  // namespace mortise::run
