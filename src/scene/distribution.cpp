#include "scene/distribution.h"

#include <algorithm>
#include <cmath>

#include "scene/flow.h"
#include "scene/quantity.h"
#include "scene/suggest.h"

namespace mortise::scene {
namespace {

const std::vector<std::string> kNames{"uniform", "log_uniform", "normal", "choice"};

// Inverse of the standard normal distribution function: Phi(x) = erfc(-x/sqrt(2))/2 = u, by Newton's method from the tail's leading term.
double normal_quantile(double u) {
  if (u > 0.5) return -normal_quantile(1 - u);
  double x = -std::sqrt(std::max(0.0, -2 * std::log(2 * u)));
  for (int i = 0; i < 60; ++i) {
    const double density = std::exp(-0.5 * x * x) / std::sqrt(2 * 3.14159265358979323846),
                 step = (0.5 * std::erfc(-x / std::sqrt(2.0)) - u) / density;
    x -= step;
    if (std::abs(step) < 1e-15 * (1 + std::abs(x))) break;
  }
  return x;
}

}  // namespace

double Distribution::number(double u) const {
  if (kind == Kind::log_uniform) return a * std::pow(b / a, u);
  if (kind == Kind::normal) return a + b * normal_quantile(u);
  return a + (b - a) * u;
}

std::string Distribution::at(double u) const { return kind == Kind::choice ? choices[one_of(u, choices.size())] : format_number(number(u)); }

Distribution read_distribution(const Node& node, const std::string& what, Diagnostics& errors) {
  Distribution out;
  if (node.kind != Node::Kind::map || node.entries.size() != 1)
    return errors.add(node.at, what + " is " + node.describe() + "; must have one key of " + join(kNames, ", ")), out;
  const auto& [name, values] = node.entries.front();
  const auto it = std::find(kNames.begin(), kNames.end(), name);
  if (it == kNames.end()) return errors.add(values.key_at, what + ": no distribution '" + name + "'", suggestion(name, kNames)), out;
  out.kind = static_cast<Distribution::Kind>(it - kNames.begin());
  if (values.kind != Node::Kind::list || values.items.empty() || (out.kind != Distribution::Kind::choice && values.items.size() != 2))
    return errors.add(values.at, what + "." + name + " is " + values.describe() + "; must be a list of " +
                                     (out.kind == Distribution::Kind::choice ? "values" : "two numbers")),
           out;
  if (out.kind == Distribution::Kind::choice) {
    for (const Node& v : values.items) out.choices.push_back(flow(v));
    return out;
  }
  double* const to[] = {&out.a, &out.b};
  for (int k = 0; k < 2; ++k) {
    const Quantity q = parse_quantity(values.items[k].text, Unit::any);
    if (!q.error.empty()) return errors.add(values.items[k].at, what + "." + name + " " + q.error, q.hint), out;
    *to[k] = q.value;
  }
  if (out.kind == Distribution::Kind::normal ? out.b < 0 : out.b < out.a)
    errors.add(values.at,
               what + "." + name + ": the second number must not be " + (out.kind == Distribution::Kind::normal ? "negative" : "below the first"));
  if (out.kind == Distribution::Kind::log_uniform && out.a <= 0) errors.add(values.at, what + ".log_uniform: both ends must be positive");
  return out;
}

}  // namespace mortise::scene
