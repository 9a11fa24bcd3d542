#include <algorithm>
#include <limits>

#include "judge/judge.h"

namespace judge {
namespace {

struct Motion {
  double mass = 0;
  Vector momentum{};
  double size = 0;  // sum of the sizes of what momentum is summed from [kg m/s]
};

// Shares of a tetrahedron's mass that its nodes carry in a sum over a field: corners and middles of edges.
Motion moving(const Body& body, const std::vector<Vector>& rest, const std::vector<Vector>& velocity) {
  Motion out;
  const auto add = [&](double m, const Vector& v) { out.momentum += m * v, out.size += std::abs(m) * norm(v); };
  for (std::size_t e = 0; e < body.tets.size(); ++e) {
    const auto& t = body.tets[e];
    const double m = body.density * volume(rest[t[0]], rest[t[1]], rest[t[2]], rest[t[3]]);
    out.mass += m;
    if (velocity.empty()) continue;
    for (long p : t) add(body.quadratic() ? -m / 20 : m / 4, velocity[p]);
    if (body.quadratic())
      for (long p : body.midsides[e]) add(m / 5, velocity[p]);
  }
  if (body.soft) return out;
  if (body.spread)
    out.mass = body.spread->mass;
  else
    for (const auto& t : body.triangles) out.mass += body.density * volume({}, rest[t[0]], rest[t[1]], rest[t[2]]);
  if (velocity.empty()) return out;
  double kinetic = 0;
  motion(body, rest, velocity, kinetic, out.momentum);
  out.size = std::sqrt(2 * out.mass * kinetic);
  return out;
}

// Are all edges of the elements straight at rest? Else masses need the integral over curved elements.
bool straight(const Body& body, const std::vector<Vector>& rest) {
  constexpr int kEnds[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  for (std::size_t e = 0; e < body.midsides.size(); ++e)
    for (int k = 0; k < 6; ++k) {
      const Vector &a = rest[body.tets[e][kEnds[k][0]]], &b = rest[body.tets[e][kEnds[k][1]]], &m = rest[body.midsides[e][k]];
      if (norm(2 * m - a - b) > 1e-6 * norm(b - a)) return false;
    }
  return true;
}

// What rounding of its positions makes of the forces in a body [N]: eps |x| is a way, E L a stiffness.
double rounding_force(const Body& body, const std::vector<Vector>& rest) {
  double farthest = 0, size = 0;
  for (long p : body.points) farthest = std::fmax(farthest, norm(rest[p])), size = std::fmax(size, norm(rest[p] - rest[body.points[0]]));
  return body.soft ? static_cast<double>(body.points.size()) * std::numeric_limits<double>::epsilon() * (farthest + size) * body.youngs_modulus * size
                   : 0;
}

std::vector<double> column(const File& file, const std::string& path) { return file.has(path) ? file.numbers(path) : std::vector<double>{}; }

}  // namespace

// Sum of the forces on a body, less the change of its momentum, against what the solver said that it left: the residual of the step in every
// node, its tolerance as a share of the forces on the body, and rounding of what was saved.
void judge_forces(const File& file, const Case& c, Verdict& v) {
  const std::vector<double> residual = column(file, "/mortise/steps/residual"), lag = column(file, "/mortise/steps/lag_residual"),
                            substeps = column(file, "/mortise/steps/substeps"), first_order = column(file, "/mortise/steps/first_order");
  const long steps = static_cast<long>(residual.size());
  if (c.loads || c.frame_every != 1 || steps + 1 != c.frames || static_cast<long>(lag.size()) != steps || static_cast<long>(substeps.size()) != steps)
    return;
  if (c.inertia && !(c.step > 0)) return;
  const double rounding = c.double_precision ? 1e-9 : 1e-6;
  const std::size_t n = c.rest.size();
  std::vector<std::vector<double>> fields;
  for (const char* name : {"contact_force", "friction_force", "support_force"})
    fields.push_back(column(file, std::string("/VTKHDF/PointData/") + name));
  const std::vector<double> velocity = c.inertia ? column(file, "/VTKHDF/PointData/velocity") : std::vector<double>{};
  if ((c.contact && fields[0].empty()) || (c.friction && fields[1].empty()) || (c.inertia && velocity.empty())) return;
  std::vector<std::vector<Vector>> positions;  // of every frame, where slides need them
  if (!c.slides.empty()) {
    const std::vector<double> all = file.numbers("/VTKHDF/Points");
    for (long f = 0; f < c.frames; ++f) positions.push_back(frame_of(all, f, n));
  }
  for (const Body& body : c.bodies) {
    if (!straight(body, c.rest)) continue;
    std::vector<double> support[3];
    if (!body.soft)  // also of one that slides on a prescribed body, across its way
      for (int k = 0; k < 3; ++k) support[k] = column(file, "/mortise/effects/supports/" + body.name + "_" + "xyz"[k]);
    if (body.pinned && (body.soft ? fields[2].empty() : support[2].empty())) continue;  // not saved
    std::vector<std::pair<double, std::vector<double>>> ties;                           // with which share, and one axis after the other
    for (const Tie& t : c.ties)
      for (const auto& [name, share] : t.share)
        if (name == body.name)
          for (const char* axis : {"x", "y", "z"}) ties.emplace_back(share, column(file, t.figures + axis));
    std::vector<std::pair<const Slide*, std::vector<double>>> motors;  // and drags, and stops
    for (const Slide& s : c.slides)
      if (s.body == body.name || s.to == body.name)
        for (const char* figure : {"drive/%_force", "drive/%_drag", "joint/%_stop", "joint/%_coupling"}) {
          std::string path = std::string("/mortise/effects/") + figure;
          path.replace(path.find('%'), 1, s.name);
          const bool counted = s.given && path.find("_force") != std::string::npos;
          if (!counted && file.has(path)) motors.emplace_back(&s, file.numbers(path));
        }
    for (const Slide& s : c.slides)
      for (const auto& [path, share] : s.leads) {
        if ((s.body != body.name && s.to != body.name) || !file.has(path)) continue;
        motors.emplace_back(&s, file.numbers(path));
        for (double& f : motors.back().second) f *= share;
      }
    const double floor = rounding_force(body, c.rest);
    std::vector<Motion> at;  // of every frame
    for (long f = 0; f < c.frames; ++f) at.push_back(moving(body, c.rest, c.inertia ? frame_of(velocity, f, n) : std::vector<Vector>{}));
    for (long f = 1; f < c.frames; ++f) {
      const bool whole = substeps[f - 1] == 1 && (!c.bdf2 || f == 1 || substeps[f - 2] == 1);
      if (c.inertia && !whole) continue;
      Vector sum = at[f].mass * c.gravity;
      double size = norm(sum);
      for (const std::vector<double>& field : fields)
        for (std::size_t k = 0; !field.empty() && k < body.points.size(); ++k) {
          const double* force = &field[3 * (f * n + body.points[k])];
          const Vector on{force[0], force[1], force[2]};
          sum += on, size += norm(on);
        }
      if (!support[2].empty()) {
        const Vector on{support[0][f], support[1][f], support[2][f]};
        sum += on, size += norm(on);
      }
      for (std::size_t t = 0; t + 2 < ties.size(); t += 3) {
        const Vector on{ties[t].second[f], ties[t + 1].second[f], ties[t + 2].second[f]};
        sum += ties[t].first * on, size += norm(on);
      }
      for (const auto& [slide, figures] : motors) {
        Vector axis = slide->axis;
        for (const Body& carrier : c.bodies)
          if (carrier.name == slide->to) axis = turned(carrier, c.rest, positions[f], axis);
        sum += (slide->body == body.name ? 1 : -1) * figures[f] * axis, size += std::abs(figures[f]);
      }
      if (c.inertia) {  // backward Euler, or BDF2 from the second step on, where it did not leave the step to backward Euler
        const bool second = c.bdf2 && f > 1 && !(static_cast<long>(first_order.size()) == steps && first_order[f - 1] > 0);
        const Vector change =
            second ? 1.5 * at[f].momentum - 2 * at[f - 1].momentum - -0.5 * at[f - 2].momentum : at[f].momentum - at[f - 1].momentum;
        sum += (-1 / c.step) * change;
        size += (at[f].size + at[f - 1].size) / c.step;
      }
      const double nodes = body.soft ? static_cast<double>(body.points.size()) : 1;
      // The residual that is reported is the worst body's; others were solved to their own tolerance.
      const double error =
          norm(sum) / (nodes * std::fmax(residual[f - 1], lag[f - 1]) + ((body.pinned ? nodes : 1) * c.tolerance + rounding) * size + floor);
      ++v.forces;
      if (!(error <= v.force_error)) v.force_error = error;
      if (!(error <= 1) && std::isfinite(size) && size > 0)
        v.found(f, "the forces on " + body.name + " do not add up: " + std::to_string(norm(sum)) + " N are left");
    }
  }
}

}  // namespace judge
