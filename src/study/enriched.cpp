#include "study/enriched.h"

#include <algorithm>

#include "effects/contact/layer.h"
#include "effects/roles.h"
#include "geometry/midsides.h"
#include "geometry/placement.h"
#include "geometry/refine.h"
#include "geometry/shapes.h"

namespace mortise::study {
namespace {

bool is_round(const std::string& shape) { return shape == "sphere" || shape == "cylinder" || shape == "capsule"; }

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

model::ModelInput richer(const model::ModelInput& input, std::string& why_not) {
  model::ModelInput out = with_layers(input, 1);
  const auto soft = [](const model::BodyInput& b) { return b.type == model::BodyType::soft; };
  const auto linear = [&](const model::BodyInput& b) { return soft(b) && b.midsides.empty(); };
  why_not = std::any_of(out.bodies.begin(), out.bodies.end(), soft) ? "" : "the scene has no soft bodies";
  const bool any_linear = std::any_of(out.bodies.begin(), out.bodies.end(), linear);
  for (model::BodyInput& body : out.bodies) {
    if (linear(body))
      model::set_mesh(body, geometry::with_midsides({body.nodes, body.tets}));
    else if (soft(body) && !any_linear)
      model::set_mesh(body, geometry::refined({body.nodes, body.tets, body.midsides}));
  }
  return out;
}

model::ModelInput thinner(const model::ModelInput& input, double share) { return with_layers(input, 1 - share); }

model::ModelInput rounder(const model::ModelInput& input, double share, std::string& why_not) {
  model::ModelInput out = input;
  why_not = "no soft body is a sphere, a cylinder or a capsule with straight edges";
  for (model::BodyInput& body : out.bodies) {
    if (body.type != model::BodyType::soft || body.midsides.empty() || body.params.flag("curved") || !is_round(body.params.at("shape").entries().front().first)) continue;
    std::vector<Vec3> curved = geometry::tet_shape(body.params.at("shape"), {2, true}).points;
    geometry::Placement(body.params).apply(curved);
    if (curved.size() != body.nodes.size()) continue;  // cut into eight
    for (std::size_t i = 0; i < curved.size(); ++i) body.nodes[i] += share * (curved[i] - body.nodes[i]);
    why_not.clear();
  }
  return out;
}

model::ModelInput finer_facets(const model::ModelInput& input, std::string& why_not) {
  model::ModelInput out = with_layers(input, 1);
  why_not = "no stiff body is a sphere, a cylinder or a capsule";
  for (model::BodyInput& body : out.bodies) {
    if (body.type != model::BodyType::stiff) continue;
    Params shape = body.params.at("shape");
    const auto& [kind, block] = shape.entries().front();
    if (!is_round(kind)) continue;
    Params finer = block;
    finer.set("edge_length", Params::make_number(0.5 * block.number("edge_length")));
    shape.set(kind, finer);
    geometry::TriMesh mesh = geometry::surface_shape(shape);
    geometry::Placement(body.params).apply(mesh.points);
    body.nodes = std::move(mesh.points), body.triangles = std::move(mesh.triangles);
    why_not.clear();
  }
  return out;
}

model::ModelInput better_integrated(const model::ModelInput& input, std::string& why_not) {
  model::ModelInput out = with_layers(input, 1);
  Params effects = out.scene.at("effects");
  const bool quadratic = std::any_of(out.bodies.begin(), out.bodies.end(), [](const model::BodyInput& b) { return !b.midsides.empty(); });
  why_not = "contact is integrated as exactly as it can be";
  for (const std::string& name : effects::of_role(effects, effects::Role::contact)) {
    Params contact = effects.at(name);
    const Params* points = contact.find("quadrature");
    if (!points) {
      why_not = "no estimate of '" + name + "'";
      return out;
    }
    const std::string best = quadratic ? "7" : "exact";
    if (points->as_text() == best || points->as_text() == "exact") continue;
    contact.set("quadrature", Params::make_text(best));
    effects.set(name, contact);
    why_not.clear();
  }
  out.scene.set("effects", effects);
  return out;
}

}  // namespace mortise::study
