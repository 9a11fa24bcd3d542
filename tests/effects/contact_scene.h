#pragma once
// Contact problems built in the test, without scene files.
#include <map>
#include <random>

#include "effects/list.h"
#include "finite_difference.h"
#include "scene_builder.h"

namespace mortise::testing {

inline Params contact_params(double d_hat, double stiffness, const std::string& form = "area_weighted") {
  Params p = Params::make_table();
  p.set("d_hat", Params::make_number(d_hat));
  p.set("stiffness", Params::make_number(stiffness));
  p.set("form", Params::make_text(form));
  return p;
}

inline Params gel() { return material("neo_hookean", 1e5, 0.3, 1000); }

inline std::unique_ptr<fd::Subject> make_effect(const std::string& name, const Params& p, model::Model& m) {
  for (const effects::Kind& k : effects::list())
    if (name == k.name) return std::make_unique<fd::Subject>(m, k.make(p, m));
  throw std::runtime_error("no effect " + name);
}

inline fd::Vector positions(const model::Model& m) { return fd::flatten(m.q.download()); }

// Moves every degree of freedom a little, the same way every time.
inline fd::Vector shaken(fd::Vector x, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-size, size);
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] += u(random);
  return x;
}

// Keeps all that an effect reports.
struct Recorder final : FieldSink {
  std::map<std::string, std::vector<double>> values;
  void put(const std::string& key, std::span<const double> v) { values[key].assign(v.begin(), v.end()); }
  void points(std::string_view name, std::string_view, int, std::span<const double> v) override { put(std::string(name), v); }
  void cells(std::string_view name, std::string_view, int, std::span<const double> v) override { put(std::string(name), v); }
  void rows(std::string_view group, std::string_view name, std::string_view, int, std::span<const double> v) override {
    put(std::string(group) + "/" + std::string(name), v);
  }
  void scalar(std::string_view group, std::string_view name, std::string_view, double v) override {
    values[std::string(group) + "/" + std::string(name)] = {v};
  }
  double operator()(const std::string& key) const { return values.at(key).at(0); }
};

// Total force and moment on all points that a gradient by blocks stands for; for a stiff body, moment = sum_j a_j x f_{a_j} + p x
// f_p.
inline std::pair<Vec3, Vec3> resultant(const model::Model& m, const fd::Vector& x, const fd::Vector& g) {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  for (const model::Body& b : m.bodies)
    for (Index i = b.block_begin; i < b.block_end; ++i) {
      const Vec3 f = -g.segment<3>(3 * i), q = x.segment<3>(3 * i);
      if (b.type == model::BodyType::soft || i == b.block_begin) force += f;
      moment += q.cross(f);
    }
  return {force, moment};
}

}  // namespace mortise::testing
