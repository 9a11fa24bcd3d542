// What drives and loads ask for between the ends of steps.
#include "audit/schedule_missed.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tables.h"

using namespace mortise;
using mortise::testing::number;
using mortise::testing::table;

namespace {

Params text(const char* v) { return Params::make_text(v); }
Params numbers(const std::vector<double>& values) {
  Params out = Params::make_list();
  for (double v : values) out.push(number(v));
  return out;
}

// 20 steps of 5 ms of a drive.
double missed(const Params& drive) {
  const Params time = table({{"step", number(5e-3)}, {"steps", Params::make_integer(20)}, {"mode", text("dynamic")}});
  const Params joint = table({{"name", text("slide")}, {"type", text("prismatic")}, {"body", text("b")}});
  const Params effects = table(
      {{"inertia", table({{"integrator", text("backward_euler")}})}, {"joint", Params::make_list({joint})}, {"drive", Params::make_list({drive})}});
  return audit::schedule_missed({table({{"time", time}, {"effects", effects}}), {}});
}
double missed(const std::vector<double>& times, const std::vector<double>& forces) {
  return missed(table({{"joint", text("slide")},
                       {"mode", text("effort")},
                       {"interpolation", text("linear")},
                       {"force", table({{"time", numbers(times)}, {"value", numbers(forces)}})}}));
}
double missed(double frequency) {
  const Params sine = table({{"travel", number(1e-3)}, {"frequency", number(frequency)}, {"phase", number(0)}});
  return missed(table({{"joint", text("slide")}, {"mode", text("kinematic")}, {"interpolation", text("linear")}, {"sine", sine}}));
}

}  // namespace

TEST(ScheduleMissed, Pulses) {
  EXPECT_NEAR(missed({0, 0.021, 0.0225, 0.024}, {0, 0, 100, 0}), 1, 1e-9) << "within a step";
  EXPECT_NEAR(missed({0, 0.02, 0.0225, 0.025}, {0, 0, 100, 0}), 1, 1e-9);
  EXPECT_NEAR(missed({0, 0.02, 0.03, 0.04}, {0, 0, 100, 0}), 0, 1e-9) << "keys at the ends of steps";
  EXPECT_LT(missed({0, 0.021, 0.0211}, {0, 0, 100}), 0.04) << "a jump is half a step off";
  EXPECT_NEAR(missed({0, 0.1}, {0, 100}), 0, 1e-9);
  EXPECT_NEAR(missed({0, 0.1}, {3, 3}), 0, 1e-9) << "nothing changes";
  EXPECT_NEAR(missed({0, 0.0185, 0.01851}, {0.5, 0.5, 0}), 2 * 3.5 / 18.5, 2e-3) << "three steps of a push that goes on for 3.7";
  EXPECT_LT(missed({0, 0.02, 0.02001}, {0.5, 0.5, 0}), 0.04);
  EXPECT_NEAR(missed({0, 0.01999, 0.02}, {0.5, 0.5, 0}), 2 * 5 / 20., 2e-3) << "the last step goes by its end";
  EXPECT_NEAR(missed({0, 0.02499, 0.025}, {0, 0, 7}), 2 * 5 / 75., 2e-3) << "a step too early";
  EXPECT_LT(missed({0, 0.025, 0.02501}, {0, 0, 7}), 0.04);
}

// The chords of a sine with n steps in a period are (pi/n)^2/3 of its area off.
TEST(ScheduleMissed, Sines) {
  EXPECT_NEAR(missed(10.), std::pow(M_PI / 20, 2) / 3, 5e-4);
  EXPECT_NEAR(missed(20.), std::pow(M_PI / 10, 2) / 3, 2e-3);
  EXPECT_NEAR(missed(200.), 1, 1e-6) << "a period in every step";
}

// Load steps are judged by the way that they cut short, where there is friction.
TEST(ScheduleMissed, WaysWithinALoadStep) {
  const auto list = [](std::initializer_list<Params> items) { return Params::make_list(items); };
  const auto key = [&](double x, double z) { return list({number(x), number(0), number(z)}); };
  const auto missed = [&](long steps, bool friction, const Params& path) {
    const Params motion = table({{"time", numbers({0, 0.5, 1})}, {"interpolation", text("linear")}, {"translation", path}});
    Params effects = table({{"pin", list({table({{"body", text("b")}, {"motion", motion}})})}});
    if (friction) effects.set("friction", table({{"mu", number(0.5)}}));
    const Params time = table({{"mode", text("static")}, {"steps", Params::make_integer(steps)}});
    return audit::schedule_missed({table({{"time", time}, {"effects", effects}}), {}});
  };
  const Params there_and_back = list({key(0, 0), key(1, 0), key(0, 0)}), press_and_slide = list({key(0, 0), key(0, -1), key(2, -1)});
  EXPECT_NEAR(missed(1, true, there_and_back), 1, 1e-9);
  EXPECT_NEAR(missed(2, true, there_and_back), 0, 1e-9);
  EXPECT_NEAR(missed(1, true, press_and_slide), 1 - std::sqrt(0.5), 1e-9) << "each over what it goes through";
  EXPECT_NEAR(missed(10, true, press_and_slide), 0, 1e-9);
  EXPECT_TRUE(std::isnan(missed(1, false, there_and_back))) << "the end is the same, whatever the way";
}

// What numbers over the load steps are of that no step ends with.
TEST(ScheduleMissed, TurnsWithinALoadStep) {
  const auto list = [](std::initializer_list<Params> items) { return Params::make_list(items); };
  const auto key = [&](double z) { return list({number(0), number(0), number(z)}); };
  const auto missed = [&](long steps, const char* when) {
    const Params motion =
        table({{"time", numbers({0, 0.5, 1})}, {"interpolation", text("linear")}, {"translation", list({key(0), key(-1), key(0)})}});
    const Params time = table({{"mode", text("static")}, {"steps", Params::make_integer(steps)}});
    Params scene = table({{"time", time}, {"effects", table({{"pin", list({table({{"body", text("b")}, {"motion", motion}})})}})}});
    scene.set("quantities", list({table({{"value", text("supports/b_z")}, {"when", text(when)}})}));
    return audit::schedule_missed({scene, {}});
  };
  EXPECT_NEAR(missed(5, "smallest"), 0.2, 1e-9);
  EXPECT_NEAR(missed(3, "mean"), 1. / 3, 1e-9);
  EXPECT_NEAR(missed(4, "smallest"), 0, 1e-9);
  EXPECT_TRUE(std::isnan(missed(5, "end")));
}
