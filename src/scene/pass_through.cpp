#include "scene/pass_through.h"

#include <algorithm>

namespace mortise::scene {
namespace {

std::vector<std::pair<std::string, const Params*>> contact_effects(const Params& scene, std::span<const EffectTable> tables) {
  std::vector<std::pair<std::string, const Params*>> out;
  for (const auto& [name, effect] : scene.at("effects").entries())
    if (std::any_of(tables.begin(), tables.end(), [&](const EffectTable& t) { return t.contact && t.name == name; })) out.emplace_back(name, &effect);
  return out;
}

bool may_collide(const Params& scene, const std::string& a, const std::string& b) {
  const Params* list = scene.find("pairs");
  return !list || std::none_of(list->items().begin(), list->items().end(), [&](const Params& pair) {
    const std::vector<Params>& names = pair.at("bodies").items();
    const auto named = [&](const std::string& body) {
      return std::any_of(names.begin(), names.end(), [&](const Params& n) { return n.as_text() == body; });
    };
    return !pair.flag("collide") && named(a) && named(b);
  });
}

// The effect that ties the two bodies without contact between them; nullptr if none does.
const char* tied_by(const Params& scene, std::span<const EffectTable> tables, const std::string& a, const std::string& b) {
  for (const EffectTable& table : tables) {
    const Params* list = table.ties ? scene.at("effects").find(table.name) : nullptr;
    if (!list) continue;
    for (const Params& tie : list->items()) {
      if (!tie.has("to") || tie.flag("contact")) continue;
      const std::string &one = tie.text("body"), &other = tie.text("to");
      if ((one == a && other == b) || (one == b && other == a)) return table.name.c_str();
    }
  }
  return nullptr;
}

// Does the scene say at all times where the body is? still: and always in the same place.
bool prescribed(const Params& scene, const std::string& name, const Params& body, bool still) {
  if (body.text("type") == "half_space") return true;
  const Params* pins = scene.at("effects").find("pin");
  return pins && std::any_of(pins->items().begin(), pins->items().end(), [&](const Params& pin) {
           const Params* side = pin.at("where").find("side");
           const bool wholly = pin.text("body") == name && side && side->as_text() == "all" && pin.text("axes").size() == 3 && !pin.has("release");
           return wholly && !(still && pin.has("motion"));
         });
}

}  // namespace

std::string PassThrough::text() const {
  if (everything) return "nothing keeps bodies apart: " + why;
  if (bodies.size() == 1) return "'" + bodies[0] + "' passes through itself: " + why;
  return "'" + bodies[0] + "' and '" + bodies[1] + "' pass through each other: " + why;
}

const Params* listed_pair(const Params& effect, const std::string& a, const std::string& b) {
  const Params* list = effect.find("pairs");
  if (!list || list->kind() != Params::Kind::list) return nullptr;
  for (const Params& pair : list->items()) {
    const bool table = pair.kind() == Params::Kind::table;
    if (table ? !pair.has("slave") || !pair.has("master") : pair.items().size() != 2) continue;
    const std::string &first = table ? pair.text("slave") : pair.items()[0].as_text(),
                      &second = table ? pair.text("master") : pair.items()[1].as_text();
    if ((first == a && second == b) || (first == b && second == a)) return &pair;
  }
  return nullptr;
}

std::vector<PassThrough> pass_through(const Params& scene, std::span<const EffectTable> effects) {
  std::vector<PassThrough> out;
  const auto contacts = contact_effects(scene, effects);
  const auto& bodies = scene.at("bodies").entries();
  if (contacts.empty()) {
    PassThrough all{{}, "the scene has no contact effect", true};
    for (const auto& [name, body] : bodies) all.bodies.push_back(name);
    if (all.bodies.size() > 1) out.push_back(std::move(all));
    return out;
  }
  for (auto a = bodies.begin(); a != bodies.end(); ++a) {
    if (a->second.text("type") == "soft" && !a->second.flag("self_contact")) out.push_back({{a->first}, "self_contact is false"});
    for (auto b = a + 1; b != bodies.end(); ++b) {
      const auto both = [&](bool still) { return prescribed(scene, a->first, a->second, still) && prescribed(scene, b->first, b->second, still); };
      if (both(true)) continue;
      if (!may_collide(scene, a->first, b->first)) {
        out.push_back({{a->first, b->first}, "pairs says collide: false"});
        continue;
      }
      if (const char* tie = tied_by(scene, effects, a->first, b->first)) {
        out.push_back({{a->first, b->first}, std::string("a ") + tie + " ties them to each other (it may say contact: true)"});
        continue;
      }
      if (both(false)) continue;  // kept apart whatever effects list
      std::string names;
      const bool seen = std::any_of(contacts.begin(), contacts.end(), [&](const auto& c) {
        names += (names.empty() ? "" : " and ") + c.first;
        return !c.second->has("pairs") || listed_pair(*c.second, a->first, b->first);
      });
      if (!seen) out.push_back({{a->first, b->first}, "not among the pairs of " + names});
    }
  }
  return out;
}

}  // namespace mortise::scene
