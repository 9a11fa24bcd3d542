#include "effects/where.h"

namespace mortise::effects {
namespace {

using param::of;
using param::optional;

const ParamTable kBox{"where box",
                      "Points inside an axis-aligned box.",
                      {of(Param::Kind::vec3, "min", Unit::length, std::nullopt, "Lowest corner, world coordinates at rest."),
                       of(Param::Kind::vec3, "max", Unit::length, std::nullopt, "Highest corner, world coordinates at rest.")}};

const ParamTable kSphere{"where sphere",
                         "Points inside a sphere.",
                         {of(Param::Kind::vec3, "centre", Unit::length, std::nullopt, "Centre, world coordinates at rest."),
                          param::positive(of(Param::Kind::number, "radius", Unit::length, std::nullopt, "Radius."))}};

}  // namespace

const ParamTable where_table = [] {
  ParamTable t{"where",
               "Selects points of a body by their place at rest.",
               {optional(param::choice("side", {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max", "all"}, "all",
                                       "A side of the body's bounding box, or the whole body.")),
                param::table("box", &kBox, "All points inside a box."), param::table("sphere", &kSphere, "All points inside a sphere.")}};
  t.one_of = true;
  return t;
}();

}  // namespace mortise::effects
