#include "effects/barrier_contact/pairs.h"

#include <algorithm>

#include "base/error.h"

namespace mortise::effects::contact {
namespace {

// Index of a body, or the number of bodies plus the index of a half-space.
Index find(const model::Model& model, const Params& name) {
  const Index body = model.body_index(name.as_text());
  if (body >= 0) return body;
  for (std::size_t p = 0; p < model.half_spaces.size(); ++p)
    if (model.half_spaces[p].name == name.as_text()) return static_cast<Index>(model.bodies.size() + p);
  throw Error(Exit::scene, name.where(), "no body is called '" + name.as_text() + "'");
}

bool moves(const model::Model& model, const model::Body& body) {
  for (Index b = body.block_begin; b < body.block_end; ++b)
    if (model.held[b] != 2) return true;
  return false;
}

bool wants_self_contact(const model::Model& model, const model::Body& body) {
  for (const model::BodyInput& in : model.input.bodies)
    if (in.name == body.name && in.params.has("self_contact")) return in.params.flag("self_contact");
  return false;
}

}  // namespace

WatchedPairs watched_pairs(const model::Model& model, const Params* list) {
  const Index n = static_cast<Index>(model.bodies.size()), planes = static_cast<Index>(model.half_spaces.size());
  WatchedPairs w{std::vector<std::uint8_t>(n * n, 0), std::vector<std::uint8_t>(planes * n, 0)};
  const auto watch = [&](Index a, Index b, const SourceLoc& at) {
    if (a > b) std::swap(a, b);
    if (a >= n) throw Error(Exit::scene, at, "a half-space cannot touch another half-space");
    if (b >= n)
      w.planes[(b - n) * n + a] = 1;
    else
      w.bodies[a * n + b] = w.bodies[b * n + a] = 1;
  };
  if (list) {
    for (const Params& pair : list->items())
      watch(find(model, pair.items().at(0)), find(model, pair.items().at(1)), pair.where());
  } else {
    for (Index a = 0; a < n; ++a) {
      for (Index b = a + 1; b < n + planes; ++b)
        if (b >= n || model.bodies[a].env == model.bodies[b].env) watch(a, b, {});
      if (wants_self_contact(model, model.bodies[a])) watch(a, a, {});
    }
  }
  for (Index a = 0; a < n; ++a) {
    if (moves(model, model.bodies[a])) continue;
    for (Index p = 0; p < planes; ++p) w.planes[p * n + a] = 0;
    for (Index b = 0; b < n; ++b)
      if (!moves(model, model.bodies[b])) w.bodies[a * n + b] = 0;
  }
  return w;
}

}  // namespace mortise::effects::contact
