#include "study/enriched.h"

#include <algorithm>

#include "effects/contact/layer.h"
#include "effects/roles.h"
#include "geometry/midsides.h"

namespace mortise::study {
namespace {

// The input with the support radii of its contact effects as numbers, times a factor.
model::ModelInput with_layers(const model::ModelInput& input, double factor) {
  model::ModelInput out = input;
  Params effects = input.scene.at("effects");
  for (const std::string& name : effects::of_role(effects, effects::Role::contact)) {
    Params contact = effects.at(name);
    contact.set("d_hat", Params::make_number(factor * effects::contact::support_radius(contact, input)));
    // Pairs of primitives with the weight d_hat^2: the weight stays.
    if (const Params* form = contact.find("form"); form && form->as_text() == "classic")
      contact.set("stiffness", Params::make_number(effects::contact::stiffness(contact, input) / (factor * factor)));
    effects.set(name, contact);
  }
  out.scene.set("effects", effects);
  return out;
}

}  // namespace

model::ModelInput enriched(const model::ModelInput& input, std::string& why_not) {
  model::ModelInput out = with_layers(input, 1);
  why_not = "the scene has no soft bodies";
  for (model::BodyInput& body : out.bodies) {
    if (body.type != model::BodyType::soft) continue;
    if (!body.midsides.empty()) {
      why_not = "'" + body.name + "' has quadratic elements";
      return out;
    }
    why_not.clear();
    model::set_mesh(body, geometry::with_midsides({body.nodes, body.tets}));
  }
  return out;
}

model::ModelInput thinner(const model::ModelInput& input, double share) { return with_layers(input, 1 - share); }

}  // namespace mortise::study
