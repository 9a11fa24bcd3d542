#include "study/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/snapshot.h"
#include "scene/suggest.h"

namespace mortise::study {
namespace {

using output::FieldReader;
using output::FieldValues;

[[noreturn]] void unknown(const Quantity& q, const std::string& what, const std::vector<std::string>& known) {
  std::string text = fmt::format("quantity '{}': {}", q.name, what);
  const std::string best = scene::nearest(q.value, known);
  if (!best.empty()) text += "; did you mean '" + best + "'?";
  std::vector<std::string> near;  // of the same group, or all
  for (const std::string& k : known)
    if (group_of(k) == group_of(q.value)) near.push_back(k);
  text += "\n  there are: " + scene::join(near.empty() ? known : near, ", ");
  throw Error(Exit::usage, q.place, text);
}

double component(const double* v, int components, const std::string& axis) {
  if (components == 1) return v[0];
  if (axis.size() == 1) return v[axis[0] - 'x'];
  double squares = 0;
  for (int c = 0; c < components; ++c) squares += v[c] * v[c];
  return std::sqrt(squares);
}

History of_steps(const FieldReader& file, const Quantity& q) {
  const std::string name = leaf_of(q.value);
  std::vector<std::string> known;
  for (const output::StepColumn& column : output::step_columns) {
    known.push_back(std::string("steps/") + column.name);
    if (name != column.name) continue;
    History out;
    for (const output::StepRow& row : file.steps())
      if (std::isfinite(row.*column.value)) out.time.push_back(row.time), out.value.push_back(row.*column.value);
    return out;
  }
  unknown(q, "steps have no such column", known);
}

// A scalar, or the vector whose components are called <name>_x, _y, _z.
History of_scalar(const FieldReader& file, const Quantity& q) {
  const std::vector<std::string> known = file.scalars();
  const auto has = [&](const std::string& name) { return std::count(known.begin(), known.end(), name) > 0; };
  std::vector<std::string> parts;
  if (has(q.value))
    parts = {q.value};
  else if (has(q.value + "_x") && has(q.value + "_z"))
    for (const char* c : {"_x", "_y", "_z"}) parts.push_back(q.value + c);
  else
    unknown(q, "nothing reports '" + q.value + "'", known);
  if (parts.size() == 1 && !q.axis.empty())
    throw Error(Exit::usage, q.place, fmt::format("quantity '{}': '{}' is a number and has no axis", q.name, q.value));
  History out;
  for (std::int64_t f = 0; f < file.frames(); ++f) {
    double v[3] = {};
    for (std::size_t c = 0; c < parts.size(); ++c) v[c] = file.scalar(group_of(parts[c]), leaf_of(parts[c]), f).values.at(0);
    const double value = component(v, static_cast<int>(parts.size()), q.axis);
    if (std::isfinite(value)) out.time.push_back(file.time(f)), out.value.push_back(value);
  }
  return out;
}

// The area that points stand for in a field, where that is another than a third of the triangles around: under a pressure of contact that by which
// force makes pressure (effects/contact/nodal_pressure.h), so that its integral is the force, and no triangle counts that goes on beside the contact.
std::vector<double> areas_of(const FieldReader& file, const Quantity& q, std::int64_t frame) {
  if (q.value != "contact_pressure" || q.over.empty() || !std::ranges::count(file.point_fields(), "contact_area")) return {};
  return file.point_field("contact_area", frame).values;
}

History of_field(const FieldReader& file, const Quantity& q) {
  std::vector<std::string> known = file.point_fields();
  std::erase(known, "body_id");
  known.emplace_back("position");
  if (!std::count(known.begin(), known.end(), q.value)) unknown(q, "there is no field of points '" + q.value + "'", known);
  const std::vector<std::string>& bodies = file.mesh().body_names;
  if (!std::count(bodies.begin(), bodies.end(), q.body))
    throw Error(Exit::usage, q.place, fmt::format("quantity '{}': no body '{}' has points\n  {}", q.name, q.body, scene::suggestion(q.body, bodies)));
  History out;
  for (std::int64_t f = q.of_history() || q.when == "start" ? 0 : file.frames() - 1; f < file.frames(); ++f) {
    const std::vector<Vec3> points = file.points(f);
    FieldValues values;
    if (q.value == "position") {
      values.components = 3;
      for (const Vec3& x : points) values.values.insert(values.values.end(), x.data(), x.data() + 3);
    } else {
      values = file.point_field(q.value, f);
    }
    // One number per point from here on.
    FieldValues one{1, values.unit, {}};
    for (std::size_t i = 0; i < points.size(); ++i) one.values.push_back(component(&values.values[i * values.components], values.components, q.axis));
    const double value = over_body(file.mesh(), points, one, q, areas_of(file, q, f));
    if (std::isfinite(value)) out.time.push_back(file.time(f)), out.value.push_back(value);
  }
  return out;
}

}  // namespace

double reduced(const History& h, const Quantity& q) {
  if (h.value.empty()) return NAN;
  const auto [least, most] = std::minmax_element(h.value.begin(), h.value.end());
  if (q.at) {
    // Times are sums of steps: a hair of rounding decides nothing.
    const double t = *q.at, hair = 1e-9 * std::max(std::abs(h.time.back()), std::abs(t));
    if (t < h.time.front() - hair || t > h.time.back() + hair) return NAN;
    const auto after = std::lower_bound(h.time.begin(), h.time.end(), t - hair);
    const std::size_t i = std::min<std::size_t>(after - h.time.begin(), h.time.size() - 1);
    if (i == 0 || std::abs(h.time[i] - t) <= hair) return h.value[i];
    const double s = (t - h.time[i - 1]) / (h.time[i] - h.time[i - 1]);
    return (1 - s) * h.value[i - 1] + s * h.value[i];
  }
  if (q.when == "start") return h.value.front();
  if (q.when == "largest") return *most;
  if (q.when == "smallest") return *least;
  if (q.when == "range") return *most - *least;
  double sum = 0, area = 0;
  for (std::size_t i = 0; i < h.value.size(); ++i) {
    sum += h.value[i];
    if (i > 0) area += 0.5 * (h.value[i] + h.value[i - 1]) * (h.time[i] - h.time[i - 1]);
  }
  if (q.when == "sum") return sum;
  if (q.when == "mean") return h.value.size() > 1 ? area / (h.time.back() - h.time.front()) : h.value[0];
  return h.value.back();
}

namespace {

History history_of(const FieldReader& file, const Quantity& q) {
  if (file.frames() == 0) return {};
  if (q.value.find('/') == std::string::npos) return of_field(file, q);
  return group_of(q.value) == "steps" ? of_steps(file, q) : of_scalar(file, q);
}

}  // namespace

double measure(const FieldReader& file, const Quantity& q) { return reduced(history_of(file, q), q); }

namespace {

// Of what a quantity is the end of: the sum over its ends of what `beyond` says of the values, the smallest of which are told as the largest.
template <class F>
double at_ends(const FieldReader& file, const Quantity& q, const F& beyond) {
  const bool largest = q.when == "largest" || q.when == "range", smallest = q.when == "smallest" || q.when == "range";
  if (q.at || !(largest || smallest)) return 0;
  std::vector<double> v = history_of(file, q).value;
  if (v.empty()) return 0;
  double out = largest ? beyond(v) : 0;
  for (double& x : v) x = -x;
  return smallest ? out + beyond(v) : out;
}

}  // namespace

double missed_between(const FieldReader& file, const Quantity& q) {
  return at_ends(file, q, [](const std::vector<double>& v) {
    const auto most = std::max_element(v.begin(), v.end());
    double out = 0;
    if (most != v.begin()) out = *most - *(most - 1);
    return most + 1 != v.end() ? std::max(out, *most - *(most + 1)) : out;
  });
}

double turned_between(const FieldReader& file, const Quantity& q) {
  return at_ends(file, q, [](const std::vector<double>& v) {
    const double most = *std::max_element(v.begin(), v.end());
    double out = 0;
    for (std::size_t i = 1; i + 2 < v.size(); ++i) {
      const double rise = v[i] - v[i - 1], fall = v[i + 1] - v[i + 2];  // v_i + rise s = v_i+1 + fall (1 - s)
      const double s = rise > 0 && fall > 0 ? (v[i + 1] + fall - v[i]) / (rise + fall) : -1;
      if (s > 0 && s < 1) out = std::max(out, v[i] + rise * s - most);
    }
    return out;
  });
}

double largest_apart(const FieldReader& file, const FieldReader& other, const Quantity& q) {
  if (!q.at && q.when != "end") return 0;
  const History one = history_of(file, q), two = history_of(other, q);
  double apart = 0, largest = 0;
  for (std::size_t i = 0; i < std::min(one.value.size(), two.value.size()) && !(q.at && one.time[i] > *q.at); ++i)
    apart = std::max(apart, std::abs(one.value[i] - two.value[i])), largest = std::max(largest, std::abs(one.value[i]));
  return largest > 0 ? apart / largest : 0;
}

}  // namespace mortise::study
