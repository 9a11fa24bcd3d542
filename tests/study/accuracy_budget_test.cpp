// What error budgets say of knobs.
#include "study/accuracy_budget.h"

#include <gtest/gtest.h>

#include <cmath>

#include "study/error_budget.h"

namespace mortise::study {
namespace {

AutoKnob knob(const char* name, std::vector<std::string> sources) {
  AutoKnob out;
  out.name = name, out.sources = std::move(sources);
  return out;
}

const std::vector<AutoKnob> kKnobs{knob("mesh", {kOfMesh}), knob("contact layer", {kOfGap})};
std::vector<Quantity> named(const char* name) {
  std::vector<Quantity> out(1);
  out[0].name = name;
  return out;
}
const std::vector<Quantity> kForce = named("force");

std::string certificate(const std::string& parts, const std::string& why_not = "") {
  return R"({"error_budget": [{"quantity": "other"}, {"quantity": "force", "why_not": ")" + why_not + R"(", "parts": [)" + parts + "]}]}";
}

constexpr const char* kGap = R"({"source": "gap that contact leaves", "error": 0.5, "why_not": ""})";
constexpr const char* kMesh = R"({"source": "mesh of soft bodies", "error": -2.0, "why_not": ""})";
constexpr const char* kRest = R"({"source": "Newton's method", "error": 0.01}, {"source": "facets", "error": null, "why_not": "no estimate"})";

TEST(AccuracyBudget, PartsBelongToKnobs) {
  const KnobErrors e = knob_errors(certificate(std::string(kGap) + "," + kMesh + "," + kRest), kForce, kKnobs);
  EXPECT_EQ(e.why_not, "");
  EXPECT_EQ(e.left, (std::vector<std::vector<double>>{{-2.0}, {0.5}}));
  EXPECT_EQ(e.rest, std::vector<double>{0.01});
  // A layer that follows the mesh is refined with it.
  const KnobErrors both = knob_errors(certificate(std::string(kGap) + "," + kMesh), kForce, {knob("mesh", {kOfMesh, kOfGap})});
  EXPECT_EQ(both.left, (std::vector<std::vector<double>>{{-1.5}}));
}

TEST(AccuracyBudget, WithoutAllKnobsItIsOfNoUse) {
  const auto why = [](const std::string& text) { return knob_errors(text, kForce, kKnobs).why_not; };
  EXPECT_NE(why(""), "");
  EXPECT_NE(why("{}"), "");
  EXPECT_NE(why(certificate(kGap)).find("mesh"), std::string::npos);
  EXPECT_NE(why(certificate(std::string(kGap) + R"(,{"source": "mesh of soft bodies", "error": null, "why_not": "averaged"})")).find("averaged"),
            std::string::npos);
  EXPECT_NE(why(certificate(std::string(kGap) + "," + kMesh, "in motion")).find("in motion"), std::string::npos);
  EXPECT_NE(why(R"({"error_budget": []})"), "");
}

TEST(AccuracyBudget, TwoRunsTellOrdersAndWhetherItCame) {
  const Known coarse{{10}, {2, 1}, {{{4.0}, {0.5}}, {0.0}, ""}}, fine{{13.3}, {1, 1}, {{{1.0}, {0.5}}, {0.0}, ""}};
  EXPECT_NEAR(order_between(coarse, fine, 0, 0), 2, 1e-12);
  EXPECT_EQ(order_between(coarse, fine, 1, 0), 1) << "the layer was the same";
  EXPECT_NEAR(come_over_foretold(coarse, fine, 0), 1.1, 1e-12);
  const Known turned{{13}, {1, 1}, {{{-1.0}, {0.5}}, {0.0}, ""}};
  EXPECT_EQ(order_between(coarse, turned, 0, 0), 1) << "errors that change sign have no order";
}

TEST(AccuracyBudget, LimitsOfClimbsAreThoseOfBudgets) {
  Climb c;
  c.ratio = 0.5, c.finest = 9;
  c.rungs = {{-2, 4, {9.0}, 0.1}, {0, 1, {10.0}, 1}};
  c.known = {{-0.4, 2, 1.5}};
  EXPECT_NEAR(c.limit(0).value, 9.6, 1e-12);
  EXPECT_NEAR(c.left(0, 0), -0.4, 1e-12);
  EXPECT_NEAR(c.left(0, 1), -0.1, 1e-12) << "of second order";
  EXPECT_NEAR(c.error(0, 0), 0.6, 1e-12) << "errors come out larger than estimates";
  EXPECT_NEAR(c.error(0, 1), 0.15, 1e-12);
  const Chosen far = choose_levels({c}, {0.6 / 256}, 1.01, {0});
  EXPECT_TRUE(far.reached) << "orders are known: four levels are not too far";
  EXPECT_EQ(far.levels, Levels{4});
}

}  // namespace
}  // namespace mortise::study
