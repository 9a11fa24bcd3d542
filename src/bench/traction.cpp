#include "bench/traction.h"

#include <algorithm>

namespace mortise::bench {

double Traction::force() const {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) sum += p[i] * area[i];
  return sum;
}

double Traction::peak() const { return p.empty() ? NAN : *std::max_element(p.begin(), p.end()); }

double Traction::l2(const std::function<double(const Vec3&)>& exact, const std::function<bool(const Vec3&)>& in) const {
  double wrong = 0, all = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!in(at[i])) continue;
    const double e = exact(at[i]);
    wrong += area[i] * (p[i] - e) * (p[i] - e), all += area[i] * e * e;
  }
  return std::sqrt(wrong / all);
}

Traction nodal_traction(const Solved& s, const std::string& name, const std::function<bool(const Vec3&)>& on, bool quadratic) {
  Traction out;
  const auto force = s.fields.point.find("contact_force"), pressure = s.fields.point.find("contact_pressure");
  if (force == s.fields.point.end() || (quadratic && pressure == s.fields.point.end())) return out;
  std::size_t first = 0;
  for (const model::BodyInput& body : s.input.bodies) {
    if (body.name == name) {
      const auto vector = [&](const std::vector<double>& v, std::size_t i) { return Vec3(v.data() + 3 * (first + i)); };
      std::vector<Vec3> normal(body.nodes.size(), Vec3::Zero());  // times area
      std::vector<double> area(body.nodes.size(), 0), area_now(body.nodes.size(), 0);
      const auto third = [](const Vec3& a, const Vec3& b, const Vec3& c) -> Vec3 { return (b - a).cross(c - a) / 6; };
      for (const Triangle& t : body.triangles) {
        if (!std::all_of(t.v, t.v + 3, [&](Index v) { return on(body.nodes[v]); })) continue;
        const Vec3 n = third(body.nodes[t.v[0]], body.nodes[t.v[1]], body.nodes[t.v[2]]);
        const double a = third(vector(s.points, t.v[0]), vector(s.points, t.v[1]), vector(s.points, t.v[2])).norm();
        for (Index v : t.v) normal[v] += n, area[v] += n.norm(), area_now[v] += a;
      }
      for (std::size_t i = 0; i < body.nodes.size(); ++i) {
        if (!(area[i] > 0)) continue;
        out.node.push_back(i);
        out.now.push_back(vector(s.points, i));
        out.at.push_back(quadratic ? body.nodes[i] : out.now.back());
        out.p.push_back(quadratic ? pressure->second[first + i] * area_now[i] / area[i]
                                  : -vector(force->second, i).dot(normal[i].normalized()) / area[i]);
        out.area.push_back(area[i]);
      }
    }
    if (body.type != model::BodyType::half_space) first += body.nodes.size();
  }
  return out;
}

double sample_mean(const Solved& s, const std::string& effect, const std::function<double(const Vec3&)>& of) {
  const auto position = s.fields.row.find(effect + "/position"), force = s.fields.row.find(effect + "/force");
  if (position == s.fields.row.end() || force == s.fields.row.end()) return NAN;
  double sum = 0, total = 0;
  for (std::size_t i = 0; i < force->second.size(); ++i)
    sum += force->second[i] * of(Vec3(position->second.data() + 3 * i)), total += force->second[i];
  return sum / total;
}

double mean_gap(const Solved& s, const std::string& effect) {
  const auto gap = s.fields.row.find(effect + "/gap"), force = s.fields.row.find(effect + "/force");
  if (gap == s.fields.row.end() || force == s.fields.row.end()) return NAN;
  double sum = 0, total = 0;
  for (std::size_t i = 0; i < gap->second.size(); ++i) sum += force->second[i] * gap->second[i], total += force->second[i];
  return sum / total;
}

}  // namespace mortise::bench
