// The keys of `environments`.
#include "scene/environments.h"

namespace mortise::scene {
namespace {

using Kind = Param::Kind;
using namespace param;

const ParamTable& distribution_table() {
  static const ParamTable t = [] {
    const auto numbers = [](const char* key, const char* help) { return optional(of(Kind::numbers, key, Unit::any, {}, help)); };
    ParamTable d{"distribution",
                 "What a number is drawn from: exactly one of these.",
                 {numbers("uniform", "Lower and upper end, all in between equally probable."),
                  numbers("log_uniform", "Lower and upper end, both positive; its logarithm is equally probable everywhere in between."),
                  numbers("normal", "Mean and standard deviation."), numbers("choice", "Values, all equally probable.")}};
    d.one_of = true;
    return d;
  }();
  return t;
}

const ParamTable& vary_table() {
  static const ParamTable t{
      "vary",
      "One number of the scene that differs between environments: its path, and exactly one of scale, add and abs.",
      {required(of(Kind::text, "path", Unit::none, {}, "The number, as --set names it: materials.gel.youngs_modulus, bodies.ball.position.0.")),
       table("scale", &distribution_table(), "The scene's number times what is drawn."),
       table("add", &distribution_table(), "The scene's number plus what is drawn."),
       table("abs", &distribution_table(), "What is drawn, in the place of the scene's number.")}};
  return t;
}

const ParamTable& reset_table() {
  static const ParamTable t{
      "reset",
      "When an environment begins its next episode: exactly one of after, body, quantity and failure.",
      {positive(optional(of(Kind::number, "after", Unit::time, {}, "Time in the episode."))),
       optional(of(Kind::text, "body", Unit::none, {}, "Body whose centre of mass leaves what `above` and `below` leave it.")),
       optional(choice("axis", {"x", "y", "z"}, "", "Of the body's centre: which coordinate.")),
       optional(of(Kind::text, "quantity", Unit::none, {}, "Scalar that an effect reports, as group/name: mortar_contact/force_pad_z.")),
       optional(of(Kind::number, "above", Unit::any, {}, "The episode ends where the number is larger than this.")),
       optional(of(Kind::number, "below", Unit::any, {}, "The episode ends where the number is smaller than this.")),
       optional(of(Kind::flag, "failure", Unit::none, {},
                   "true: a step that fails, or bodies that touch at the start, end the episode and not the environment."))}};
  return t;
}

}  // namespace

const ParamTable& environments_table() {
  static const ParamTable t = [] {
    Param vary = table("vary", &vary_table(), "Numbers that differ between environments; without any all are equal.");
    vary.kind = Kind::tables;
    Param reset = table("reset", &reset_table(),
                        "Conditions that end an episode. The next begins at the start, with new numbers; time.steps are the steps of all episodes of "
                        "an environment.");
    reset.kind = Kind::tables;
    return ParamTable{
        "environments",
        "Copies of the scene that are run side by side and know nothing of each other, each with numbers of its own.",
        {range(of(Kind::integer, "count", Unit::none, {}, "How many there are."), 1, 1e6),
         range(of(Kind::integer, "seed", Unit::none, "0", "What is drawn hangs on this number, the environment and the path, and on nothing else."),
               0, 9007199254740992.0),
         vary,
         choice("pictures", {"none", "first", "all", "grid"}, "first",
                "Which environments draw pictures; grid: all, and side by side in one picture each."),
         reset}};
  }();
  return t;
}

}  // namespace mortise::scene
