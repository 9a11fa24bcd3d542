#include "run/batch_progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/printable.h"
#include "run/progress.h"

namespace mortise::run {

using Json = nlohmann::ordered_json;
using Time = std::chrono::steady_clock;

BatchProgress::BatchProgress(bool json, bool quiet) : json_(json), quiet_(quiet), terminal_(!json && !quiet && on_terminal()) {}

void BatchProgress::start(const std::string& scene, const std::string& summary, long environments, long steps) {
  environments_ = environments, steps_ = steps;
  if (json_)
    return put(json_text(Json{{"event", "start"}, {"scene", scene}, {"summary", summary}, {"steps", steps}, {"environments", environments}}));
  line(scene + ": " + summary);
}

void BatchProgress::event(long environment, const std::string& text) {
  const Json event = Json::parse(text, nullptr, false);
  if (!event.is_object()) return;
  if (event.value("event", "") == "step") ++steps_done_;
  if (json_) {
    Json out{{"event", event.value("event", "")}, {"environment", environment}};
    for (const auto& [key, value] : event.items()) out[key] = value;
    put(json_text(out));
  } else if (terminal_) {
    constexpr std::chrono::milliseconds kBetween(100);
    if (Time::now() - drawn_ > kBetween) draw();
  }
}

void BatchProgress::note(const std::string& text) {
  if (json_) return put(json_text(Json{{"event", "note"}, {"text", text}}));
  clear();
  line(text);
}

void BatchProgress::ended(long environment, const EnvironmentEnd& end) {
  ++ended_;
  failed_ += end.failed();
  if (json_) return;
  if (end.failed() || !terminal_) {
    clear();
    std::string text = fmt::format("environment {:>4}  {:<13}  {:>3}/{}  {:>4} steps  newton {:>5}  {:.2f} s", environment, end.status(), ended_,
                                   environments_, end.steps, end.newton, end.wall);
    if (!end.grade.empty()) text += "  grade " + end.grade;
    if (end.failed()) text += "\n  " + end.message;
    line(text);
  }
  if (terminal_) draw();
}

void BatchProgress::end(const std::string& status, double seconds) {
  if (json_) return put(json_text(Json{{"event", "end"}, {"status", status}, {"seconds", seconds}}));
  clear();
  line(fmt::format("{} in {}", status, duration_text(seconds)));
}

void BatchProgress::draw() {
  drawn_ = Time::now();
  std::string text = fmt::format("{}/{} environments  {}/{} steps", ended_, environments_, steps_done_, environments_ * steps_);
  if (failed_ > 0) text += fmt::format("  {} failed", failed_);
  if (steps_done_ > 0) {
    const double spent = std::chrono::duration<double>(Time::now() - began_).count();
    text += "  " + duration_text(spent / static_cast<double>(steps_done_) * static_cast<double>(environments_ * steps_ - steps_done_)) + " left";
  }
  text.resize(std::min(text.size(), static_cast<std::size_t>(std::max(terminal_columns() - 1, 0))));
  std::fputs(("\r\033[K" + text).c_str(), stderr);
  std::fflush(stderr);
  open_ = true;
}

void BatchProgress::clear() {
  if (open_) std::fputs("\r\033[K", stderr);
  open_ = false;
}

void BatchProgress::line(const std::string& text) {
  if (!quiet_) std::fputs((printable(text, true) + "\n").c_str(), stderr);
}

void BatchProgress::put(const std::string& json) {
  if (!lost_) lost_ = std::fputs((json + "\n").c_str(), stdout) < 0 || std::fflush(stdout) != 0;
}

}  // namespace mortise::run
