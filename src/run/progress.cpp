#include "run/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/json_text.h"
#include "base/printable.h"
#include "run/step_row.h"

namespace mortise::run {

std::string duration_text(double seconds) {
  if (seconds < 60) return fmt::format("{:.1f} s", seconds);
  if (seconds < 3600) return fmt::format("{:.0f} min {:02.0f} s", std::floor(seconds / 60), std::fmod(seconds, 60));
  return fmt::format("{:.0f} h {:02.0f} min", std::floor(seconds / 3600), std::fmod(seconds, 3600) / 60);
}

int terminal_columns() {
  constexpr int kUnknown = 80;
  winsize size = {};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kUnknown;
}

bool on_terminal() {
  const char* term = std::getenv("TERM");
  return isatty(STDERR_FILENO) && term && std::string(term) != "dumb";
}

namespace {

std::string length(double metres) {
  if (!std::isfinite(metres)) return "-";
  if (std::abs(metres) < 1e-6) return fmt::format("{:.3g} nm", metres * 1e9);
  if (std::abs(metres) < 1e-3) return fmt::format("{:.3g} um", metres * 1e6);
  return fmt::format("{:.3g} mm", metres * 1e3);
}

// What a line may tell of a step. When it is too long for the terminal, the largest `rank` goes first.
struct Figure {
  int rank;
  std::string text;
};

std::vector<Figure> figures(const solver::StepReport& r, const audit::ContactFigures& c) {
  std::vector<Figure> list{
      {1, fmt::format("t {:.4g} s", r.time)}, {3, fmt::format("newton {:2}", r.newton)}, {4, fmt::format("residual {:.1e} N", r.residual)}};
  if (r.lag > 0) list.push_back({8, fmt::format("lag {}", r.lag)});
  if (r.cg > 0) list.push_back({9, fmt::format("cg {}", r.cg)});
  if (r.substeps > 1) list.push_back({5, fmt::format("substeps {}", r.substeps)});
  if (c.pairs > 0) list.push_back({7, fmt::format("contacts {:.0f}", c.pairs)}), list.push_back({6, "gap " + length(c.min_gap)});
  return list;
}

std::string joined(const std::vector<Figure>& list) {
  std::string text;
  for (const Figure& f : list) text += (text.empty() ? "" : "  ") + f.text;
  return text;
}

// "█████░░░  12/40  FIGURES" in fewer than `width` columns: a line that fills the last column wraps on some terminals. Figures are left out
// while the bar would be shorter than its least; `longest` makes it never longer than the line before.
constexpr int kLongestBar = 24;
std::string bar_line(long done, long steps, std::vector<Figure> list, int width, int& longest) {
  constexpr int kLeast = 10;
  const std::string count = fmt::format("{}/{}", done, steps);
  const auto room = [&] { return width - 1 - static_cast<int>(1 + count.size() + 2 + joined(list).size()); };
  while (!list.empty() && room() < kLeast)
    list.erase(std::max_element(list.begin(), list.end(), [](const Figure& a, const Figure& b) { return a.rank < b.rank; }));
  const int length = longest = std::clamp(list.empty() ? width - 2 - static_cast<int>(count.size()) : room(), 0, longest);
  const int filled = static_cast<int>(length * done / std::max(steps, 1L));
  std::string line;
  for (int i = 0; i < length; ++i) line += i < filled ? "█" : "░";
  if (length > 0) line += " ";
  line += count.substr(0, static_cast<std::size_t>(std::max(width - 1, 0)));
  if (!list.empty()) line += "  " + joined(list);
  return line;
}

class Lines : public Progress {
 public:
  explicit Lines(bool quiet) : quiet_(quiet) {}
  void start(const std::string& scene, const std::string& summary, long steps) override {
    steps_ = steps;
    line(fmt::format("{}: {}", scene, summary));
  }
  void step(const solver::StepReport& r, const audit::ContactFigures& c) override {
    line(fmt::format("step {:>4}/{}  {}  {:.2f} s", r.step + 1, steps_, joined(figures(r, c)), r.wall));
  }
  void frame(long, double) override {}
  void note(const std::string& text) override { line(text); }
  void fault(const std::string& text) override {
    note(text);
    if (quiet_) put(text);
  }
  void end(const std::string& status, double seconds, const audit::Grade& grade) override {
    line(fmt::format("{} in {}; {}", status, duration_text(seconds), audit::text_of(grade)));
    for (const std::string& hint : audit::hints(grade)) line("hint: " + hint);
  }

