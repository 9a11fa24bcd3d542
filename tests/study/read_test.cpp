// Studies as they are written, and the scenes that they make.
#include "study/read.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "place.h"
#include "study/orders.h"
#include "study/plan.h"

using namespace mortise;
using namespace mortise::study;
using testing::HasSubstr;
namespace fs = std::filesystem;

namespace {

const std::string kFall = test_place::kSourceFolder + "/scenes/first/01_free_fall.yaml",
                  kIncline = test_place::kSourceFolder + "/scenes/first/03_incline_friction.yaml";

class StudyFile : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  Study read(const std::string& text) const {
    std::ofstream(folder_ + "/s.yaml") << "mortise_study: 1\nscene: " << kIncline << "\n" << text;
    Study s = read_study(folder_ + "/s.yaml");
    if (s.methods.empty()) s.methods.emplace_back();
    return s;
  }
  template <class F>
  static std::string error(const F& f) {
    try {
      f();
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  }
  std::string wrong(const std::string& text) const {
    return error([&] { plan_of(read(text)); });
  }
  const std::string folder_ = (fs::temp_directory_path() / ("mortise_study_" + std::to_string(getpid()))).string();
};

const std::string kQuantity = "quantities: [inertia/kinetic_energy]\n";

}  // namespace

TEST_F(StudyFile, SaysWhatIsRun) {
  const Study s = read(
      "set: [time.steps=50]\nrepeat: 2\nlimit: 90 s\nladders:\n  - {knob: time.step, values: [4 ms, 2 ms]}\n"
      "  - {name: both, knobs: {effects.barrier_contact.d_hat: [0.4 mm, 0.2 mm], effects.barrier_contact.stiffness: [50 kPa, 100 kPa]}}\n"
      "  - {knob: solver.linear, values: [direct, cg]}\n"
      "quantities:\n  - {name: speed, value: inertia/momentum, axis: x, at: 30 ms, reference: 2 N, uncertainty: 1 mN}\n"
      "  - {value: displacement, body: block, over: percentile, percent: 90, axis: size, when: largest}\n");
  EXPECT_TRUE(s.one_at_a_time);
  EXPECT_EQ(s.repeats, 2);
  EXPECT_EQ(s.limit, 90);
  ASSERT_EQ(s.ladders.size(), 3u);
  EXPECT_EQ(s.ladders[1].name, "both");
  EXPECT_EQ(s.ladders[1].steps[1].settings,
            (Settings{{"effects.barrier_contact.d_hat", "0.2 mm"}, {"effects.barrier_contact.stiffness", "100 kPa"}}));
  EXPECT_THAT(s.ladders[1].sizes, testing::ElementsAre(4e-4, 2e-4));
  EXPECT_TRUE(s.ladders[2].sizes.empty());  // neither is finer
  EXPECT_EQ(*s.quantities[0].reference, 2);
  EXPECT_EQ(s.quantities[0].uncertainty, 1e-3);
  EXPECT_EQ(s.quantities[1].name, "largest of percentile of displacement of block (size)");
  const Plan plan = plan_of(s);
  EXPECT_EQ(plan.runs.size(), 7u);  // as it is, and two of each
  ASSERT_EQ(plan.curves.size(), 3u);
  EXPECT_EQ(plan.curves[1].name, "both");
  // The scene has a step of 2 ms: the same scene, so that it is run once.
  EXPECT_EQ(plan.runs[plan.curves[0].runs[1]].variant.id, plan.runs[plan.base[0]].variant.id);
  EXPECT_NE(plan.runs[plan.curves[0].runs[0]].variant.id, plan.runs[plan.base[0]].variant.id);
  EXPECT_THAT(plan.runs[0].variant.yaml, HasSubstr("frame_every: 1"));  // a quantity looks at every step
}

TEST_F(StudyFile, CombinationsMakeCurves) {
  const Plan plan = plan_of(read(kQuantity + "plan: combinations\nladders:\n  - {knob: time.step, values: [4 ms, 2 ms]}\n"
                                             "  - {knob: effects.friction.mu, values: [0.1, 0.2, 0.3]}\n"));
  ASSERT_EQ(plan.curves.size(), 3u);
  EXPECT_EQ(plan.curves[2].name, "effects.friction.mu=0.3");
  EXPECT_TRUE(plan.base.empty());
}

TEST_F(StudyFile, MethodsLeaveEffectsOut) {
  const Plan plan = plan_of(
      read(kQuantity + "ladders:\n  - {knob: time.step, values: [4 ms, 2 ms]}\nmethods:\n  - {name: with}\n  - {name: slides, without: friction}\n"));
  ASSERT_EQ(plan.curves.size(), 2u);
  EXPECT_EQ(plan.curves[1].name, "slides");
  EXPECT_THAT(plan.runs[plan.base[0]].variant.yaml, HasSubstr("friction:"));
  EXPECT_THAT(plan.runs[plan.base[1]].variant.yaml, testing::Not(HasSubstr("friction:")));
  EXPECT_THAT(wrong(kQuantity + "ladders:\n  - {knob: time.step, values: [4 ms, 2 ms]}\nmethods:\n  - {name: slides, without: frictoin}\n"),
              testing::AllOf(HasSubstr("s.yaml:7:5: error:"), HasSubstr("did you mean 'friction'")));
}

