// The contact layer that a scene leaves open.
#include <gtest/gtest.h>

#include "contact_scene.h"
#include "effects/contact/layer.h"
#include "effects/friction/creep.h"

using namespace mortise;
using namespace mortise::testing;
using effects::contact::stiffness;
using effects::contact::support_radius;

namespace {

// A flat square plate of 10 x 10 cells, edges h, at height z.
model::BodyInput plate(const std::string& name, double h, model::BodyType type, double z = 0) {
  model::BodyInput out;
  out.name = name, out.type = type;
  for (int j = 0; j <= 10; ++j)
    for (int i = 0; i <= 10; ++i) out.nodes.emplace_back(i * h, j * h, z);
  for (int j = 0; j < 10; ++j)
    for (int i = 0; i < 10; ++i) {
      const Index a = 11 * j + i;
      out.triangles.push_back({{a, a + 1, a + 12}});
      out.triangles.push_back({{a, a + 12, a + 11}});
    }
  if (type == model::BodyType::soft) out.material = gel();
  return out;
}

Params bare_scene() {
  Params scene = Params::make_table();
  scene.set("effects", Params::make_table());
  return scene;
}

// A sphere of radius 1 of 12 x 24 fields, far above the plates.
model::BodyInput ball() {
  model::BodyInput out;
  out.name = "ball", out.type = model::BodyType::stiff;
  const int rows = 12, columns = 24;
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double theta = M_PI * i / rows, phi = 2 * M_PI * j / columns;
      out.nodes.emplace_back(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), 3 + std::cos(theta));
    }
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const Index a = i * columns + j, b = i * columns + (j + 1) % columns, c = a + columns, d = b + columns;
      if (i > 0) out.triangles.push_back({{a, c, b}});
      if (i < rows - 1) out.triangles.push_back({{b, c, d}});
    }
  return out;
}

Params naming(const std::string& a, const std::string& b) {
  Params p = Params::make_table(), pair = Params::make_table(), pairs = Params::make_list();
  pair.set("slave", Params::make_text(a));
  pair.set("master", Params::make_text(b));
  pairs.push(pair);
  p.set("pairs", pairs);
  return p;
}

}  // namespace

TEST(ContactLayer, IsAHundredthOfTheFinestSoftMeshNamed) {
  const model::ModelInput in{
      bare_scene(),
      {plate("coarse", 0.2, model::BodyType::soft), plate("fine", 0.1, model::BodyType::soft, 1), plate("tool", 0.01, model::BodyType::stiff, 2)}};
  EXPECT_NEAR(support_radius(Params::make_table(), in), 0.001, 1e-15);
  EXPECT_NEAR(support_radius(naming("coarse", "tool"), in), 0.002, 1e-15);
  Params set = naming("coarse", "tool");
  set.set("d_hat", Params::make_number(0.5));
  EXPECT_EQ(support_radius(set, in), 0.5);
}

TEST(ContactLayer, CountsNoMoreThanATenthOfAStiffBodysExtent) {
  model::BodyInput box = plate("box", 1, model::BodyType::stiff);
  box.nodes.emplace_back(0, 0, 0.5);  // large triangles, and half a metre thick
  EXPECT_NEAR(support_radius(Params::make_table(), {bare_scene(), {box}}), 0.01 * 0.05, 1e-15);
}

TEST(ContactLayer, IsNoThinnerThanFacetsAreDeep) {
  // Radius 1, edges pi/12: on a sphere a facet is edge^2/6 deep.
  const double h = 0.5, depth = std::pow(M_PI / 12, 2) / 6;
  const double d_hat = support_radius(Params::make_table(), {bare_scene(), {plate("pad", h, model::BodyType::soft), ball()}});
  EXPECT_GT(d_hat, 0.01 * h);
  EXPECT_NEAR(d_hat, std::min(2 * depth, 0.03 * h), 0.5 * depth);
  const double coarse = support_radius(Params::make_table(), {bare_scene(), {plate("pad", 0.05, model::BodyType::soft), ball()}});
  EXPECT_NEAR(coarse, 0.03 * 0.05, 1e-15);
}

