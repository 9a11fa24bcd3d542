// When a run leaves checkpoints beside its end.
#include "run/checkpoint_times.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <utility>

#include "tables.h"

using namespace mortise;
using mortise::run::CheckpointTimes;
using mortise::testing::number;
using mortise::testing::table;

namespace {

Params scene(Params output = Params::make_table()) { return table({{"output", std::move(output)}}); }
void wait(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

// A state that was saved in a hundredth of a second is saved again after twenty of these, and by ten runs that take turns after two hundred.
TEST(CheckpointTimes, TakeATwentiethOfTheTime) {
  CheckpointTimes alone(scene(), 0, 1), among(scene(), 0, 10);
  EXPECT_TRUE(alone.due(1, true));
  EXPECT_FALSE(alone.due(1, false));  // without a frame never
  alone.saved(0.01), among.saved(0.01);
  EXPECT_FALSE(alone.due(2, true));
  wait(0.3);
  EXPECT_TRUE(alone.due(3, true));
  EXPECT_FALSE(alone.due(3, false));
  EXPECT_FALSE(among.due(3, true));
  alone.saved(1e3);  // a disk that hardly answers
  wait(0.05);
  EXPECT_FALSE(alone.due(4, true));
}

// What is asked for is done, whatever it takes.
TEST(CheckpointTimes, AreWhatTheSceneOrTheCommandLineSays) {
  const auto every = [](const char* what, Params n) { return scene(table({{"checkpoint_every", table({{what, std::move(n)}})}})); };
  CheckpointTimes steps(every("steps", Params::make_integer(4)), 0, 1), seconds(every("seconds", number(0.05)), 0, 10),
      command(every("steps", Params::make_integer(1)), 3600, 1);
  for (CheckpointTimes* of : {&steps, &seconds, &command}) of->saved(1e3);
  EXPECT_TRUE(steps.due(8, false));
  EXPECT_FALSE(steps.due(9, true));
  EXPECT_FALSE(seconds.due(1, true));
  wait(0.06);
  EXPECT_TRUE(seconds.due(2, false));
  EXPECT_FALSE(command.due(1, true));
}

}  // namespace
