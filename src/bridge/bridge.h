#pragma once
// One run that a partner drives, or that a recording drives again: what is said when, what it commands, and what is kept of it.
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/archive.h"
#include "bridge/message.h"
#include "bridge/partner.h"
#include "bridge/recording.h"
#include "bridge/state.h"
#include "model/command.h"

namespace mortise::bridge {

// What a command line asks for.
struct Options {
  Partner* partner = nullptr;  // null: only what was recorded is said
  std::string replay;          // the file of a recording; empty: none but the run's own, where it is continued
  long every = 1;              // steps from one message to the next
  long episode = 0;
  long environment = -1;  // of a scene that has several
};

class Bridge {
 public:
  Bridge(const Options& options, const model::ModelInput& input, const sensors::Sensors& sensors);

  // Begins at the start or, with a checkpoint loaded, in the middle. The folder is the run's own. Returns a sentence that the user should read, or
  // "".
  std::string begin(const std::string& folder, const std::string& scene_sha256, long step, long steps, bool resumed);

  // Does a message come before this step, or after the last?
  bool due(long step) const { return step % every_ == 0; }
  // The state that the next message answers to.
  void see(long step, double time, const Snapshot& said, const std::vector<double>& points, const std::vector<sensors::Reading>& readings);

  enum class Answer { go_on, end, reset };
  // Hears the message before the step that begins at `time`. Throws Error(kPartnerFailed) and Partner::Stopped.
  Answer ask(long step, double time, const std::function<bool()>& stop);
  // After the last step: a reset, or nothing that matters. Returns what may be wrong with it.
  std::string ask_last(long step, const std::function<bool()>& stop);

  std::vector<model::Command> commands() const;
  void checkpoint(Archive& archive);

 private:
  Answer hear(const std::string& said, const std::string& from);
  void keep(long step, const std::string& said);
  const Recording::Entry* recorded(long step);

  Options options_;
  const std::string scene_;
  const double time_step_;  // [s]
  State state_;
  const std::vector<Drive> drives_;
  Recording recording_;                  // of this run
  std::vector<Recording::Entry> given_;  // what is said without a partner, and how much of it was
  std::size_t at_ = 0;
  std::string given_by_;
  std::map<std::string, model::Command> commands_;
  std::map<std::string, double> aims_;  // of kinematic drives at the state that was seen [rad, m]
  std::string line_;
  long every_, number_ = 0;  // of messages
  double time_ = 0;          // of the control step
};

}  // namespace mortise::bridge
