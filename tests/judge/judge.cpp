// mortise_judge FIELDS.vtkhdf: an opinion on saved states that shares no code with the solver.
//
//   intersections   pairs of triangles of watched surfaces that touch or cross, all bodies together, by CGAL's exact predicates; and
//                   vertices on or below a half-space
//   det F           volume of every tetrahedron over its volume at rest, from the saved positions
//   kinetic energy, momentum   from the saved velocities and densities, against what the run reported
//   elastic and gravity energy from the saved positions and the scene's materials, likewise (linear tetrahedra, double precision)
//   finite          every position
//
// One JSON object on stdout. Exit code 0: nothing found; 1: something is wrong; 2: the file cannot be judged.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <hdf5.h>

#include <Eigen/Dense>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Vector = std::array<double, 3>;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }
double volume(const Vector& a, const Vector& b, const Vector& c, const Vector& d) { return dot(cross(b - a, c - a), d - a) / 6; }

// --- the file ---

class File {
 public:
  explicit File(const char* path) : id_(H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT)) {
    if (id_ < 0) throw std::runtime_error("cannot open the file");
  }
  ~File() { H5Fclose(id_); }
  bool has(const std::string& path) const {
    for (std::size_t slash = path.find('/', 1); slash != std::string::npos; slash = path.find('/', slash + 1))
      if (H5Lexists(id_, path.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
    return H5Lexists(id_, path.c_str(), H5P_DEFAULT) > 0;
  }
  std::vector<double> numbers(const std::string& path) const {
    const hid_t set = H5Dopen2(id_, path.c_str(), H5P_DEFAULT);
    if (set < 0) throw std::runtime_error("no dataset " + path);
    const hid_t space = H5Dget_space(set);
    std::vector<double> out(H5Sget_simple_extent_npoints(space));
    const herr_t ok = H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data());
    H5Sclose(space), H5Dclose(set);
    if (ok < 0) throw std::runtime_error("cannot read " + path);
    return out;
  }
  std::string text(const std::string& path) const {
    const hid_t set = H5Dopen2(id_, path.c_str(), H5P_DEFAULT);
    if (set < 0) throw std::runtime_error("no dataset " + path);
    const hid_t type = H5Dget_type(set);
    std::string out;
    if (H5Tis_variable_str(type) > 0) {
      char* p = nullptr;
      H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &p);
      out = p ? p : "";
      H5free_memory(p);
    } else {
      out.resize(H5Tget_size(type));
      H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data());
      out = out.c_str();
    }
    H5Tclose(type), H5Dclose(set);
    return out;
  }
  long frames() const {
    const hid_t group = H5Gopen2(id_, "/VTKHDF/Steps", H5P_DEFAULT), a = H5Aopen(group, "NSteps", H5P_DEFAULT);
    long n = 0;
    H5Aread(a, H5T_NATIVE_LONG, &n);
    H5Aclose(a), H5Gclose(group);
    return n;
  }

 private:
  hid_t id_;
};

// --- what is to be judged ---

struct Body {
  std::string name;
  std::vector<std::array<long, 4>> tets;
  std::vector<std::array<long, 3>> triangles;
  std::vector<long> points;
  double density = 0, youngs_modulus = 0, poisson_ratio = 0;
  std::string law;
  bool soft = false, self_contact = false, fixed = false, quadratic = false;
};
struct Plane {
  std::string name;
  Vector point, normal;
};

struct Case {
  std::vector<Body> bodies;
  std::vector<Plane> planes;
  std::set<std::pair<std::string, std::string>> watched;  // both orders
  std::vector<Vector> rest;
  Vector gravity{};
  bool double_precision = false;
  long frames = 0;
};

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> out;
  std::string line;
  for (char c : text + "\n") {
    if (c != '\n') {
      line += c;
      continue;
    }
    if (!line.empty()) out.push_back(line);
    line.clear();
  }
  return out;
}

