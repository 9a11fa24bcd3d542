#include "effects/mortar_tie/mortar_tie.h"

#include "base/complaints.h"
#include "effects/tie.h"
#include "effects/where.h"
#include "geometry/bounds.h"
#include "model/select.h"

namespace mortise::effects {
namespace {

using param::of;
using param::optional;

const ParamTable kTable = tie_table(
    "mortar_tie", "Ties surfaces of soft bodies to each other whose meshes do not match.",
    {of(Param::Kind::text, "body", Unit::none, std::nullopt, "Name of the soft body whose nodes follow."),
     param::required(param::table("where", &where_table, "Its nodes; faces are tied of which all nodes are selected.")),
     of(Param::Kind::text, "to", Unit::none, std::nullopt,
        "Name of the soft body that they follow; its surface has to cover those faces. May be the same body."),
     param::table("to_where", &where_table, "Nodes of that body; only faces of which all nodes are selected are followed."),
     optional(param::positive(of(Param::Kind::number, "within", Unit::length, std::nullopt,
                                 "Farthest that the surfaces are from each other at rest; without it a thousandth of the size of the body.")))});

constexpr double kNear = 1e-3;  // `within`, of the size of the body: a gap makes an error of its share of an edge

mortar_tie::Side side(const model::BodyInput& body, const Params* where, const SourceLoc& at) {
  mortar_tie::Side out = mortar_tie::side_of(body, model::select(body.nodes, where));
  if (out.faces.empty()) {
    if (where) model::selects_nothing(*where, "whole face", body.name, body.nodes);
    throw Error(Exit::scene, at, "body '" + body.name + "' has no faces");
  }
  return out;
}

std::vector<model::Tie> ties(const Params& list, const model::Model& model) {
  std::vector<model::Tie> out;
  on_each(list.items(), [&](const Params& p) {
    for (const auto& [body, to] : tied_bodies(model, p, model::BodyType::soft)) {
      if (model.bodies[body].type != model::BodyType::soft)
        throw Error(Exit::scene, p.at("body").where(),
                    "'" + p.text("body") + "' is stiff; mortar_tie ties soft bodies (a bond ties to stiff ones, a joint stiff ones)");
      if (body == to && !p.has("to_where"))
        throw Error(Exit::scene, p.where(), "ties '" + p.text("body") + "' to itself: to which of its faces? give 'to_where'");
      const model::BodyInput &mine = input_of(model, body), &other = input_of(model, to);
      const mortar_tie::Side slave = side(mine, &p.at("where"), p.where()), master = side(other, p.find("to_where"), p.where());
      model::Tie tie = tie_of("mortar_tie", p, body, to);
      for (const mortar_tie::Row& row :
           mortar_tie::rows(slave, master, p.has("within") ? p.number("within") : kNear * geometry::bounds_of(mine.nodes).size().norm(), p.where())) {
        model::Follow f{model.bodies[body].block_begin + row.node, row.terms};
        for (model::TieTerm& term : f.terms) term.block += model.bodies[to].block_begin;
        tie.anchor.terms.push_back({f.block, 1});
        tie.follows.push_back(std::move(f));
      }
      for (model::TieTerm& term : tie.anchor.terms) term.weight /= static_cast<double>(tie.follows.size());
      out.push_back(std::move(tie));
    }
  });
  return out;
}

}  // namespace

const Kind& mortar_tie_kind() {
  static const Kind kind{
      "mortar_tie",
      Role::tie,
      "soft bodies are tied surface to surface",
      &kTable,
      [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<TieEffect>("mortar_tie", m, ties(p, m)); },
      {"Wohlmuth: A Mortar Finite Element Method Using Dual Spaces for the Lagrange Multiplier. SIAM J. Numer. Anal. 38(3), 2000",
       "Popp, Wohlmuth, Gee, Wall: Dual Quadratic Mortar Finite Element Methods for 3D Finite Deformation Contact. SIAM J. Sci. Comput. 34(4), 2012"},
      {"tie_force"}};
  return kind;
}

}  // namespace mortise::effects