 protected:
  void line(const std::string& text) const {
    if (!quiet_) put(text);
  }
  static void put(const std::string& text) { std::fputs((printable(text, true) + "\n").c_str(), stderr); }
  bool quiet_;
  long steps_ = 0;
};

// A bar, the figures of the last step, and how long the rest may take.
class Terminal : public Lines {
 public:
  Terminal() : Lines(false), began_(std::chrono::steady_clock::now()) {}
  ~Terminal() override { close_line(); }  // an error may be told next
  void start(const std::string& scene, const std::string& summary, long steps) override {
    Lines::start(scene, summary, steps);
    wait();
  }
  void step(const solver::StepReport& r, const audit::ContactFigures& c) override {
    const long done = r.step + 1;
    if (first_ < 0) first_ = r.step;
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
    const double left = spent / static_cast<double>(done - first_) * static_cast<double>(steps_ - done);
    std::vector<Figure> list = figures(r, c);
    list.push_back({2, duration_text(left) + " left"});
    if (const int width = terminal_columns(); width != width_) width_ = width, longest_ = kLongestBar;
    std::fputs(("\r\033[K" + bar_line(done, steps_, std::move(list), width_, longest_)).c_str(), stderr);
    std::fflush(stderr);
    open_ = true;
  }
  void note(const std::string& text) override {
    close_line();
    line(text);
    if (first_ < 0) wait();
  }
  void end(const std::string& status, double seconds, const audit::Grade& grade) override {
    close_line();
    Lines::end(status, seconds, grade);
  }

 private:
  // Until a bar can be drawn: the first step of a fine mesh takes minutes.
  void wait() {
    std::fputs("the first step ...", stderr);
    std::fflush(stderr);
    open_ = true;
  }
  void close_line() {
    if (open_) std::fputs(first_ < 0 ? "\r\033[K" : "\n", stderr);
    open_ = false;
  }
  std::chrono::steady_clock::time_point began_;
  long first_ = -1;
  int width_ = 0, longest_ = kLongestBar;
  bool open_ = false;
};

class JsonLines : public Progress {
 public:
  explicit JsonLines(std::string prefix = "") : prefix_(std::move(prefix)) {}
  void start(const std::string& scene, const std::string& summary, long steps) override {
    put({{"event", "start"}, {"scene", scene}, {"summary", summary}, {"steps", steps}});
  }
  void step(const solver::StepReport& r, const audit::ContactFigures& c) override {
    nlohmann::ordered_json j{{"event", "step"}};
    const output::StepRow row = step_row(r, c);
    for (const output::StepColumn& column : output::step_columns)
      if (const double value = row.*column.value; std::isfinite(value)) {
        if (std::string_view(column.unit) == "1")
          j[column.name] = static_cast<long long>(value);  // a count
        else
          j[column.name] = value;
      }
    put(j);
  }
  void frame(long frame, double time) override { put({{"event", "frame"}, {"frame", frame}, {"time", time}}); }
  void note(const std::string& text) override { put({{"event", "note"}, {"text", text}}); }
  void end(const std::string& status, double seconds, const audit::Grade& grade) override {
    put({{"event", "end"},
         {"status", status},
         {"seconds", seconds},
         {"grade", grade.all.letter},
         {"grade_forces", grade.forces.letter},
         {"reason", grade.all.reason}});
  }
  bool lost() const override { return lost_; }

 private:
  void put(const nlohmann::ordered_json& j) {
    if (lost_) return;
    const std::string line = prefix_ + json_text(j) + "\n";
    lost_ = std::fputs(line.c_str(), stdout) < 0 || std::fflush(stdout) != 0;
  }
  const std::string prefix_;
  bool lost_ = false;
};

}  // namespace

std::unique_ptr<Progress> make_progress_of(long environment) { return std::make_unique<JsonLines>(std::to_string(environment) + " "); }

std::unique_ptr<Progress> make_progress(bool json, bool quiet) {
  if (json) return std::make_unique<JsonLines>();
  if (!quiet && on_terminal()) return std::make_unique<Terminal>();
  return std::make_unique<Lines>(quiet);
}

}  // namespace mortise::run