Vector vector_of(const YAML::Node& n) { return {n[0].as<double>(), n[1].as<double>(), n[2].as<double>()}; }

// Faces of tetrahedra that belong to one of them only, in the tetrahedron's order (outward).
std::vector<std::array<long, 3>> boundary(const std::vector<std::array<long, 4>>& tets) {
  constexpr int kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  std::map<std::array<long, 3>, std::pair<int, std::array<long, 3>>> seen;
  for (const auto& t : tets)
    for (const auto& f : kFaces) {
      const std::array<long, 3> face{t[f[0]], t[f[1]], t[f[2]]};
      auto key = face;
      std::sort(key.begin(), key.end());
      auto& entry = seen[key];
      ++entry.first, entry.second = face;
    }
  std::vector<std::array<long, 3>> out;
  for (const auto& [key, entry] : seen)
    if (entry.first == 1) out.push_back(entry.second);
  return out;
}

void read_mesh(const File& file, Case& c) {
  const auto connectivity = file.numbers("/VTKHDF/Connectivity"), offsets = file.numbers("/VTKHDF/Offsets"), types = file.numbers("/VTKHDF/Types");
  const auto cell_body = file.numbers("/VTKHDF/CellData/body_id"), point_body = file.numbers("/VTKHDF/PointData/body_id"), rest = file.numbers("/mortise/mesh/rest_points");
  for (const std::string& name : lines(file.text("/mortise/mesh/body_names"))) {
    c.bodies.emplace_back();
    c.bodies.back().name = name;
  }
  for (std::size_t i = 0; i < rest.size() / 3; ++i) {
    c.rest.push_back({rest[3 * i], rest[3 * i + 1], rest[3 * i + 2]});
    c.bodies.at(point_body[i]).points.push_back(i);
  }
  for (std::size_t k = 0; k < types.size(); ++k) {
    Body& body = c.bodies.at(cell_body[k]);
    const auto id = [&](int i) { return static_cast<long>(connectivity[offsets[k] + i]); };
    if (types[k] == 5) body.triangles.push_back({id(0), id(1), id(2)});
    if (types[k] == 10 || types[k] == 24) body.tets.push_back({id(0), id(1), id(2), id(3)});
    body.quadratic |= types[k] == 24;
  }
  for (Body& body : c.bodies) {
    body.soft = !body.tets.empty();
    if (body.soft) body.triangles = boundary(body.tets);
  }
}

void read_scene(const File& file, Case& c) {
  const YAML::Node scene = YAML::Load(file.text("/mortise/scene"));
  std::vector<std::string> names;
  for (const auto& entry : scene["bodies"]) {
    const std::string name = entry.first.as<std::string>();
    names.push_back(name);
    const YAML::Node b = entry.second;
    if (b["type"].as<std::string>() == "half_space") {
      c.planes.push_back({name, vector_of(b["point"]), vector_of(b["normal"])});
      continue;
    }
    for (Body& body : c.bodies)
      if (body.name == name) {
        const YAML::Node material = scene["materials"][b["material"].as<std::string>()];
        body.density = material["density"].as<double>();
        if (material["youngs_modulus"]) body.youngs_modulus = material["youngs_modulus"].as<double>(), body.poisson_ratio = material["poisson_ratio"].as<double>();
        if (material["model"]) body.law = material["model"].as<std::string>();
        body.self_contact = b["self_contact"] && b["self_contact"].as<bool>();
      }
  }
  const YAML::Node effects = scene["effects"];
  if (effects["gravity"] && effects["gravity"]["acceleration"]) c.gravity = vector_of(effects["gravity"]["acceleration"]);
  c.double_precision = scene["output"] && scene["output"]["precision"] && scene["output"]["precision"].as<std::string>() == "double";
  const auto watch = [&](const std::string& a, const std::string& b) { c.watched.insert({a, b}), c.watched.insert({b, a}); };
  if (const YAML::Node barrier = effects["barrier_contact"]) {
    if (barrier["pairs"]) {
      for (const auto& p : barrier["pairs"]) watch(p[0].as<std::string>(), p[1].as<std::string>());
    } else {
      for (const std::string& a : names)
        for (const std::string& b : names) watch(a, b);
    }
  }
  if (const YAML::Node mortar = effects["mortar_contact"])
    for (const auto& p : mortar["pairs"]) watch(p["slave"].as<std::string>(), p["master"].as<std::string>());
  if (const YAML::Node pins = effects["pin"])
    for (const auto& p : pins)
      if (p["where"]["side"] && p["where"]["side"].as<std::string>() == "all")
        for (Body& body : c.bodies) body.fixed |= body.name == p["body"].as<std::string>();
}

