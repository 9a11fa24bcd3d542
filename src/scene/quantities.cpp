#include "scene/quantities.h"

#include <algorithm>

#include "base/snapshot.h"
#include "scene/suggest.h"

namespace mortise::scene {

using Kind = Param::Kind;
using namespace param;

const ParamTable& quantity_table() {
  static const ParamTable t{
      "quantity",
      "One number of a run.",
      {optional(of(Kind::text, "name", Unit::none, {}, "What figures and tables call it.")),
       required(
           of(Kind::text, "value", Unit::none, {},
              "group/name of a scalar of the field file (barrier_contact/force_ball_z) or of a vector (supports/ball), steps/column, or, with body, "
              "a field of points (contact_pressure, displacement, position).")),
       optional(choice("axis", {"x", "y", "z", "size"}, "", "Component of a vector; size: its length.")),
       optional(of(Kind::text, "body", Unit::none, {}, "Body whose points are looked at.")),
       optional(choice("over", {"mean", "max", "min", "integral", "area", "percentile"}, "",
                       "What the field becomes over the body's surface: mean and percentile by area, the latter of where it is not zero; area: where "
                       "it is not zero; max, min: of all points. The integral of contact_pressure is the force.")),
       range(optional(of(Kind::number, "percent", Unit::none, {}, "Of a percentile: 99 is nearly the peak.")), 0, 100),
       optional(of(Kind::vec3, "point", Unit::length, {}, "Instead of over: at this place of the body at rest.")),
       choice("when", {"end", "start", "largest", "smallest", "mean", "sum", "range"}, "end",
              "Of the steps that have frames (time.frame_every; a study writes all): the last, the first, or what they all make; mean: over time; "
              "range: largest less smallest."),
       optional(of(Kind::number, "at", Unit::time, {}, "Instead of when: at this time, linear between steps.")),
       optional(of(Kind::number, "reference", Unit::any, {}, "Its right value, where that is known; in the unit of the field file or with a unit.")),
       range(optional(of(Kind::number, "uncertainty", Unit::any, {}, "Of the reference; 0 without.")), 0, std::numeric_limits<double>::infinity()),
       positive(optional(of(Kind::number, "scale", Unit::any, {},
                            "Errors are shares of the reference or of this, whichever is larger: for what should be zero.")))}};
  return t;
}

void check_quantity(const Params& q, const SourceLoc& at, const std::string& what, Diagnostics& errors) {
  if (!q.has("value")) return;
  const std::string& value = q.text("value");
  const bool field = !value.empty() && value.find('/') == std::string::npos;
  const bool body = q.has("body"), over = q.has("over"), point = q.has("point");
  const bool of_forces = value.ends_with("_force") && body;
  const std::string of_whole =
      of_forces ? "the force on all of '" + q.text("body") + "' is a scalar, group/force_" + q.text("body") + " or supports/" + q.text("body") : "";
  if (field && !body) errors.add(at, what + ": '" + value + "' is a field of points and needs a body; scalars are written group/name");
  if (!field && body) errors.add(at, what + ": '" + value + "' is a scalar; body belongs to fields of points");
  if (field && body && over == point)
    errors.add(at, what + " needs either over or point",
               "over: mean, max, min, integral, area or percentile of its surface; point: [x, y, z] on it" + (of_forces ? "; " + of_whole : ""));
  // Forces of points are no density: over a surface only the largest and the smallest mean something.
  static const std::set<std::string> meant{"max", "min", "area"};
  if (field && over && of_forces && !meant.count(q.text("over")))
    errors.add(at, what + ": '" + value + "' is a force of each point, whose " + q.text("over") + " over a surface is no force", of_whole);
  if ((over && q.text("over") == "percentile") != q.has("percent")) errors.add(at, what + ": percentile and percent belong together");
  if (q.has("when") && q.text("when") == "sum" && leaf_of(value) == "dissipation")
    errors.add(at, what + ": '" + value + "' is the sum since the start already; 'when: end' gives it");
  if (q.has("uncertainty") && q.number("uncertainty") > 0 && !q.has("reference")) errors.add(at, what + " has an uncertainty but no reference");
}

void check_quantities(const Params& root, const std::set<std::string>& incomplete, Diagnostics& errors) {
  const Params *list = root.find("quantities"), *bodies = root.find("bodies");
  if (!list) return;
  std::vector<std::string> with_points;
  if (bodies && !incomplete.count("bodies"))
    for (const auto& [name, body] : bodies->entries())
      if (const Params* type = body.find("type"); !type || type->as_text() != "half_space") with_points.push_back(name);
  std::set<std::string> names;
  for (std::size_t i = 0; i < list->items().size(); ++i) {
    const Params& q = list->items()[i];
    if (q.has("name") && !names.insert(q.text("name")).second)
      errors.add(q.at("name").where(), "quantities." + std::to_string(i) + ".name: there are two of '" + q.text("name") + "'");
    const std::string path = "quantities." + std::to_string(i);
    if (!incomplete.count(path)) check_quantity(q, q.where(), path, errors);
    const Params* body = q.find("body");
    if (body && !with_points.empty() && !std::count(with_points.begin(), with_points.end(), body->as_text()))
      errors.add(body->where(), path + ".body: no body '" + body->as_text() + "' has points", suggestion(body->as_text(), with_points));
  }
}

}  // namespace mortise::scene
