#include "base/complaints.h"
#include "effects/tie.h"
#include "effects/where.h"
#include "model/bonded.h"

namespace mortise::effects {
namespace {

using param::of;
using param::optional;

const ParamTable kTable = tie_table("bond", "Nodes of soft bodies that move with a stiff body, without matching vertices.",
                                    {of(Param::Kind::text, "body", Unit::none, std::nullopt, "Name of the soft body."),
                                     of(Param::Kind::text, "to", Unit::none, std::nullopt, "Name of the stiff body that it is bonded to."),
                                     param::table("where", &where_table, "Nodes of the soft body that are bonded."),
                                     optional(param::range(of(Param::Kind::number, "within", Unit::length, std::nullopt,
                                                              "Only nodes inside the stiff body or as near to its surface as this."),
                                                           0, INFINITY))});

// q_n = p + A X: every node follows the material point of the stiff body that is where it is at rest.
std::vector<model::Tie> ties(const Params& list, const model::Model& model) {
  std::vector<model::Tie> out;
  on_each(list.items(), [&](const Params& p) {
    for (const auto& [body, to] : tied_bodies(model, p)) {
      const model::Body& soft = model.bodies[body];
      if (soft.type != model::BodyType::soft)
        throw Error(Exit::scene, p.at("body").where(),
                    "'" + soft.name + "' is stiff; bonds are of soft bodies (a joint of type fixed ties stiff ones)");
      model::Tie tie = tie_of("bond", p, body, to);
      const std::vector<Vec3>& rest = input_of(model, body).nodes;
      Vec3 mean = Vec3::Zero();
      for (Index node : model::bonded(p, input_of(model, body), input_of(model, to))) {
        model::Follow f = material_point(model, to, rest[node]);
        f.block = soft.block_begin + node;
        tie.follows.push_back(std::move(f));
        mean += rest[node];
      }
      tie.anchor = material_point(model, to, mean / static_cast<double>(tie.follows.size()));
      out.push_back(std::move(tie));
    }
  });
  return out;
}

}  // namespace

const Kind& bond_kind() {
  static const Kind kind{
      "bond",
      Role::tie,
      "soft bodies are bonded to stiff ones",
      &kTable,
      [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<TieEffect>("bond", m, ties(p, m)); },
      {},
      {"tie_force"}};
  return kind;
}

}  // namespace mortise::effects