bool watched(const Case& c, const Body& a, const Body& b) {
  if (&a == &b) return a.self_contact;
  if (a.fixed && b.fixed) return false;  // they go where they are told
  return c.watched.count({a.name, b.name}) > 0;
}

// --- the judgement ---

struct Verdict {
  long intersections = 0, below = 0, not_finite = 0, inverted = 0, first_frame = -1;
  double min_det_f = NAN, kinetic_error = 0, momentum_error = 0, elastic_error = 0, gravity_error = 0;
  std::string what;  // the first thing found
  void found(long frame, const std::string& text) {
    if (first_frame < 0) first_frame = frame, what = text;
  }
};

void judge_surfaces(const Case& c, const std::vector<Vector>& x, long frame, Verdict& v) {
  Surface surface;
  std::vector<std::pair<const Body*, long>> owner;
  std::map<long, Surface::Vertex_index> vertex;
  const auto at = [&](long p) {
    const auto [it, fresh] = vertex.try_emplace(p);
    if (fresh) it->second = surface.add_vertex({x[p][0], x[p][1], x[p][2]});
    return it->second;
  };
  for (const Body& body : c.bodies)
    for (std::size_t t = 0; t < body.triangles.size(); ++t) {
      const auto& f = body.triangles[t];
      if (surface.add_face(at(f[0]), at(f[1]), at(f[2])) == Surface::null_face()) {  // not manifold here: with vertices of its own
        std::array<Surface::Vertex_index, 3> own;
        for (int k = 0; k < 3; ++k) own[k] = surface.add_vertex({x[f[k]][0], x[f[k]][1], x[f[k]][2]});
        surface.add_face(own[0], own[1], own[2]);
      }
      owner.emplace_back(&body, static_cast<long>(t));
    }
  std::vector<std::pair<Surface::Face_index, Surface::Face_index>> pairs;
  CGAL::Polygon_mesh_processing::self_intersections<CGAL::Sequential_tag>(surface, std::back_inserter(pairs));
  for (const auto& [f, g] : pairs) {
    const auto& [a, i] = owner.at(f.idx());
    const auto& [b, j] = owner.at(g.idx());
    if (!watched(c, *a, *b)) continue;
    ++v.intersections;
    v.found(frame, "triangle " + std::to_string(i) + " of " + a->name + " meets triangle " + std::to_string(j) + " of " + b->name);
  }
  for (const Plane& plane : c.planes)
    for (const Body& body : c.bodies) {
      if (!c.watched.count({body.name, plane.name})) continue;
      std::set<long> outside;  // nodes inside of an inverted element may be anywhere
      for (const auto& t : body.triangles) outside.insert(t.begin(), t.end());
      for (long p : outside)
        if (!(dot(x[p] - plane.point, plane.normal) > 0)) ++v.below, v.found(frame, "a vertex of " + body.name + " is on or below " + plane.name);
    }
}

void judge_elements(const Case& c, const std::vector<Vector>& x, long frame, Verdict& v) {
  for (const Body& body : c.bodies)
    for (const auto& t : body.tets) {
      const double det = volume(x[t[0]], x[t[1]], x[t[2]], x[t[3]]) / volume(c.rest[t[0]], c.rest[t[1]], c.rest[t[2]], c.rest[t[3]]);
      if (!(v.min_det_f <= det)) v.min_det_f = det;
      if (!(det > 0)) ++v.inverted, v.found(frame, "an element of " + body.name + " is inverted");
    }
}

