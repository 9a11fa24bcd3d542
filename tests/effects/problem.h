#pragma once
// A problem that every bulk effect is tested on: a soft box and a stiff ball (sheared, so that its mass matrix is full), in one
// or two environments.
#include <map>
#include <random>
#include <string>

#include "../scene_builder.h"
#include "base/field_sink.h"
#include "effects/list.h"
#include "finite_difference.h"

namespace mortise::fd {

inline model::ModelInput box_and_ball(const std::string& law = "neo_hookean", int envs = 1) {
  model::ModelInput in;
  in.scene = Params::make_table();
  geometry::TetMesh ball = geometry::sphere(0.5, 0.4);
  for (Vec3& x : ball.points) x += Vec3(0.4, 0.2, 0) * x[2];
  for (int e = 0; e < envs; ++e) {
    const Vec3 at(10.0 * e, 0, 0);
    const double density = 1000 + 100 * e;
    in.bodies.push_back(mortise::testing::soft_body("box", geometry::box({1, 1, 2}, 1.0), mortise::testing::material(law, 1e5, 0.4, density), at,
                                                    mortise::testing::body_params({1, -2, 0.5}, {0.3, 0.1, -0.7})));
    in.bodies.push_back(mortise::testing::stiff_body("ball", ball, mortise::testing::material("linear", 1e9, 0.3, 2000), at + Vec3(0.2, 0.1, 3),
                                                     mortise::testing::body_params({1, 2, 3}, {0.5, -1, 4})));
    in.bodies[in.bodies.size() - 2].env = in.bodies.back().env = e;
  }
  return in;
}

inline std::unique_ptr<Subject> make_effect(const std::string& name, const Params& params, model::Model& model) {
  for (const effects::Kind& k : effects::list())
    if (name == k.name) return std::make_unique<Subject>(model, k.make(params, model));
  throw std::runtime_error("no effect " + name);
}

inline Params table(std::initializer_list<std::pair<std::string, Params>> entries) {
  Params p = Params::make_table();
  for (const auto& [k, v] : entries) p.set(k, v);
  return p;
}
inline Params numbers(const std::vector<double>& v) {
  Params p = Params::make_list();
  for (double x : v) p.push(Params::make_number(x));
  return p;
}

// The rest state with every coordinate moved by up to `size`.
inline Vector shaken(const model::Model& model, double size, unsigned seed = 5) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> u(-size, size);
  Vector x = flatten(model.rest.download());
  for (double& v : x) v += u(rng);
  return x;
}

// Keeps what an effect reports.
struct Recorder : FieldSink {
  std::map<std::string, std::vector<double>> point, cell;
  std::map<std::string, double> scalars;
  void points(std::string_view n, std::string_view, int, std::span<const double> v) override { point[std::string(n)] = {v.begin(), v.end()}; }
  void cells(std::string_view n, std::string_view, int, std::span<const double> v) override { cell[std::string(n)] = {v.begin(), v.end()}; }
  void rows(std::string_view, std::string_view, std::string_view, int, std::span<const double>) override {}
  void scalar(std::string_view g, std::string_view n, std::string_view, double v) override { scalars[std::string(g) + "." + std::string(n)] = v; }
};

}  // namespace mortise::fd
