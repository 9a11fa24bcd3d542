#include "effects/pin/table.h"

#include "effects/where.h"

namespace mortise::effects::pin {
namespace {

using param::of;
using param::optional;
using param::range;

const ParamTable kRotation{"pin rotation",
                           "Rotation about a fixed axis.",
                           {of(Param::Kind::vec3, "axis", Unit::none, "[0, 0, 1]", "Direction of the axis."),
                            of(Param::Kind::vec3, "centre", Unit::length, "[0, 0, 0]", "A point on the axis, world coordinates at rest."),
                            of(Param::Kind::numbers, "angle", Unit::angle, std::nullopt, "Angle at each key.")}};

const ParamTable kOrientation{
    "pin orientation",
    "Turns from rest as unit quaternions, one per key; in between about one axis, the shorter way.",
    {of(Param::Kind::vec3, "centre", Unit::length, "[0, 0, 0]", "The point that the body turns about, world coordinates at rest."),
     of(Param::Kind::numbers, "w", Unit::none, std::nullopt, "Cosine of half the angle, at each key."),
     of(Param::Kind::numbers, "x", Unit::none, std::nullopt, "Sine of half the angle times the axis."),
     of(Param::Kind::numbers, "y", Unit::none, std::nullopt, "The same, y."),
     of(Param::Kind::numbers, "z", Unit::none, std::nullopt, "The same, z.")}};

const ParamTable kTrack{
    "pin motion file",
    "Keys from a track of poses; the body stands in the scene as the first says.",
    {param::required(of(Param::Kind::path, "path", Unit::none, std::nullopt, "Table of comma-separated numbers, or HDF5 (.h5, .hdf5).")),
     optional(of(Param::Kind::names, "position", Unit::none, std::nullopt, "Columns of x, y and z of the tracked point.")),
     optional(of(Param::Kind::names, "quaternion", Unit::none, std::nullopt, "Columns of w, x, y and z of its turn, a unit quaternion.")),
     optional(of(Param::Kind::vec3, "centre", Unit::length, std::nullopt,
                 "Where the tracked point stands in the scene; without it at the first position of the track.")),
     of(Param::Kind::text, "time_column", Unit::none, "time", "Name of the column of times, which increase from row to row."),
     param::positive(optional(of(Param::Kind::number, "rate", Unit::none, std::nullopt,
                                 "Rows per second, in the place of a column of times [Hz]; the first is at t = 0."))),
     optional(param::choice("unit", {"m", "cm", "mm"}, "", "Unit of the positions, where their columns have none.")),
     optional(param::choice("time_unit", {"s", "ms"}, "", "Unit of the times, where their column has none."))}};

Param rotations() {
  Param p = param::table("rotation", &kRotation, "Rotation of the rest positions, before the translation; a list: one after the other.");
  p.kind = Param::Kind::tables;
  return p;
}

const ParamTable kMotion{
    "pin motion",
    "Keys that the motion passes.",
    {optional(of(Param::Kind::numbers, "time", Unit::time, std::nullopt, "Times of the keys, ascending (pseudo-time 0 to 1 in static scenes).")),
     optional(of(Param::Kind::vec3s, "translation", Unit::length, std::nullopt, "Translation at each key.")),
     param::choice("interpolation", {"linear", "smooth"}, "linear",
                   "Between keys: at constant speed, or by a cubic that starts and ends at rest and never overshoots a key."),
     rotations(), param::table("orientation", &kOrientation, "The same by quaternions."),
     param::table("file", &kTrack, "Times, translations and orientations from a file, in their place.")}};

const ParamTable kPin = [] {
  ParamTable t{
      "effect pin",
      "Holds or moves points exactly.",
      {of(Param::Kind::text, "body", Unit::none, std::nullopt, "Name of the body."),
       param::required(param::table("where", &where_table, "Points of the body that are held; a stiff body is held as a whole (side: all).")),
       of(Param::Kind::text, "axes", Unit::none, "xyz", "Directions that are held: any of x, y, z."),
       param::table("motion", &kMotion, "Prescribed motion; without it the points stay where they are."),
       range(optional(of(Param::Kind::number, "release", Unit::time, std::nullopt, "Time from which the points are free.")), 0, INFINITY)}};
  t.is_list = true;
  return t;
}();

}  // namespace

const ParamTable& table() { return kPin; }

}  // namespace mortise::effects::pin
