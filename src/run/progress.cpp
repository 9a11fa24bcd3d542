#include "run/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "base/printable.h"

namespace mortise::run {
namespace {

std::string length(double metres) {
  if (!std::isfinite(metres)) return "-";
  if (std::abs(metres) < 1e-6) return fmt::format("{:.3g} nm", metres * 1e9);
  if (std::abs(metres) < 1e-3) return fmt::format("{:.3g} um", metres * 1e6);
  return fmt::format("{:.3g} mm", metres * 1e3);
}

std::string duration(double seconds) {
  if (seconds < 60) return fmt::format("{:.1f} s", seconds);
  if (seconds < 3600) return fmt::format("{:.0f} min {:02.0f} s", std::floor(seconds / 60), std::fmod(seconds, 60));
  return fmt::format("{:.0f} h {:02.0f} min", std::floor(seconds / 3600), std::fmod(seconds, 3600) / 60);
}

std::string figures(const solver::StepReport& r, const ContactFigures& c) {
  std::string text = fmt::format("t {:.4g} s  newton {:2}  residual {:.1e} N", r.time, r.newton, r.residual);
  if (r.lag > 0) text += fmt::format("  lag {}", r.lag);
  if (r.cg > 0) text += fmt::format("  cg {}", r.cg);
  if (r.substeps > 1) text += fmt::format("  substeps {}", r.substeps);
  if (c.pairs > 0) text += fmt::format("  contacts {:.0f}  gap {}", c.pairs, length(c.min_gap));
  return text;
}

class Lines : public Progress {
 public:
  explicit Lines(bool quiet) : quiet_(quiet) {}
  void start(const std::string& scene, const std::string& summary, long steps) override {
    steps_ = steps;
    line(fmt::format("{}: {}", scene, summary));
  }
  void step(const solver::StepReport& r, const ContactFigures& c) override {
    line(fmt::format("step {:>4}/{}  {}  {:.2f} s", r.step + 1, steps_, figures(r, c), r.wall));
  }
  void frame(long, double) override {}
  void note(const std::string& text) override { line(text); }
  void end(const std::string& status, double seconds) override { line(fmt::format("{} in {}", status, duration(seconds))); }

 protected:
  void line(const std::string& text) const {
    if (!quiet_) std::fputs((printable(text, true) + "\n").c_str(), stderr);
  }
  bool quiet_;
  long steps_ = 0;
};

// A bar, the figures of the last step, and how long the rest may take.
class Terminal : public Lines {
 public:
  Terminal() : Lines(false), began_(std::chrono::steady_clock::now()) {}
  void step(const solver::StepReport& r, const ContactFigures& c) override {
    const long done = r.step + 1;
    if (first_ < 0) first_ = r.step;
    constexpr int kWidth = 24;
    const int filled = static_cast<int>(kWidth * done / steps_);
    std::string bar;
    for (int i = 0; i < kWidth; ++i) bar += i < filled ? "█" : "░";
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
    const double left = spent / static_cast<double>(done - first_) * static_cast<double>(steps_ - done);
    std::fputs(fmt::format("\r\033[K{} {}/{}  {}  {} left", bar, done, steps_, figures(r, c), duration(left)).c_str(), stderr);
    std::fflush(stderr);
    open_ = true;
  }
  void note(const std::string& text) override {
    close_line();
    line(text);
  }
  void end(const std::string& status, double seconds) override {
    close_line();
    Lines::end(status, seconds);
  }

 private:
  void close_line() {
    if (open_) std::fputs("\n", stderr);
    open_ = false;
  }
  std::chrono::steady_clock::time_point began_;
  long first_ = -1;
  bool open_ = false;
};

class JsonLines : public Progress {
 public:
  void start(const std::string& scene, const std::string& summary, long steps) override { put({{"event", "start"}, {"scene", scene}, {"summary", summary}, {"steps", steps}}); }
  void step(const solver::StepReport& r, const ContactFigures& c) override {
    nlohmann::json j{{"event", "step"}, {"step", r.step + 1}, {"time", r.time}, {"newton", r.newton}, {"lag", r.lag}, {"cg", r.cg}, {"substeps", r.substeps},
                     {"residual", r.residual}, {"energy", r.energy}, {"ms", r.wall * 1e3}};
    if (std::isfinite(c.pairs)) j["contacts"] = c.pairs;
    if (std::isfinite(c.min_gap)) j["min_gap"] = c.min_gap;
    put(j);
  }
  void frame(long frame, double time) override { put({{"event", "frame"}, {"frame", frame}, {"time", time}}); }
  void note(const std::string& text) override { put({{"event", "note"}, {"text", text}}); }
  void end(const std::string& status, double seconds) override { put({{"event", "end"}, {"status", status}, {"seconds", seconds}}); }
  bool lost() const override { return lost_; }

 private:
  void put(const nlohmann::json& j) {
    if (lost_) return;
    const std::string line = j.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";  // paths need not be UTF-8
    lost_ = std::fputs(line.c_str(), stdout) < 0 || std::fflush(stdout) != 0;
  }
  bool lost_ = false;
};

}  // namespace

std::unique_ptr<Progress> make_progress(bool json, bool quiet) {
  if (json) return std::make_unique<JsonLines>();
  const char* term = std::getenv("TERM");
  if (!quiet && isatty(STDERR_FILENO) && term && std::string(term) != "dumb") return std::make_unique<Terminal>();
  return std::make_unique<Lines>(quiet);
}

}  // namespace mortise::run