// Kinetic energy and momentum. Soft: masses lumped at nodes. Stiff: the velocity is linear in space; the body is cut into tetrahedra from
// the mean of its vertices, where the velocity is the mean of theirs, and integrated exactly.
void motion(const Body& body, const std::vector<Vector>& rest, const std::vector<Vector>& velocity, double& kinetic, Vector& momentum) {
  if (body.soft) {
    for (const auto& t : body.tets) {
      const double m = body.density * volume(rest[t[0]], rest[t[1]], rest[t[2]], rest[t[3]]) / 4;
      for (long p : t) {
        kinetic += 0.5 * m * dot(velocity[p], velocity[p]);
        for (int k = 0; k < 3; ++k) momentum[k] += m * velocity[p][k];
      }
    }
    return;
  }
  Vector x{}, v{};
  for (long p : body.points)
    for (int k = 0; k < 3; ++k) x[k] += rest[p][k] / body.points.size(), v[k] += velocity[p][k] / body.points.size();
  for (const auto& t : body.triangles) {
    const double m = body.density * volume(x, rest[t[0]], rest[t[1]], rest[t[2]]);
    Vector sum = v;
    double squares = dot(v, v);
    for (long p : t) {
      squares += dot(velocity[p], velocity[p]);
      for (int k = 0; k < 3; ++k) sum[k] += velocity[p][k];
    }
    kinetic += 0.5 * m / 20 * (squares + dot(sum, sum));
    for (int k = 0; k < 3; ++k) momentum[k] += m / 4 * sum[k];
  }
}

// Density of elastic energy at the deformation gradient F (the laws as published, with the guard against inversion; src/effects/elasticity/README.md).
double elastic_density(const Body& body, const Eigen::Matrix3d& F) {
  const double E = body.youngs_modulus, nu = body.poisson_ratio, mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), J = F.determinant();
  constexpr double kGuard = 0.1, kFlat = 1e-6;  // J_0, J_1
  const double x = (J - kFlat) / (kGuard - kFlat), guard = x < 1 ? -2 * mu * (1 - kFlat / kGuard) * (x - 1) * (x - 1) * std::log(x) : 0;
  if (body.law == "linear") {
    const Eigen::Matrix3d strain = 0.5 * (F + F.transpose()) - Eigen::Matrix3d::Identity();
    return mu * strain.squaredNorm() + lambda / 2 * strain.trace() * strain.trace() + guard;
  }
  if (body.law == "corotated") {
    Eigen::Vector3d stretch = Eigen::JacobiSVD<Eigen::Matrix3d>(F).singularValues();
    if (J < 0) stretch[2] *= -1;
    return mu * (stretch - Eigen::Vector3d::Ones()).squaredNorm() + lambda / 2 * (J - 1) * (J - 1) + guard;
  }
  const double m = 4.0 / 3 * mu, l = lambda + 5.0 / 6 * mu, alpha = 1 + 3 * m / (4 * l), I = F.squaredNorm();
  return m / 2 * (I - 3) - m / 2 * std::log((I + 1) / 4) + l / 2 * ((J - alpha) * (J - alpha) - (1 - alpha) * (1 - alpha)) + guard;
}

double elastic_energy(const Body& body, const std::vector<Vector>& rest, const std::vector<Vector>& x) {
  const auto edges = [](const std::vector<Vector>& p, const std::array<long, 4>& t) {
    Eigen::Matrix3d D;
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) D(i, k) = p[t[k + 1]][i] - p[t[0]][i];
    return D;
  };
  double sum = 0;
  for (const auto& t : body.tets) {
    const Eigen::Matrix3d Dm = edges(rest, t);
    sum += Dm.determinant() / 6 * elastic_density(body, edges(x, t) * Dm.inverse());
  }
  return sum;
}

