#include "effects/contact/pairs.h"

#include <algorithm>

#include "base/error.h"
#include "effects/contact/named.h"

namespace mortise::effects::contact {
namespace {

std::vector<Index> find(const model::Model& model, const Params& name) {
  std::vector<Index> found = model.bodies_named(name.as_text());
  if (found.empty()) throw Error(Exit::scene, name.where(), "no body is called '" + name.as_text() + "'");
  return found;
}

bool meets_itself(const model::Model& model, const model::Body& body) {
  if (body.type != model::BodyType::soft || body.prescribed()) return false;
  for (const model::BodyInput& in : model.input.bodies)
    if (in.name == body.name && in.env == body.env && in.params.has("self_contact")) return in.params.flag("self_contact");
  return true;
}

}  // namespace

void complete(const model::Model& model, WatchedPairs& pairs) {
  const Index n = pairs.of.bodies();
  for (Index i = 0; i < n; ++i) {
    const model::Body& a = model.bodies[i];
    if (meets_itself(model, a)) pairs.set(i, i, Watch::contact);
    for (Index j = i + 1; j < n && model.bodies[j].env == a.env; ++j) {
      const model::Body& b = model.bodies[j];
      if (a.prescribed() && b.prescribed()) pairs.set(i, j, a.carriage == b.carriage ? Watch::no : Watch::apart);
      if (pass(model.input.scene, a.name, b.name) || model.ties.pass(i, j)) pairs.set(i, j, Watch::no);
    }
    for (std::size_t p = 0; p < model.half_spaces.size(); ++p) {
      const Index plane = n + static_cast<Index>(p);
      if (a.prescribed()) pairs.set(i, plane, a.carriage == model::Body::kStill ? Watch::no : Watch::apart);
      if (pass(model.input.scene, a.name, model.half_spaces[p].name)) pairs.set(i, plane, Watch::no);
    }
  }
}

WatchedPairs watched_pairs(const model::Model& model, const Params* list) {
  WatchedPairs pairs(model);
  const Index n = pairs.of.bodies(), planes = static_cast<Index>(model.half_spaces.size());
  if (list) {
    for (const Params& pair : list->items()) {
      for (Index first : find(model, pair.items().at(0)))
        for (Index second : find(model, pair.items().at(1))) {
          const Index a = std::min(first, second), b = std::max(first, second);
          if (a >= n) throw Error(Exit::scene, pair.where(), "a half-space cannot touch another half-space");
          if (model.same_env(a, b)) pairs.set(a, b, Watch::contact);
        }
    }
  } else {
    for (Index a = 0; a < n; ++a) {
      for (Index b = a + 1; b < n && model.bodies[b].env == model.bodies[a].env; ++b) pairs.set(a, b, Watch::contact);
      for (Index p = 0; p < planes; ++p) pairs.set(a, n + p, Watch::contact);
    }
  }
  complete(model, pairs);
  return pairs;
}

}  // namespace mortise::effects::contact
