// mortise_judge FIELDS.vtkhdf: an opinion on saved states that shares no code with the solver.
//
//   intersections   pairs of triangles of surfaces that are to be kept apart (quarters of quadratic faces; held bodies too) that touch or cross, all
//   bodies together, by CGAL's exact predicates; and
//                   vertices on or below a half-space
//   det F           volume of every tetrahedron over its volume at rest, from the saved positions
//   kinetic energy, momentum   from the saved velocities and densities, against what the run reported
//   elastic and gravity energy from the saved positions and the scene's materials, likewise (linear tetrahedra, double precision)
//   forces          contact, friction, weight, support, ties, and motors, drags and stops of slides, of every body against the change of its momentum
//   finite          every position
//
// Of several environments (`environments` of a scene) each is judged in its own file.
//
// mortise_judge FIELDS.vtkhdf OTHER.vtkhdf: are the two equal, seconds apart?
//
// One JSON object on stdout, or what differs. Exit code 0: nothing found; 1: something is wrong; 2: the file cannot be judged.
#include "judge/judge.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

namespace judge {
namespace {

Verdict judge(const File& file, const Case& c) {
  Verdict v;
  StoredEnergies stored(file, c);
  const std::size_t n = c.rest.size();
  const auto points = file.numbers("/VTKHDF/Points");
  const bool dynamic = file.has("/VTKHDF/PointData/velocity");
  const auto velocities = dynamic ? file.numbers("/VTKHDF/PointData/velocity") : std::vector<double>{};
  std::map<std::string, std::vector<double>> said;
  if (dynamic)
    for (const char* name : {"kinetic_energy", "momentum_x", "momentum_y", "momentum_z"})
      said[name] = file.numbers(std::string("/mortise/effects/inertia/") + name);
  const bool lumped = std::none_of(c.bodies.begin(), c.bodies.end(), [](const Body& b) { return b.quadratic(); });
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
      if (body.spread) mass = body.spread->mass;
      for (const auto& t : body.soft || body.spread ? std::vector<std::array<long, 3>>{} : body.triangles)
        mass += body.density * volume({}, c.rest[t[0]], c.rest[t[1]], c.rest[t[2]]);
      size += std::sqrt(2 * mass * own);  // the momentum of this energy, if all moved alike
    }
    if (kinetic > 0) v.kinetic_error = std::max(v.kinetic_error, std::abs(said["kinetic_energy"][f] / kinetic - 1));
    const char* axes[] = {"momentum_x", "momentum_y", "momentum_z"};
    for (int k = 0; k < 3; ++k)
      if (size > 0) v.momentum_error = std::max(v.momentum_error, std::abs(said[axes[k]][f] - momentum[k]) / size);
  }
  if (v.not_finite == 0) judge_forces(file, c, v);
  // Velocities are saved with single or double precision.
  if (v.kinetic_error > 1e-4) v.found(0, "the kinetic energy that was reported is not that of the saved velocities");
  if (v.momentum_error > 1e-4) v.found(0, "the momentum that was reported is not that of the saved velocities");
  if (!(v.elastic_error <= 1e-6)) v.found(0, "the elastic energy that was reported is not that of the saved positions");
  if (!(v.gravity_error <= 1e-6)) v.found(0, "the energy of gravity that was reported is not that of the saved positions");
  return v;
}

// One file's; `code` as the program ends.
nlohmann::ordered_json opinion(const File& file, int& code) {
  Case c;
  c.frames = file.frames();
  read_mesh(file, c);
  read_scene(file, c);
  const Verdict v = judge(file, c);
  code = v.first_frame < 0 ? 0 : 1;
  const auto number = [](double d) { return std::isfinite(d) ? nlohmann::ordered_json(d) : nlohmann::ordered_json(nullptr); };
  return {{"frames", c.frames},
          {"intersections", v.intersections},
          {"below_planes", v.below},
          {"inverted", v.inverted},
          {"not_finite", v.not_finite},
          {"min_det_f", number(v.min_det_f)},
          {"kinetic_energy_error", v.kinetic_error},
          {"momentum_error", v.momentum_error},
          {"elastic_energy_error", v.elastic_error},
          {"gravity_energy_error", v.gravity_error},
          {"force_error", v.force_error},
          {"forces_judged", v.forces},
          {"first_frame", v.first_frame},
          {"what", v.what}};
}

// Each in its own file beside this one; the worst code of all. One that never began has none.
int environments(const File& file, const std::string& path) {
  const std::string folder = path.find('/') == std::string::npos ? "." : path.substr(0, path.rfind('/'));
  std::istringstream names(file.text("/environments/runs"));
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  int worst = 0;
  for (std::string name; std::getline(names, name);) {
    const std::string own = folder + "/" + name + "/fields.vtkhdf";
    int code = 0;
    nlohmann::ordered_json j{{"environment", name}};
    j.update(opinion(File(own.c_str()), code));
    all.push_back(std::move(j));
    worst = std::max(worst, code);
  }
  std::printf("%s\n", nlohmann::ordered_json{{"environments", all}}.dump().c_str());
  return worst;
}

}  // namespace
}  // namespace judge

int main(int argc, char** argv) {
  using namespace judge;
  if (argc != 2 && argc != 3) {
    std::fprintf(stderr, "usage: mortise_judge FIELDS.vtkhdf [OTHER.vtkhdf]\n");
    return 2;
  }
  try {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    const File file(argv[1]);
    if (argc == 3) {
      const std::string differs = difference(file, File(argv[2]));
      std::printf("%s\n", differs.c_str());
      return differs.empty() ? 0 : 1;
    }
    if (file.has("/environments/runs")) return environments(file, argv[1]);
    int code = 0;
    std::printf("%s\n", opinion(file, code).dump().c_str());
    return code;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "mortise_judge: %s: %s\n", argv[1], e.what());
    return 2;
  }
}
