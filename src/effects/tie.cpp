#include "effects/tie.h"

#include <algorithm>

#include "effects/tie_name.h"

namespace mortise::effects {

std::vector<PlanItem> tie_plan(std::string_view effect, const model::Model& model) {
  std::size_t bytes = 0;
  for (const model::Tie& tie : model.ties.list())
    if (tie.effect == effect)
      for (const model::Follow& follow : tie.follows) bytes += sizeof(Index) + sizeof(Vec3) + follow.terms.size() * (sizeof(Index) + sizeof(double));
  return {{"tied blocks", bytes}};
}

ParamTable tie_table(const char* effect, std::string help, std::vector<Param> own) {
  using param::of;
  own.insert(own.begin(), param::optional(of(Param::Kind::text, "name", Unit::none, std::nullopt,
                                             "What its force is called in the output; without it the names of its bodies.")));
  own.push_back(of(Param::Kind::flag, "contact", Unit::none, "false", "Whether the two bodies may touch; without it they pass through each other."));
  ParamTable table{std::string("effect ") + effect, std::move(help), std::move(own)};
  table.is_list = true;
  return table;
}

model::Tie tie_of(const char* effect, const Params& entry, Index body, Index to) {
  model::Tie tie;
  tie.effect = effect;
  tie.name = tie_name(entry);
  tie.where = entry.where();
  tie.body = body, tie.to = to;
  tie.contact = entry.flag("contact");
  return tie;
}

std::vector<std::pair<Index, Index>> tied_bodies(const model::Model& model, const Params& entry, model::BodyType type) {
  const auto found = [&](const char* key) {
    const Params& name = entry.at(key);
    std::vector<Index> all = model.bodies_named(name.as_text());
    if (all.empty()) throw Error(Exit::scene, name.where(), "no body is called '" + name.as_text() + "'");
    if (all.front() >= static_cast<Index>(model.bodies.size()))
      throw Error(Exit::scene, name.where(),
                  "'" + name.as_text() + "' is a half_space, which belongs to the world" +
                      (std::string(key) == "to" ? ": leave 'to' out" : " and cannot be tied to anything"));
    return all;
  };
  const std::vector<Index> bodies = found("body");
  std::vector<std::pair<Index, Index>> out;
  if (!entry.has("to")) {
    for (Index body : bodies) out.emplace_back(body, model::Tie::kWorld);
    return out;
  }
  const Params& other = entry.at("to");
  const bool stiff = type == model::BodyType::stiff;
  if (other.as_text() == entry.text("body") && stiff) throw Error(Exit::scene, other.where(), "ties '" + other.as_text() + "' to itself");
  for (Index to : found("to")) {
    if (model.bodies[to].type != type)
      throw Error(Exit::scene, other.where(),
                  "'" + other.as_text() +
                      (stiff ? "' is soft; joints and bonds tie to stiff bodies (mortar_tie ties soft ones)"
                             : "' is stiff; mortar_tie ties to soft bodies (a bond ties to stiff ones)"));
    for (Index body : bodies)
      if (model.bodies[body].env == model.bodies[to].env) out.emplace_back(body, to);
  }
  return out;
}

const model::BodyInput& input_of(const model::Model& model, Index body) {
  const model::Body& b = model.bodies[body];
  return *std::find_if(model.input.bodies.begin(), model.input.bodies.end(),
                       [&](const model::BodyInput& in) { return in.name == b.name && in.env == b.env; });
}

model::Follow material_point(const model::Model& model, Index body, const Vec3& place) {
  if (body == model::Tie::kWorld) return {-1, {}, place};
  const model::Body& b = model.bodies[body];
  const Vec3 X = place - b.centre;
  return {-1, {{b.block_begin, 1}, {b.block_begin + 1, X[0]}, {b.block_begin + 2, X[1]}, {b.block_begin + 3, X[2]}}};
}

}  // namespace mortise::effects
