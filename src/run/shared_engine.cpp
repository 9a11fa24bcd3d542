#include "run/shared_engine.h"

#include <algorithm>
#include <stdexcept>

#include "engine/join.h"
#include "engine/memory_needed.h"

namespace mortise::run {

// What an environment sees. Nothing but its own run asks it.
class SharedEngine::Member final : public engine::Engine {
 public:
  Member(SharedEngine& all, const model::ModelInput& input) : all_(all), input_(input) {}
  ~Member() override { all_.leave(*this); }

  void report(const FieldSinks& sinks) override { all_.snapshot(env_).report(sinks[0]); }
  std::vector<double> points() override { return all_.points(env_); }
  using Engine::checkpoint;
  engine::Outcome checkpoint(const std::vector<Archive*>& of) override {
    Archive& archive = *of.at(0);
    if (archive.loading()) {
      std::vector<Archive*> mine(all_.places_, nullptr);
      mine[env_] = &archive;
      all_.forget();
      return all_.engine_->checkpoint(mine);
    }
    for (const auto& [name, values] : all_.saved(env_).data()) {
      std::vector<double> copy = values;
      archive.io(name, copy);
    }
    return {};
  }
  double time(Index) const override { return all_.engine_->time(env_); }
  long steps_done(Index) const override { return all_.engine_->steps_done(env_); }
  std::string lost(Index) const override { return all_.engine_->lost(env_); }

  // Of all that share it.
  solver::Clock clock() const override { return all_.engine_->clock(); }
  std::vector<std::pair<std::string, long long>> launches() const override { return all_.engine_->launches(); }
  device::Transfers transfers() const override { return all_.engine_->transfers(); }
  device::Transfers step_transfers() const override { return all_.engine_->step_transfers(); }
  std::vector<std::pair<std::string, long long>> step_waits() const override { return all_.engine_->step_waits(); }
  std::size_t peak_memory() const override { return all_.engine_->peak_memory(); }
  std::string linear_solver() const override { return all_.engine_->linear_solver(); }

  // Not of an environment among others.
  engine::Outcome begin() override { throw alone(); }
  void command(const std::vector<model::Command>&) override { throw alone(); }
  engine::Outcome step(const std::function<bool()>&, const solver::StepReports&) override { throw alone(); }
  void rest(Index) override { throw alone(); }
  engine::Outcome lead(const std::vector<Engine*>&) override { throw alone(); }
  engine::Outcome mend(effects::Fault, double) override { throw alone(); }
  engine::Outcome adjoint(const solver::Functional&, solver::Adjoint&) override { throw alone(); }
  std::vector<engine::PlanItem> plan() override { throw alone(); }

  const model::ModelInput& input() const { return input_; }
  Index env() const { return env_; }
  void place(Index env) { env_ = env; }

 private:
  static std::logic_error alone() { return std::logic_error("an environment that shares its engine cannot do that"); }

  SharedEngine& all_;
  const model::ModelInput& input_;
  Index env_ = -1;  // in the model; -1: not there yet
};

const SharedEngine::Member& SharedEngine::of(const engine::Engine& engine) { return dynamic_cast<const Member&>(engine); }

bool SharedEngine::has(const engine::Engine& engine) const { return dynamic_cast<const Member*>(&engine) != nullptr; }

std::unique_ptr<engine::Engine> SharedEngine::add(const model::ModelInput& input) {
  auto member = std::make_unique<Member>(*this, input);
  members_.push_back(member.get());
  return member;
}

void SharedEngine::leave(Member& member) {
  std::erase(members_, &member);
  if (engine_ && member.env() >= 0) engine_->rest(member.env());
}

std::size_t SharedEngine::memory_needed() const {
  std::size_t sum = 0;
  for (const Member* m : members_) sum += engine::memory_needed(m->input());
  return sum;
}

engine::Outcome SharedEngine::renew() {
  std::vector<const model::ModelInput*> inputs;
  std::vector<MemoryArchive> states(members_.size());
  for (std::size_t i = 0; i < members_.size(); ++i) {
    inputs.push_back(&members_[i]->input());
    if (members_[i]->env() >= 0) states[i] = saved(members_[i]->env());
  }
  forget();
  engine_.reset();
  places_ = static_cast<Index>(members_.size());
  reports_.assign(places_, {});
  if (members_.empty()) return {};
  if (const engine::Outcome made = on_.api->create(engine::join(inputs), engine_); made.code != 0) return made;
  std::vector<Archive*> carried;
  first_point_.assign(1, 0);
  for (std::size_t i = 0; i < members_.size(); ++i) {
    states[i].rewind();
    carried.push_back(members_[i]->env() >= 0 ? &states[i] : nullptr);
    members_[i]->place(static_cast<Index>(i));
    Index points = 0;
    for (const model::BodyInput& body : inputs[i]->bodies)
      if (body.type != model::BodyType::half_space) points += static_cast<Index>(body.nodes.size());
    first_point_.push_back(first_point_.back() + points);
  }
  if (std::none_of(carried.begin(), carried.end(), [](const Archive* a) { return a; })) return {};
  return engine_->checkpoint(carried);
}

engine::Outcome SharedEngine::step(const std::function<bool()>& stop_asked) {
  forget();
  return engine_->step(stop_asked, reports_);
}

engine::Outcome SharedEngine::outcome_of(const engine::Engine& member, const engine::Outcome& of_all) const {
  if (const std::string lost = engine_->lost(of(member).env()); !lost.empty()) return {static_cast<int>(Exit::solve), lost};
  return of_all;
}

const solver::StepReport& SharedEngine::report_of(const engine::Engine& member) const { return reports_[of(member).env()]; }

const Snapshot& SharedEngine::snapshot(Index env) {
  if (snapshots_.empty()) {
    snapshots_.resize(places_);
    std::vector<FieldSink*> sinks(places_, nullptr);
    for (const Member* m : members_)
      if (m->env() >= 0) sinks[m->env()] = &snapshots_[m->env()];
    engine_->report(FieldSinks(std::move(sinks)));
  }
  return snapshots_[env];
}

std::vector<double> SharedEngine::points(Index env) {
  if (!points_) points_ = engine_->points();
  return {points_->begin() + 3 * first_point_[env], points_->begin() + 3 * first_point_[env + 1]};
}

const MemoryArchive& SharedEngine::saved(Index env) {
  if (saved_.empty()) {
    saved_.resize(places_);
    std::vector<Archive*> archives(places_, nullptr);
    for (const Member* m : members_)
      if (m->env() >= 0) archives[m->env()] = &saved_[m->env()];
    if (const engine::Outcome o = engine_->checkpoint(archives); o.code != 0) throw Error(static_cast<Exit>(o.code), o.message);
  }
  return saved_[env];
}

}  // namespace mortise::run