// -m g . x of all mass, and the sum of its sizes; the mass of stiff bodies is cut into tetrahedra from the origin of the rest state.
void gravity_energy(const Case& c, const Body& body, const std::vector<Vector>& x, double& energy, double& size) {
  const auto add = [&](double mass, const std::vector<Vector>& corners) {
    for (const Vector& p : corners) energy -= mass / 4 * dot(c.gravity, p), size += std::abs(mass / 4 * dot(c.gravity, p));
  };
  for (const auto& t : body.tets) add(body.density * volume(c.rest[t[0]], c.rest[t[1]], c.rest[t[2]], c.rest[t[3]]), {x[t[0]], x[t[1]], x[t[2]], x[t[3]]});
  if (body.soft) return;
  Vector rest{}, now{};  // the mean of the vertices moves with the affine map
  for (long p : body.points)
    for (int k = 0; k < 3; ++k) rest[k] += c.rest[p][k] / body.points.size(), now[k] += x[p][k] / body.points.size();
  for (const auto& t : body.triangles) add(body.density * volume(rest, c.rest[t[0]], c.rest[t[1]], c.rest[t[2]]), {now, x[t[0]], x[t[1]], x[t[2]]});
}

std::vector<Vector> frame_of(const std::vector<double>& all, long frame, std::size_t n) {
  std::vector<Vector> out(n);
  for (std::size_t i = 0; i < n; ++i)
    for (int k = 0; k < 3; ++k) out[i][k] = all.at(3 * (frame * n + i) + k);
  return out;
}

// Stored energies of one state against what the run reported; a share of the largest of the run so far.
class StoredEnergies {
 public:
  StoredEnergies(const File& file, const Case& c) : c_(c) {
    const bool linear_tets = std::none_of(c.bodies.begin(), c.bodies.end(), [](const Body& b) { return b.quadratic; });
    if (!c.double_precision || !linear_tets) return;
    const std::string elastic = "/mortise/effects/elasticity/energy", gravity = "/mortise/effects/gravity/energy";
    for (const Body& body : c.bodies)  // at rest the terms of an energy density cancel
      for (const auto& t : body.tets) rounding_ += 1e-9 * body.youngs_modulus * volume(c.rest[t[0]], c.rest[t[1]], c.rest[t[2]], c.rest[t[3]]);
    if (file.has(elastic)) elastic_ = file.numbers(elastic);
    if (file.has(gravity)) gravity_ = file.numbers(gravity);
  }
  void judge(const std::vector<Vector>& x, long frame, Verdict& v) {
    if (!elastic_.empty()) {
      double sum = 0;
      for (const Body& body : c_.bodies) sum += elastic_energy(body, c_.rest, x);
      largest_ = std::max({largest_, std::abs(sum), std::abs(elastic_[frame]), rounding_});
      v.elastic_error = std::max(v.elastic_error, std::abs(sum - elastic_[frame]) / largest_);
    }
    if (!gravity_.empty()) {
      double sum = 0, size = 0;
      for (const Body& body : c_.bodies) gravity_energy(c_, body, x, sum, size);
      if (frame == 0) offset_ = sum - gravity_[0];  // the height of zero energy is arbitrary
      if (size > 0) v.gravity_error = std::max(v.gravity_error, std::abs(sum - offset_ - gravity_[frame]) / size);
    }
  }

 private:
  const Case& c_;
  std::vector<double> elastic_, gravity_;
  double largest_ = 0, rounding_ = 0, offset_ = 0;
};

