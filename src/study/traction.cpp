#include "study/traction.h"

#include <algorithm>

namespace mortise::study {

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

Traction nodal_traction(const Solved& s, const std::string& name, const std::function<bool(const Vec3&)>& on) {
  Traction out;
  const auto field = s.fields.point.find("contact_force");
  if (field == s.fields.point.end()) return out;
  std::size_t first = 0;
  for (const model::BodyInput& body : s.input.bodies) {
    if (body.name == name) {
      std::vector<Vec3> normal(body.nodes.size(), Vec3::Zero());  // times area
      std::vector<double> area(body.nodes.size(), 0);
      for (const Triangle& t : body.triangles) {
        if (!std::all_of(t.v, t.v + 3, [&](Index v) { return on(body.nodes[v]); })) continue;
        const Vec3 n = (body.nodes[t.v[1]] - body.nodes[t.v[0]]).cross(body.nodes[t.v[2]] - body.nodes[t.v[0]]) / 6;
        for (Index v : t.v) normal[v] += n, area[v] += n.norm();
      }
      for (std::size_t i = 0; i < body.nodes.size(); ++i) {
        if (!(area[i] > 0)) continue;
        const auto at = [&](const std::vector<double>& v) { return Vec3(v[3 * (first + i)], v[3 * (first + i) + 1], v[3 * (first + i) + 2]); };
        out.at.push_back(at(s.points));
        out.p.push_back(-at(field->second).dot(normal[i].normalized()) / area[i]);
        out.area.push_back(area[i]);
      }
    }
    if (body.type != model::BodyType::half_space) first += body.nodes.size();
  }
  return out;
}

double mean_gap(const Solved& s, const std::string& effect) {
  const auto gap = s.fields.row.find(effect + "/gap"), force = s.fields.row.find(effect + "/force");
  if (gap == s.fields.row.end() || force == s.fields.row.end()) return NAN;
  double sum = 0, total = 0;
  for (std::size_t i = 0; i < gap->second.size(); ++i) sum += force->second[i] * gap->second[i], total += force->second[i];
  return sum / total;
}

}  // namespace mortise::study
