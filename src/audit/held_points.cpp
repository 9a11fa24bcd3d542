#include "audit/held_points.h"

#include <algorithm>
#include <map>
#include <string>

#include "audit/entries.h"
#include "model/bonded.h"
#include "model/select.h"

namespace mortise::audit {

unsigned mask_of(const std::string& axes) {
  unsigned mask = 0;
  for (const char c : axes) mask |= 1u << (c - 'x');
  return mask;
}

std::vector<bool> held_points(const model::ModelInput& input) {
  struct Place {
    const model::BodyInput* body;
    std::size_t first;
  };
  std::map<std::string, Place> bodies;
  std::size_t points = 0;
  for (const model::BodyInput& body : input.bodies) {
    if (body.type == model::BodyType::half_space) continue;
    bodies[body.name] = {&body, points};
    points += body.nodes.size();
  }
  std::vector<unsigned> axes(points, 0);
  const Params* found = input.scene.find("effects");
  const Params effects = found ? *found : Params::make_table();
  for (const Params& pin : entries(effects, "pin")) {
    const auto at = bodies.find(pin.text("body"));
    if (at == bodies.end() || pin.has("release") || !pin.has("where")) continue;
    for (Index i : model::select(at->second.body->nodes, pin.at("where"))) axes[at->second.first + i] |= mask_of(pin.text("axes"));
  }
  for (const Params& bond : entries(effects, "bond")) {
    const auto soft = bodies.find(bond.text("body")), stiff = bodies.find(bond.text("to"));
    if (soft == bodies.end() || stiff == bodies.end()) continue;
    for (Index i : model::bonded(bond, *soft->second.body, *stiff->second.body)) axes[soft->second.first + i] = mask_of("xyz");
  }
  std::vector<bool> out;
  for (const unsigned a : axes) out.push_back(a == mask_of("xyz"));
  return out;
}

double one_sided(const std::vector<bool>& held, std::size_t first, std::size_t count) {
  const auto begin = held.begin() + static_cast<std::ptrdiff_t>(first), end = begin + static_cast<std::ptrdiff_t>(count);
  const auto free = std::count(begin, end, false);
  return free > 0 ? static_cast<double>(count) / static_cast<double>(free) : 1;
}

}  // namespace mortise::audit
