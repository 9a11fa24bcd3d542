// What a mesh that is too stiff makes of forces and motions.
#include "audit/stiffness_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "audit/grade.h"

namespace mortise::audit {
namespace {

// A soft cube of unit edges with `pins`, and a stiff one beside it.
struct Case {
  explicit Case(int pins) {
    Params list = Params::make_list(), pin = Params::make_table(), effects = Params::make_table();
    pin.set("body", Params::make_text("pad"));
    for (int i = 0; i < pins; ++i) list.push(pin);
    effects.set("pin", list);
    input.scene = Params::make_table();
    input.scene.set("effects", effects);
    model::BodyInput pad, punch;
    pad.name = "pad", punch.name = "punch", punch.type = model::BodyType::stiff;
    for (double x : {0., 1.})
      for (double y : {0., 1.})
        for (double z : {0., 1.}) pad.nodes.push_back({x, y, z}), punch.nodes.push_back({x + 2, y, z});
    input.bodies = {pad, punch};
  }
  // All of both goes `way` along x; the pad's upper edge at x = 1 goes `sheared` further.
  double error(double way, double sheared, const std::vector<LayerError::Travel>& travels = {}) const {
    std::vector<double> moved;
    for (const model::BodyInput& body : input.bodies)
      for (const Vec3& x : body.nodes) moved.insert(moved.end(), {way + (body.name == "pad" ? sheared * x[2] * x[0] : 0), 0, 0});
    return StiffnessError(input).of({{0, 0.4}}, {0, 0}, travels, {base, {}}, moved);
  }
  model::ModelInput input;
  std::optional<geometry::Motion> base;  // how the pad's supports move
};

}  // namespace

TEST(StiffnessError, IsThatOfStressesWhereDeformationIsAllThatMoves) {
  const double alone = Case(1).error(0, 1e-3);
  EXPECT_GT(alone, 0.1);
  EXPECT_LE(alone, 0.4);
  EXPECT_NEAR(Case(1).error(0, 1e-6), alone, 1e-3) << "however small it is";
}

TEST(StiffnessError, CountsAsDeformationDoesInTheWay) {
  EXPECT_NEAR(Case(1).error(1, 1e-3) / Case(1).error(10, 1e-3), 10, 0.02);
  EXPECT_LT(Case(1).error(1, 1e-3), 1e-3);
}

TEST(StiffnessError, MeasuresDeformationFromWhereSupportsAre) {
  Case held(1);
  held.base = geometry::Motion{};
  EXPECT_NEAR(held.error(0, 1e-3), 0.4, 1e-9) << "all that moves is deformation";
  held.base->t = {1, 0, 0};
  EXPECT_NEAR(held.error(1, 1e-3), 4e-4, 1e-6);
}

TEST(StiffnessError, CountsFullyBetweenTwoSupports) { EXPECT_DOUBLE_EQ(Case(2).error(1, 1e-3), 0.4); }

TEST(StiffnessError, CountsInForcesAsFarAsATravelIsImposed) {
  EXPECT_DOUBLE_EQ(Case(1).error(1, 1e-3, {{{0, 7}, 1, 0.01, 0.1, 0.1}}), 0.4) << "against a half-space, which has no number here";
  EXPECT_DOUBLE_EQ(Case(1).error(1, 1e-3, {{{0, 1}, 0.5, 0.01, 0.1, 0.4}}), 0.05)
      << "half of the force is a load's, and three quarters of the way a motor's";
}

// A stiff body that two pads hold tilts as far as those give.
TEST(StiffnessError, CountsInWaysOfWhatIsHeldBetweenPads) {
  Case held(1);
  held.input.bodies[0].type = held.input.bodies[1].type = model::BodyType::soft;  // two pads, and a bar between them
  model::BodyInput bar = held.input.bodies[1];
  bar.name = "bar", bar.type = model::BodyType::stiff;
  held.input.bodies.push_back(bar);
  const auto error = [&](const Vec3& one, const Vec3& other) {
    std::vector<double> moved;
    for (const model::BodyInput& body : held.input.bodies)
      for (const Vec3& x : body.nodes)
        moved.insert(moved.end(), {body.name == "punch" ? other[0] : one[0], 0, body.name == "bar" ? -0.1 * x[0] : -1e-3 * x[2]});
    const auto along = [](const Vec3& t) { return geometry::Motion{Mat3::Identity(), t}; };
    return StiffnessError(held.input).of({{0, 0.4}}, {0, 0, 0}, {}, {along(one), along(other), {}}, moved);
  };
  EXPECT_GT(error({1, 0, 0}, {1, 0, 0}), 0.1);
  EXPECT_LT(error({1, 0, 0}, {0, 0, 0}), 0.001) << "it rolls between them";
}

TEST(StiffnessError, TheLayerIsMissingInWaysOfWhatIsPressed) {
  const auto over_way = [](double way, double sheared) {
    const Case c(1);
    std::vector<double> moved;
    for (const model::BodyInput& body : c.input.bodies)
      for (const Vec3& x : body.nodes) moved.insert(moved.end(), {0, 0, body.name == "pad" ? -sheared * x[2] * x[0] : -way});
    return StiffnessError(c.input).layer_over_way({{0, 1}, {0.01}, {5}}, {geometry::Motion{}, {}}, moved);
  };
  EXPECT_NEAR(over_way(0.09, 0.05), 0.1, 1e-12);
  EXPECT_TRUE(std::isnan(over_way(0.09, 1e-3))) << "hardly pressed";
}

TEST(StiffnessError, IsNoneWhereNothingIsKnown) {
  EXPECT_TRUE(std::isnan(StiffnessError(Case(1).input).of({}, {0, 0}, {}, {{}, {}}, {})));
  EXPECT_DOUBLE_EQ(StiffnessError(Case(1).input).of({{0, 0.4}}, {0, 0}, {}, {{}, {}}, {}), 0.4) << "without displacements it counts";
}

TEST(Grade, TellsForcesApartWhereTheyAreBetter) {
  const Grade::Verdict a{"A", "every bound is met"}, c{"C", "stress_error is 0.2, more than 0.1"};
  EXPECT_EQ(text_of({a, a, {}}), "grade A");
  EXPECT_EQ(text_of({c, c, {}}), "grade C: stress_error is 0.2, more than 0.1");
  EXPECT_EQ(text_of({c, a, {}}), "grade C: stress_error is 0.2, more than 0.1; of forces and motions A");
}

TEST(Grade, SaysWhatMakesItBetter) {
  const Grade::Verdict a{"A", ""}, b{"B", ""}, c{"C", ""};
  const Check mesh{"stress_error", 0.2, 0.05, 0.1, Of::fields}, stiff{"stiffness_error", 0.2, 0.05, 0.1, Of::forces},
      step{"motion_lag", 0.06, 0.05, 0.1, Of::all};
  EXPECT_TRUE(hints({a, a, {}, {}}).empty());
  EXPECT_TRUE(hints({c, c, {}, {}}).empty()) << "the run was stopped";
  const auto begins = [](const std::vector<std::string>& all, std::size_t i, const std::string& with) {
    return i < all.size() && all[i].rfind(with, 0) == 0;
  };
  const std::vector<std::string> one = hints({c, c, {}, {mesh, step, stiff}});
  EXPECT_TRUE(begins(one, 0, "stress_error, stiffness_error: a finer mesh")) << "what keeps it from B";
  EXPECT_EQ(one.size(), 1u);
  const std::vector<std::string> both = hints({c, b, {}, {step, mesh}});
  EXPECT_TRUE(begins(both, 0, "motion_lag: shorter steps"));
  EXPECT_TRUE(begins(both, 1, "stress_error: a finer mesh"));
  for (const std::string& hint : hints({c, b, {}, {step, mesh}, {.bdf2 = true, .quadratic = true}}))
    for (const char* had : {"bdf2", "order: 2"}) EXPECT_EQ(hint.find(had), std::string::npos) << hint << ", which the scene has";
}

}  // namespace mortise::audit
