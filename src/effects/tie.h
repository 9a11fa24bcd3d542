#pragma once
// What effects that tie bodies have in common (model/ties.h): they add ties to the model, and nothing else.
#include <utility>

#include "effects/effect.h"
#include "effects/list.h"
#include "model/model.h"

namespace mortise::effects {

// What `check --plan` says of the effect's ties.
std::vector<PlanItem> tie_plan(std::string_view effect, const model::Model& model);

class TieEffect final : public Effect {
 public:
  TieEffect(const char* name, model::Model& model, std::vector<model::Tie> ties) : name_(name), model_(model) {
    model.ties.add(model, std::move(ties));
  }
  const Kind& kind() const override { return *find_kind(name_); }
  std::vector<PlanItem> plan() const override { return tie_plan(name_, model_); }
  void energy(Positions, const Linearisation&, device::EnvValues) override {}
  void linearise(Positions, Want, Linearisation&) override {}

 private:
  const char* name_;
  model::Model& model_;
};

// The effect's table of parameters: `own` ones between the `name` and the `contact` that every tie has.
ParamTable tie_table(const char* effect, std::string help, std::vector<Param> own);

// The entry's tie between two bodies; it is called by its `name`, or those of the bodies.
model::Tie tie_of(const char* effect, const Params& entry, Index body, Index to);

// The bodies of every environment in which the entry's `body` and `to` are found; `to` is model::Tie::kWorld where the entry has none. Throws
// Error(Exit::scene) where one is a half-space, or `to` is not of the type.
std::vector<std::pair<Index, Index>> tied_bodies(const model::Model& model, const Params& entry, model::BodyType to = model::BodyType::stiff);

// The mesh of a body of the model.
const model::BodyInput& input_of(const model::Model& model, Index body);

// x = p + A X of the material point X of a stiff body that is at `place` at rest; of the world: `place` itself.
model::Follow material_point(const model::Model& model, Index body, const Vec3& place);

}  // namespace mortise::effects