// A layer of 1 mm between plates 0.4 mm apart would push them apart; one of 0.4 mm does not. It is no thinner than a tenth of what it would be.
TEST(ContactLayer, IsNoThickerThanTheGapAtTheStart) {
  const auto apart = [](double gap, Params scene = bare_scene(), const Params& effect = Params::make_table()) {
    return support_radius(effect, {std::move(scene), {plate("pad", 0.1, model::BodyType::soft), plate("tool", 0.13, model::BodyType::stiff, gap)}});
  };
  EXPECT_NEAR(apart(4e-4), 4e-4, 1e-15);
  EXPECT_NEAR(apart(2e-3), 1e-3, 1e-15);
  EXPECT_NEAR(apart(1e-5), 1e-4, 1e-15);
  // Between what does not meet there is no gap: pairs that the contact effect does not list, that pass through each other, that are tied or held.
  EXPECT_NEAR(apart(4e-4, bare_scene(), naming("pad", "other")), 1e-3, 1e-15);
  EXPECT_NEAR(apart(4e-4, bare_scene(), naming("tool", "pad")), 4e-4, 1e-15);
  const auto named = [](std::initializer_list<std::pair<const char*, const char*>> entries) {
    Params p = Params::make_table();
    for (const auto& [key, value] : entries) p.set(key, Params::make_text(value));
    return p;
  };
  Params passing = bare_scene(), pair = Params::make_table(), pairs = Params::make_list(), both = Params::make_list();
  both.push(Params::make_text("pad")), both.push(Params::make_text("tool"));
  pair.set("bodies", both), pair.set("collide", Params::make_flag(false));
  pairs.push(pair), passing.set("pairs", pairs);
  EXPECT_NEAR(apart(4e-4, passing), 1e-3, 1e-15);
  Params tied = bare_scene(), bonds = Params::make_list(), effects = Params::make_table();
  bonds.push(named({{"body", "pad"}, {"to", "tool"}})), effects.set("bond", bonds), tied.set("effects", effects);
  EXPECT_NEAR(apart(4e-4, tied), 1e-3, 1e-15);
  Params still = bare_scene(), pins = Params::make_list(), all = Params::make_table();
  for (const char* body : {"pad", "tool"}) {
    Params pin = named({{"body", body}});
    pin.set("where", named({{"side", "all"}})), pins.push(pin);
  }
  all.set("pin", pins), still.set("effects", all);
  EXPECT_NEAR(apart(4e-4, still), 1e-3, 1e-15);
}

TEST(ContactLayer, LooksAtTheGapOverAHalfSpaceToo) {
  const auto vec3 = [](double x, double y, double z) {
    return Params::make_list({Params::make_number(x), Params::make_number(y), Params::make_number(z)});
  };
  model::BodyInput floor;
  floor.name = "floor", floor.type = model::BodyType::half_space;
  floor.params = Params::make_table();
  floor.params.set("normal", vec3(0, 0, 2)), floor.params.set("point", vec3(0, 0, -3e-4));
  EXPECT_NEAR(support_radius(Params::make_table(), {bare_scene(), {plate("pad", 0.1, model::BodyType::soft), floor}}), 3e-4, 1e-15);
}

TEST(ContactLayer, IsAsStiffAsTheBodies) {
  const model::ModelInput in{{}, {plate("pad", 0.1, model::BodyType::soft), plate("tool", 0.1, model::BodyType::stiff)}};
  EXPECT_NEAR(stiffness(Params::make_table(), in), 1e5 / (1 - 0.09), 1e-6);
  EXPECT_EQ(stiffness(Params::make_table(), {{}, {in.bodies[1]}}), effects::contact::tuning::kRigid);
}

// What sticks gives way by 0.5 um in a step of 5 ms, which would be all the way that surfaces go in a scene of micrometres.
TEST(ContactLayer, FrictionGivesWayByNoMoreThanASmallPartOfIt) {
  const auto creep = [](double dt, double h, double d_hat = 0, double given = 0) {
    Params friction = Params::make_table(), contact = Params::make_table(), effects = Params::make_table();
    friction.set("follows", Params::make_text("barrier_contact"));
    if (given > 0) friction.set("creep_speed", Params::make_number(given));
    if (d_hat > 0) contact.set("d_hat", Params::make_number(d_hat));
    effects.set("barrier_contact", contact), effects.set("friction", friction);
    model::ModelInput in{Params::make_table(), {plate("pad", h, model::BodyType::soft)}};
    in.scene.set("effects", effects);
    return effects::friction::creep(in.scene.at("effects").at("friction"), in).distance(dt);
  };
  EXPECT_NEAR(creep(5e-3, 0.1), 5e-7, 1e-18);
  EXPECT_NEAR(creep(5e-3, 1e-5), 0.05 * 1e-7, 1e-15) << "of d_hat, a hundredth of the mesh";
  EXPECT_NEAR(creep(5e-3, 0.1, 2e-6), 0.05 * 2e-6, 1e-18);
  EXPECT_NEAR(creep(0.01, 0.1), 1e-6, 1e-18);
  EXPECT_NEAR(creep(1, 0.1), 0.05 * 1e-3, 1e-15) << "in large steps too";
  EXPECT_NEAR(creep(5e-3, 1e-5, 0, 3e-4), 1.5e-6, 1e-18);
}
