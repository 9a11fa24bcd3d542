#include "cost/coarser.h"

namespace mortise::cost {
namespace {

bool is_edge(const std::string& key, const Params& value) {
  return (key == "edge_length" || key == "surface_edge_length") && value.kind() == Params::Kind::number;
}

bool has_edges(const Params& shape) {
  if (shape.kind() == Params::Kind::table)
    for (const auto& [key, value] : shape.entries())
      if (is_edge(key, value) || has_edges(value)) return true;
  return false;
}

Params with_edges(const Params& shape, double factor) {
  if (shape.kind() != Params::Kind::table) return shape;
  Params out = Params::make_table(shape.where());
  for (const auto& [key, value] : shape.entries())
    out.set(key, is_edge(key, value) ? Params::make_number(factor * value.as_number(), value.where()) : with_edges(value, factor));
  return out;
}

}  // namespace

bool can_be_coarser(const Params& scene, const std::string& body) {
  const Params& block = scene.at("bodies").at(body);
  return block.text("type") == "soft" && block.has("shape") && has_edges(block.at("shape"));
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
