// The keys of a quantity.
#include "study/read.h"

namespace mortise::study {

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
                       "it is not zero; max, min: of all points.")),
       range(optional(of(Kind::number, "percent", Unit::none, {}, "Of a percentile: 99 is nearly the peak.")), 0, 100),
       optional(of(Kind::vec3, "point", Unit::length, {}, "Instead of over: at this place of the body at rest.")),
       choice("when", {"end", "start", "largest", "smallest", "mean", "sum", "range"}, "end",
              "Of the steps: the last, the first, or what they all make; mean: over time; range: largest less smallest."),
       optional(of(Kind::number, "at", Unit::time, {}, "Instead of when: at this time, linear between steps.")),
       optional(of(Kind::number, "reference", Unit::any, {}, "Its right value, where that is known; in the unit of the field file or with a unit.")),
       range(optional(of(Kind::number, "uncertainty", Unit::any, {}, "Of the reference; 0 without.")), 0, std::numeric_limits<double>::infinity()),
       positive(optional(of(Kind::number, "scale", Unit::any, {},
                            "Errors are shares of the reference or of this, whichever is larger: for what should be zero.")))}};
  return t;
}

}  // namespace mortise::study
