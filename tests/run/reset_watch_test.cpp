// Conditions that end an episode, one by one.
#include "run/reset_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/memory_archive.h"

namespace mortise::run {
namespace {

using testing::HasSubstr;

model::ModelInput two_boxes() {
  model::ModelInput input;
  for (const double z : {0.0, 5.0}) {
    model::BodyInput b;
    b.name = z == 0 ? "low" : "high", b.type = model::BodyType::stiff;
    b.material = Params::make_table();
    b.material.set("density", Params::make_number(1));
    b.nodes = {{0, 0, z}, {1, 0, z}, {0, 1, z}, {0, 0, z + 1}};
    b.triangles = {{{0, 2, 1}}, {{0, 1, 3}}, {{1, 2, 3}}, {{0, 3, 2}}};  // centre of mass at a quarter
    input.bodies.push_back(b);
  }
  return input;
}
std::vector<double> points(const model::ModelInput& input, double up) {
  std::vector<double> out;
  for (const model::BodyInput& b : input.bodies)
    for (const Vec3& x : b.nodes) out.insert(out.end(), {x[0], x[1], x[2] + (b.name == "high" ? up : 0)});
  return out;
}
Params condition(const std::vector<std::pair<std::string, Params>>& entries) {
  Params p = Params::make_table();
  for (const auto& [key, value] : entries) p.set(key, value);
  return p;
}
const auto text = [](const char* t) { return Params::make_text(t); };
const auto number = [](double v) { return Params::make_number(v); };

struct State {
  long step = 1;
  double time = 0.1, up = 0, force = 0;
};
std::string ended(const std::vector<Params>& conditions, const State& s) {
  const model::ModelInput input = two_boxes();
  ResetWatch watch(conditions, input);
  Snapshot said;
  said.number["contact/force_z"] = s.force;
  watch.see(s.step, s.time, said, points(input, s.up));
  return watch.due() ? watch.reason() : "";
}

TEST(ResetWatch, EndsByTime) {
  const std::vector<Params> c{condition({{"after", number(0.3)}})};
  EXPECT_EQ(ended(c, {.time = 0.29}), "");
  EXPECT_EQ(ended(c, {.time = 3 * 0.1}), "after 0.3 s");
  EXPECT_EQ(ended(c, {.time = 0.1 + 0.1 + 0.1 - 1e-16}), "after 0.3 s") << "rounding of a sum of steps";
}

TEST(ResetWatch, EndsByTheCentreOfTheBodyThatIsNamed) {
  const auto bounds = [](const char* body, const char* axis, const char* which, double v) {
    return std::vector<Params>{condition({{"body", text(body)}, {"axis", text(axis)}, {which, number(v)}})};
  };
  EXPECT_EQ(ended(bounds("high", "z", "above", 5.5), {.up = 0.24}), "");
  EXPECT_EQ(ended(bounds("high", "z", "above", 5.5), {.up = 0.26}), "high z = 5.51 above 5.5");
  EXPECT_EQ(ended(bounds("low", "z", "above", 0.5), {.up = 9}), "");
  EXPECT_EQ(ended(bounds("high", "x", "below", 0.26), {}), "high x = 0.25 below 0.26");
  EXPECT_EQ(ended(bounds("high", "y", "below", 0.24), {}), "");
  // Several conditions of bodies: each watches its own.
  std::vector<Params> both = bounds("low", "z", "above", 1);
  both.push_back(bounds("high", "z", "below", 5)[0]);
  EXPECT_EQ(ended(both, {.up = 0}), "");
  EXPECT_THAT(ended(both, {.up = -1}), HasSubstr("high z"));
}

TEST(ResetWatch, EndsByAQuantityOutsideOfItsBounds) {
  const std::vector<Params> c{condition({{"quantity", text("contact/force_z")}, {"above", number(2)}, {"below", number(-1)}})};
  EXPECT_EQ(ended(c, {.force = 2}), "");
  EXPECT_EQ(ended(c, {.force = 2.5}), "contact/force_z = 2.5 above 2");
  EXPECT_EQ(ended(c, {.force = -1.5}), "contact/force_z = -1.5 below -1");
  EXPECT_EQ(ended(c, {.step = 0, .force = 9}), "") << "the start ends nothing";
  EXPECT_THROW(ended({condition({{"quantity", text("contact/force_x")}, {"above", number(2)}})}, {}), Error);
}

TEST(ResetWatch, TheFirstConditionStaysAndSurvivesARestart) {
  const model::ModelInput input = two_boxes();
  const std::vector<Params> c{condition({{"failure", Params::make_flag(true)}}), condition({{"after", number(1)}}),
                              condition({{"body", text("high")}, {"axis", text("z")}, {"above", number(5)}})};
  ResetWatch watch(c, input), again(c, input);
  watch.see(1, 0.5, {}, points(input, 0));
  ASSERT_TRUE(watch.due());
  watch.see(2, 1.5, {}, points(input, 0));
  EXPECT_EQ(watch.reason(), "high z = 5.25 above 5");
  MemoryArchive archive;
  watch.checkpoint(archive);
  archive.rewind();
  again.checkpoint(archive);
  ASSERT_TRUE(again.due());
  EXPECT_EQ(again.reason(), watch.reason());
}

}  // namespace
}  // namespace mortise::run