Verdict judge(const File& file, const Case& c) {
  Verdict v;
  StoredEnergies stored(file, c);
  const std::size_t n = c.rest.size();
  const auto points = file.numbers("/VTKHDF/Points");
  const bool dynamic = file.has("/VTKHDF/PointData/velocity");
  const auto velocities = dynamic ? file.numbers("/VTKHDF/PointData/velocity") : std::vector<double>{};
  std::map<std::string, std::vector<double>> said;
  if (dynamic)
    for (const char* name : {"kinetic_energy", "momentum_x", "momentum_y", "momentum_z"}) said[name] = file.numbers(std::string("/mortise/effects/inertia/") + name);
  const bool lumped = std::none_of(c.bodies.begin(), c.bodies.end(), [](const Body& b) { return b.quadratic; });
  for (long f = 0; f < c.frames; ++f) {
    const std::vector<Vector> x = frame_of(points, f, n);
    const long bad = std::count_if(x.begin(), x.end(), [](const Vector& p) { return !std::isfinite(p[0] + p[1] + p[2]); });
    if (bad > 0) {
      v.not_finite += bad, v.found(f, "a position is not finite");
      continue;
    }
    judge_surfaces(c, x, f, v);
    judge_elements(c, x, f, v);
    stored.judge(x, f, v);
    if (!dynamic || !lumped) continue;
    const std::vector<Vector> velocity = frame_of(velocities, f, n);
    double kinetic = 0, size = 0;
    Vector momentum{};
    for (const Body& body : c.bodies) {
      double own = 0;
      motion(body, c.rest, velocity, own, momentum);
      kinetic += own;
      double mass = 0;
      for (const auto& t : body.tets) mass += body.density * volume(c.rest[t[0]], c.rest[t[1]], c.rest[t[2]], c.rest[t[3]]);
      for (const auto& t : body.soft ? std::vector<std::array<long, 3>>{} : body.triangles) mass += body.density * volume({}, c.rest[t[0]], c.rest[t[1]], c.rest[t[2]]);
      size += std::sqrt(2 * mass * own);  // the momentum of this energy, if all moved alike
    }
    if (kinetic > 0) v.kinetic_error = std::max(v.kinetic_error, std::abs(said["kinetic_energy"][f] / kinetic - 1));
    const char* axes[] = {"momentum_x", "momentum_y", "momentum_z"};
    for (int k = 0; k < 3; ++k)
      if (size > 0) v.momentum_error = std::max(v.momentum_error, std::abs(said[axes[k]][f] - momentum[k]) / size);
  }
  // Velocities are saved with single or double precision.
  if (v.kinetic_error > 1e-4) v.found(0, "the kinetic energy that was reported is not that of the saved velocities");
  if (v.momentum_error > 1e-4) v.found(0, "the momentum that was reported is not that of the saved velocities");
  if (!(v.elastic_error <= 1e-6)) v.found(0, "the elastic energy that was reported is not that of the saved positions");
  if (!(v.gravity_error <= 1e-6)) v.found(0, "the energy of gravity that was reported is not that of the saved positions");
  return v;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: mortise_judge FIELDS.vtkhdf\n");
    return 2;
  }
  try {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    const File file(argv[1]);
    Case c;
    c.frames = file.frames();
    read_mesh(file, c);
    read_scene(file, c);
    const Verdict v = judge(file, c);
    const auto number = [](double d) { return std::isfinite(d) ? nlohmann::ordered_json(d) : nlohmann::ordered_json(nullptr); };
    const nlohmann::ordered_json j{{"frames", c.frames},
                                   {"intersections", v.intersections},
                                   {"below_planes", v.below},
                                   {"inverted", v.inverted},
                                   {"not_finite", v.not_finite},
                                   {"min_det_f", number(v.min_det_f)},
                                   {"kinetic_energy_error", v.kinetic_error},
                                   {"momentum_error", v.momentum_error},
                                   {"elastic_energy_error", v.elastic_error},
                                   {"gravity_energy_error", v.gravity_error},
                                   {"first_frame", v.first_frame},
                                   {"what", v.what}};
    std::printf("%s\n", j.dump().c_str());
    return v.first_frame < 0 ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "mortise_judge: %s: %s\n", argv[1], e.what());
    return 2;
  }
}
