#pragma once
// One model of several environments, all of which take their steps at once, and what each of them sees of it: an engine of its own. Environments come
// and go; the others have the same bits whoever is beside them.
#include <optional>

#include "base/memory_archive.h"
#include "base/snapshot.h"
#include "engine/choose.h"

namespace mortise::run {

class SharedEngine {
 public:
  explicit SharedEngine(engine::Choice on) : on_(std::move(on)) {}

  // An engine of its own for one that is not there.
  engine::Outcome try_alone(const model::ModelInput& input, std::unique_ptr<engine::Engine>& to) const { return on_.api->create(input, to); }
  // Adds an environment at its start; it may be used from the next renew() on. `input` has to outlive it. It leaves when it goes.
  std::unique_ptr<engine::Engine> add(const model::ModelInput& input);
  // Makes the model anew, of those that are there; each goes on from where it was.
  engine::Outcome renew();
  bool worth_renewing() const { return 2 * members_.size() < static_cast<std::size_t>(places_); }  // most of the model stands still
  bool has(const engine::Engine& engine) const;
  std::size_t size() const { return members_.size(); }
  std::size_t memory_needed() const;
  const device::DeviceInfo& device() const { return on_.device; }

  // A step of all; how it went for each of them.
  engine::Outcome step(const std::function<bool()>& stop_asked);
  engine::Outcome outcome_of(const engine::Engine& member, const engine::Outcome& of_all) const;
  const solver::StepReport& report_of(const engine::Engine& member) const;

 private:
  class Member;
  static const Member& of(const engine::Engine& engine);
  void leave(Member& member);
  void forget() { points_.reset(), snapshots_.clear(), saved_.clear(); }
  // Of the present state, found once for all.
  const Snapshot& snapshot(Index env);
  std::vector<double> points(Index env);
  const MemoryArchive& saved(Index env);

  engine::Choice on_;
  std::vector<Member*> members_;  // in the order in which they came
  std::unique_ptr<engine::Engine> engine_;
  Index places_ = 0;  // environments of the model, some of which may have left
  std::vector<solver::StepReport> reports_;
  std::vector<Index> first_point_;
  std::optional<std::vector<double>> points_;
  std::vector<Snapshot> snapshots_;
  std::vector<MemoryArchive> saved_;
};

}  // namespace mortise::run
