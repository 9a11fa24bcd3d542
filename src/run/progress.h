#pragma once
#include <memory>
#include <string>

#include "audit/contact_figures.h"
#include "audit/grade.h"
#include "solver/report.h"

namespace mortise::run {

// Tells the user how a run goes: one line that rewrites itself on a terminal, one line per step otherwise (both on stderr), or
// one JSON object per event on stdout.
class Progress {
 public:
  virtual ~Progress() = default;
  virtual void start(const std::string& scene, const std::string& summary, long steps) = 0;
  virtual void step(const solver::StepReport& report, const audit::ContactFigures& contact) = 0;
  virtual void frame(long frame, double time) = 0;
  virtual void note(const std::string& text) = 0;
  virtual void fault(const std::string& text) { note(text); }  // what is said however quiet it is to be
  virtual void end(const std::string& status, double seconds, const audit::Grade& grade) = 0;
  virtual bool lost() const { return false; }  // could an event not be written to where they were asked for?
};

std::unique_ptr<Progress> make_progress(bool json, bool quiet);
// JSON lines on the standard output that begin with the environment's number.
std::unique_ptr<Progress> make_progress_of(long environment);

bool on_terminal();      // the standard error is one that lines can be rewritten on
int terminal_columns();  // of the terminal behind the standard error, which may change at any time
std::string duration_text(double seconds);

}  // namespace mortise::run
