#pragma once
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace mortise {

// What a number measures. The scene reader turns "0.5 mm" into 5e-4 by it and refuses "0.5 MPa" where a length is wanted.
enum class Unit {
  none,  // a pure number
  length,
  time,
  mass,
  angle,  // radian inside, deg allowed in scenes
  velocity,
  angular_velocity,
  acceleration,
  force,
  pressure,
  density,
  energy,
  torque,
  stiffness,  // of a slide, of a hinge; so the next two
  angular_stiffness,
  damping,
  angular_damping,
  rotary_inertia,
  frequency,
  any  // a number with any known unit: what it measures depends on another key
};

struct ParamTable;

// One parameter of one block. The table of a block drives parsing, defaults, ranges, `mortise schema`, `mortise effects`.
struct Param {
  enum class Kind {
    number,
    integer,
    flag,
    text,      // free text or the name of another block
    path,      // file, relative to the scene file
    choice,    // one of `choices`
    vec3,      // three numbers
    numbers,   // list of numbers
    vec3s,     // list of three-number lists
    schedule,  // a number, or {time: [...], value: [...]}
    table,     // a nested block described by `sub`
    names,     // list of names
    pairs,     // list of [name, name]
    tables,    // a list of such blocks (a single block is accepted as a list of one)
    map        // free names, each with a block described by `sub`
  };
  std::string key;
  Kind kind = Kind::number;
  Unit unit = Unit::none;
  std::string help;                     // one sentence, without the unit
  std::optional<std::string> fallback;  // default in scene syntax, e.g. "0.1 mm"; absent and !optional = required
  bool optional = false;                // may be absent, and then the resolved table has no such key
  bool automatic = false;               // absent means that a value is chosen; `auto` says so aloud
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_open = false;  // true: value must be > min
  bool max_open = false;
  std::vector<std::string> choices;
  const ParamTable* sub = nullptr;
};

struct ParamTable {
  std::string name;  // "effect friction", "body", ...
  std::string help;
  std::vector<Param> params;
  bool is_list = false;  // the block itself is a list of such tables (effects `pin`, `pressure_load`)
  bool one_of = false;   // exactly one of the params is written (shapes, `where`); all of them are optional
};

// Short builders, so a table reads like a table.
namespace param {
inline Param number(std::string key, Unit unit, std::string fallback, double min, std::string help) {
  Param p;
  p.key = std::move(key), p.kind = Param::Kind::number, p.unit = unit, p.fallback = std::move(fallback), p.min = min, p.help = std::move(help);
  return p;
}
inline Param of(Param::Kind kind, std::string key, Unit unit, std::optional<std::string> fallback, std::string help) {
  Param p;
  p.key = std::move(key), p.kind = kind, p.unit = unit, p.fallback = std::move(fallback), p.help = std::move(help);
  return p;
}
inline Param choice(std::string key, std::vector<std::string> choices, std::string fallback, std::string help) {
  Param p;
  p.key = std::move(key), p.kind = Param::Kind::choice, p.choices = std::move(choices), p.fallback = std::move(fallback), p.help = std::move(help);
  return p;
}
inline Param table(std::string key, const ParamTable* sub, std::string help) {  // absent unless written
  Param p;
  p.key = std::move(key), p.kind = Param::Kind::table, p.sub = sub, p.optional = true, p.help = std::move(help);
  return p;
}
inline Param required(Param p) {
  p.fallback.reset();
  p.optional = false;
  return p;
}
inline Param optional(Param p) {
  p.fallback.reset();
  p.optional = true;
  return p;
}
inline Param automatic(Param p) {  // optional; `auto` is as good as absent
  p = optional(std::move(p));
  p.automatic = true;
  return p;
}
inline Param range(Param p, double min, double max) {
  p.min = min, p.max = max;
  return p;
}
inline Param positive(Param p) {
  p.min = 0, p.min_open = true;
  return p;
}
}  // namespace param

}  // namespace mortise