// Mesh and order leave the same error: the reference is that of the meshes of the highest order, and nothing is added to it for the order.
TEST_F(StudyFile, OrdersBesideMeshesAreMethods) {
  const std::string mesh = "  - {knob: bodies.block.shape.box.edge_length, values: [4 mm, 2 mm]}\n",
                    order = "  - {name: order, knob: bodies.block.order, values: [1, 2]}\n";
  const Study s = orders_apart(read(kQuantity + "ladders:\n" + mesh + order + "methods:\n  - {name: a}\n  - {name: b, set: time.steps=3}\n"));
  ASSERT_EQ(s.ladders.size(), 1u);
  ASSERT_EQ(s.methods.size(), 4u);
  EXPECT_EQ(s.methods[0].name, "a, order 2");
  EXPECT_EQ(s.methods[1].name, "a, order 1");
  EXPECT_THAT(s.methods[2].set, testing::ElementsAre("time.steps=3", "bodies.block.order=2"));
  EXPECT_EQ(orders_apart(read(kQuantity + "ladders:\n" + order)).ladders.size(), 1u) << "alone it is a knob like others";
  EXPECT_EQ(orders_apart(read(kQuantity + "ladders:\n  - {knob: bodies.other.shape.box.edge_length, values: [4 mm, 2 mm]}\n" + order)).ladders.size(),
            2u);
}

// Falling for 0.1 s whatever the step is, and never compared at different times.
TEST_F(StudyFile, VariedTimeStepsEndTogether) {
  Study s;
  s.scene = kFall, s.set = {"time.step=5 ms", "time.steps=20"};
  const auto yaml = [&](const char* key, const char* value) { return variant_of(s, {}, {{key, value}}).yaml; };
  EXPECT_THAT(yaml("time.step", "2.5 ms"), HasSubstr("steps: 40"));
  EXPECT_THAT(yaml("time.step", "5 ms"), HasSubstr("steps: 20"));
  EXPECT_THROW(yaml("time.step", "3 ms"), Error);
  EXPECT_THROW(yaml("time.steps", "10"), Error);
}

TEST_F(StudyFile, WrongLaddersAreToldWithTheirPlace) {
  const auto ladder = [&](const std::string& text) { return wrong(kQuantity + "ladders:\n  - " + text + "\n"); };
  EXPECT_THAT(ladder("{knob: effects.frictoin.mu, values: [0.1, 0.2]}"),
              testing::AllOf(HasSubstr("s.yaml:5:5: error: effects.frictoin.mu=0.1 makes no scene"), HasSubstr("did you mean")));
  EXPECT_THAT(ladder("{knob: time.step, values: [2 ms, 4 ms]}"), HasSubstr("s.yaml:5:5: error: ladder 'time.step': its values grow"));
  EXPECT_THAT(ladder("{knob: time.step, values: [4 ms, 1 ms, 2 ms]}"), HasSubstr("up and down"));
  EXPECT_THAT(ladder("{knobs: {a.b: [1, 2], c.d: [1]}}"), HasSubstr("c.d has 1 values, a.b has 2"));
  EXPECT_THAT(ladder("{knob: a.b, values: [x, y], sizes: [1, 2]}"), HasSubstr("sizes must be positive numbers that fall"));
  EXPECT_THAT(ladder("{knob: a.b}"), HasSubstr("varies nothing"));
}

TEST_F(StudyFile, WrongQuantitiesAreToldWithTheirPlace) {
  const auto quantity = [&](const std::string& text) {
    return wrong("ladders:\n  - {knob: time.step, values: [4 ms, 2 ms]}\nquantities:\n  - " + text + "\n");
  };
  EXPECT_THAT(quantity("{value: a/b, whne: end}"), HasSubstr("did you mean 'when'"));
  EXPECT_THAT(quantity("{value: a/b, when: last}"), HasSubstr("must be one of: end, start"));
  EXPECT_THAT(quantity("{value: contact_pressure}"), HasSubstr("needs a body"));
  EXPECT_THAT(quantity("{value: a/b, body: block}"), HasSubstr("is a scalar"));
  EXPECT_THAT(quantity("{value: velocity, body: block}"), HasSubstr("either over or point"));
  EXPECT_THAT(quantity("{value: velocity, body: block, over: percentile}"), HasSubstr("belong together"));
  EXPECT_THAT(quantity("{value: a/b, when: end, at: 1 s}"), HasSubstr("when and at"));
  EXPECT_THAT(quantity("{value: friction/dissipation, when: sum}"), HasSubstr("is the sum since the start already"));
}

TEST_F(StudyFile, AReferenceHasToBeFourTimesFiner) {
  const std::string ladders = kQuantity + "ladders:\n  - {knob: time.step, values: [4 ms, 2 ms]}\n";
  EXPECT_EQ(wrong(ladders + "over_resolved: {time.step: 0.5 ms}\n"), "");
  EXPECT_THAT(wrong(ladders + "over_resolved: {time.step: 1 ms}\n"), HasSubstr("is 2 times finer than the finest"));
  EXPECT_THAT(wrong(ladders + "over_resolved: {effects.friction.mu: 1}\n"), HasSubstr("says nothing of 'time.step'"));
}

TEST_F(StudyFile, FlagsSayTheSame) {
  const Ladder l = ladder_of_flag("a.b=[1, 2],3 mm,{x: [4,5]}");
  EXPECT_EQ(l.name, "a.b");
  ASSERT_EQ(l.steps.size(), 3u);
  EXPECT_EQ(l.steps[2].label, "{x: [4,5]}");
  for (const char* bad : {"a", "=1", "a=", "a=1,,2", "a=1 mm,2 mm"}) EXPECT_THROW(ladder_of_flag(bad), Error) << bad;
  EXPECT_EQ(quantity_of_flag("pressure L2, r <= a").value, "pressure L2, r <= a");
  EXPECT_EQ(quantity_of_flag("{value: contact_pressure, body: pad, over: max}").name, "max of contact_pressure of pad");
  EXPECT_THAT(error([] { quantity_of_flag("{value: x/y, bdoy: pad}"); }), testing::AllOf(HasSubstr("--qoi"), HasSubstr("did you mean 'body'")));
}
