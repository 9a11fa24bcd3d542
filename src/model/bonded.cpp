#include "model/bonded.h"

#include "geometry/enclosure.h"
#include "model/select.h"

namespace mortise::model {

std::vector<Index> bonded(const Params& bond, const BodyInput& soft, const BodyInput& stiff) {
  if (!bond.has("where") && !bond.has("within")) throw Error(Exit::scene, bond.where(), "which nodes are bonded? give 'where', 'within' or both");
  std::vector<Index> nodes = select(soft.nodes, bond.find("where"));
  if (nodes.empty()) selects_nothing(bond.at("where"), "node", soft.name, soft.nodes);
  if (!bond.has("within")) return nodes;
  const geometry::Enclosure body(stiff.nodes, stiff.triangles);
  const double within = bond.number("within");
  std::erase_if(nodes, [&](Index i) { return !body.holds(soft.nodes[i], within); });
  if (nodes.empty())
    throw Error(
        Exit::scene, bond.at("within").where(),
        "no node of '" + soft.name + "'" + (bond.has("where") ? " among them" : "") + " is that near to '" + stiff.name + "' or inside of it");
  return nodes;
}

}  // namespace mortise::model
