#pragma once
// Where a run waits: for its engine, and for every step. Who serves it decides whether that engine is its own (alone.h) or one that it shares with
// other environments (together.h); the run itself is the same.
#include <coroutine>
#include <functional>
#include <memory>
#include <string>

#include "engine/engine.h"
#include "model/input.h"

namespace mortise::run {

class Turn {
 public:
  enum class Wants { engine, step };
  struct Wait {
    Turn& turn;
    bool await_ready() const noexcept { return false; }
    void await_suspend(std::coroutine_handle<> run) noexcept { turn.waiting_ = run; }
    engine::Outcome await_resume() const { return turn.outcome; }
  };

  // The run awaits these; the outcome says how it went.
  Wait engine(const model::ModelInput& input, std::unique_ptr<engine::Engine>& to) {
    wants = Wants::engine, this->input = &input, made = &to;
    return {*this};
  }
  Wait step(engine::Engine& engine, std::function<bool()> stop_asked) {
    wants = Wants::step, of = &engine, stop = std::move(stop_asked);
    return {*this};
  }

  // Who serves it fills `outcome` and what belongs to it, and lets it go on.
  void go_on() { std::exchange(waiting_, {}).resume(); }

  Wants wants = Wants::engine;
  const model::ModelInput* input = nullptr;         // of the engine that is wanted, which goes
  std::unique_ptr<engine::Engine>* made = nullptr;  // here
  engine::Engine* of = nullptr;                     // whose step is wanted,
  std::function<bool()> stop;                       // and whether that should be left
  engine::Outcome outcome;
  std::string said;           // with the engine: what the user should know
  device::DeviceInfo device;  // its device
  solver::StepReport report;  // with a step,
  double wall = 0, cpu = 0;   // which took so long [s]

 private:
  std::coroutine_handle<> waiting_;
};

}  // namespace mortise::run
