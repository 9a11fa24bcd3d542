#include "cost/coarser.h"

#include "scene/edge_lengths.h"

namespace mortise::cost {
namespace {

Params with_edges(const Params& shape, double factor) {
  if (shape.kind() != Params::Kind::table) return shape;
  Params out = Params::make_table(shape.where());
  for (const auto& [key, value] : shape.entries()) {
    const bool edge = scene::is_edge_length(key) && value.kind() == Params::Kind::number;
    out.set(key, edge ? Params::make_number(factor * value.as_number(), value.where()) : with_edges(value, factor));
  }
  return out;
}

}  // namespace

bool can_be_coarser(const Params& scene, const std::string& body) {
  const Params& block = scene.at("bodies").at(body);
  return block.text("type") == "soft" && block.has("shape") && !scene::edge_lengths(block.at("shape")).empty();
}

Params coarser(const Params& scene, double edges) {
  Params out = scene, bodies = scene.at("bodies");
  for (const auto& [name, block] : scene.at("bodies").entries()) {
    if (!can_be_coarser(scene, name)) continue;
    Params body = block;
    body.set("shape", with_edges(block.at("shape"), edges));
    bodies.set(name, std::move(body));
  }
  out.set("bodies", std::move(bodies));
  return out;
}

}  // namespace mortise::cost
