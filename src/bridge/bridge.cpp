#include "bridge/bridge.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "bridge/exit.h"

namespace mortise::bridge {
namespace {

double step_of(const Params& time) { return time.text("mode") == "static" ? 1.0 / static_cast<double>(time.integer("steps")) : time.number("step"); }

}  // namespace

Bridge::Bridge(const Options& options, const model::ModelInput& input, const sensors::Sensors& sensors)
    : options_(options),
      scene_(input.scene.text("name")),
      time_step_(step_of(input.scene.at("time"))),
      state_(input, sensors),
      drives_(drives_of(input.scene)),
      every_(options.every) {
  if (options_.replay.empty()) return;
  Recording other = Recording::read(options_.replay);
  every_ = other.every();
  given_ = other.entries(), given_by_ = options_.replay;
  recording_ = std::move(other);
}

std::string Bridge::begin(const std::string& folder, const std::string& scene_sha256, long step, long steps, bool resumed) {
  const std::string path = folder + "/" + kRecordingFile;
  std::string note;
  if (resumed) {
    if (!std::filesystem::exists(path))
      throw Error(Exit::usage, "'" + folder + "' was made without a bridge, so it cannot be continued with one; choose another -o");
    recording_.reopen(path);
    if (options_.partner && recording_.every() != every_)
      throw Error(Exit::usage,
                  fmt::format("'{}' has a message every {} steps; continue it with --bridge-every {}", path, recording_.every(), recording_.every()));
    every_ = recording_.every();
    // What is to be repeated of another run goes on where this one has got to.
    const std::vector<Recording::Entry> rest = std::move(given_);
    given_ = recording_.entries();
    const long got_to = given_.empty() ? -1 : given_.back().step;
    for (const Recording::Entry& e : rest)
      if (e.step > got_to) given_.push_back(e);
    if (options_.replay.empty()) given_by_ = path;
    while (at_ < given_.size() && given_[at_].step < step) ++at_;
    number_ = static_cast<long>(at_);
    if (at_ < given_.size()) note = fmt::format("{} messages of '{}' are taken again", given_.size() - at_, given_by_);
  } else {
    if (!given_by_.empty() && recording_.scene_sha256() != scene_sha256)
      note = "'" + given_by_ + "' was recorded with another scene: its commands are repeated, not its results";
    recording_.create(path, scene_sha256, every_);
  }
  if (options_.partner)
    options_.partner->say(state_.hello({scene_, options_.environment, options_.episode, every_, steps, step, time_step_}, drives_));
  return note;
}

void Bridge::see(long step, double time, const Snapshot& said, const std::vector<double>& points, const std::vector<sensors::Reading>& readings) {
  for (const Drive& d : drives_)
    if (d.mode == Drive::Mode::kinematic) aims_[d.joint] = said.at("drive/" + d.joint + "_target");
  line_ = state_.line(step, time, said, points, readings);
}

const Recording::Entry* Bridge::recorded(long step) {
  if (at_ >= given_.size()) return nullptr;
  if (given_[at_].step != step) throw Error(Exit::file, fmt::format("'{}' has no message of step {}", given_by_, step));
  return &given_[at_++];
}

Bridge::Answer Bridge::ask(long step, double time, const std::function<bool()>& stop) {
  ++number_;
  time_ = time;
  const std::string to = fmt::format("the state of step {}", step);
  if (const Recording::Entry* entry = recorded(step)) {
    const Answer answer = hear(entry->said, fmt::format("{}:{}", given_by_, number_ + 1));
    keep(step, entry->said);
    return answer;
  }
  if (!options_.partner)
    throw Error(kPartnerFailed, fmt::format("the recording '{}' ends before {}; --resume --bridge COMMAND goes on from here", given_by_, to));
  const std::string said = options_.partner->ask(line_, to, stop);
  const Answer answer = hear(said, fmt::format("message {} of the bridge's partner, to {}", number_, to));
  keep(step, json_text(nlohmann::ordered_json::parse(said)));
  return answer;
}

void Bridge::keep(long step, const std::string& said) {
  if (recording_.entries().empty() || recording_.entries().back().step < step) recording_.add(step, said);
}

Bridge::Answer Bridge::hear(const std::string& said, const std::string& from) {
  const Message m = read_message(said, from, drives_);
  if (m.reset || m.end) return m.reset ? Answer::reset : Answer::end;
  for (const Drive& d : drives_) {
    const auto found = m.values.find(d.joint);
    if (found == m.values.end()) continue;
    // What is given exactly goes there on a straight line, as a jump would hit what is in between; motors make their own way.
    const bool line = d.mode == Drive::Mode::kinematic;
    commands_[d.joint] = {d.joint, line ? aims_.at(d.joint) : found->second, found->second, time_, time_ + time_step_ * static_cast<double>(every_)};
  }
  return Answer::go_on;
}

std::string Bridge::ask_last(long step, const std::function<bool()>& stop) {
  ++number_;
  if (at_ < given_.size() && given_[at_].step == step && given_[at_].said.find("reset") != std::string::npos) {
    keep(step, given_[at_++].said);
    return "";
  }
  if (!options_.partner) return "";
  try {
    const std::string said = options_.partner->ask(line_.substr(0, line_.size() - 1) + R"(,"last":true})", "the last state", stop);
    const Message m = read_message(said, fmt::format("message {} of the bridge's partner, to the last state", number_), drives_);
    if (m.reset) keep(step, R"({"reset":true})");
  } catch (const Partner::Stopped&) {
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

std::vector<model::Command> Bridge::commands() const {
  std::vector<model::Command> out;
  for (const auto& [joint, command] : commands_) out.push_back(command);
  return out;
}

void Bridge::checkpoint(Archive& archive) {
  std::string joints;
  std::vector<double> values;
  for (const auto& [joint, c] : commands_) joints += joint + "\n", values.insert(values.end(), {c.from, c.to, c.begin, c.end});
  archive.io("joints", joints);
  archive.io("commands", values);
  archive.io("aims", aims_);
  archive.io("line", line_);
  commands_.clear();
  for (std::size_t at = 0, i = 0, end; (end = joints.find('\n', at)) != std::string::npos; at = end + 1, i += 4) {
    const std::string joint = joints.substr(at, end - at);
    commands_[joint] = {joint, values.at(i), values.at(i + 1), values.at(i + 2), values.at(i + 3)};
  }
}

}  // namespace mortise::bridge
