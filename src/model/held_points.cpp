#include "model/held_points.h"

#include <algorithm>
#include <map>
#include <string>

#include "model/bonded.h"
#include "model/select.h"

namespace mortise::model {
namespace {

// Entries of an effect that is a list; none where the scene does not name it.
std::vector<Params> listed(const ModelInput& input, const char* effect) {
  const Params* effects = input.scene.find("effects");
  const Params* list = effects ? effects->find(effect) : nullptr;
  return list ? list->items() : std::vector<Params>();
}

}  // namespace

unsigned mask_of(const std::string& axes) {
  unsigned mask = 0;
  for (const char c : axes) mask |= 1u << (c - 'x');
  return mask;
}

std::vector<bool> held_points(const ModelInput& input) {
  struct Place {
    const BodyInput* body;
    std::size_t first;
  };
  std::map<std::string, Place> bodies;
  std::size_t points = 0;
  for (const BodyInput& body : input.bodies) {
    if (body.type == BodyType::half_space) continue;
    bodies[body.name] = {&body, points};
    points += body.nodes.size();
  }
  std::vector<unsigned> axes(points, 0);
  for (const Params& pin : listed(input, "pin")) {
    const auto at = bodies.find(pin.text("body"));
    if (at == bodies.end() || pin.has("release") || !pin.has("where")) continue;
    for (Index i : select(at->second.body->nodes, pin.at("where"))) axes[at->second.first + i] |= mask_of(pin.text("axes"));
  }
  for (const Params& bond : listed(input, "bond")) {
    const auto soft = bodies.find(bond.text("body")), stiff = bodies.find(bond.text("to"));
    if (soft == bodies.end() || stiff == bodies.end()) continue;
    for (Index i : bonded(bond, *soft->second.body, *stiff->second.body)) axes[soft->second.first + i] = mask_of("xyz");
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

}  // namespace mortise::model
