#pragma once
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "audit/measured_body.h"
#include "audit/state_audit.h"
#include "base/error.h"
#include "base/params.h"
#include "base/snapshot.h"
#include "model/input.h"
#include "solver/report.h"

namespace mortise::audit {

// Judges a run by the scene's `checks` (src/scene/checks.cpp says what each quantity is). Verdicts do not change a run; they go into
// certificate.json and decide between Exit::done and Exit::checks. Covers the whole run, through every --resume.
class Checks {
 public:
  explicit Checks(const model::ModelInput& input);

  bool empty() const { return criteria_.empty(); }
  // Takes note of what was reported of a state; points: 3 per point [m]. Its energies, also without any criterion.
  const EnergyAudit::Result& state(const Snapshot& said, const std::vector<double>& points, double time = 0);
  const EnergyAudit::Result& energy() const { return energy_.result(); }
  void step(const solver::StepReport& report);
  void checkpoint(Archive& archive);  // all that was measured so far

  struct Verdict {
    std::string text;    // "position of cube (z) at the end near 0.5 +- 0.001"
    double value = NAN;  // the worst, or the one asked for; NaN: none was measured
    std::string found;   // of an outcome
    bool pass = false;
    bool reached = true;  // else the run ended before there was anything to judge
  };
  std::vector<Verdict> verdicts(Exit status, const std::string& message) const;

  // certificate.json with the verdicts as `criteria`; unchanged when the scene has none.
  static std::string add_to(const std::string& certificate, const std::vector<Verdict>& verdicts);

 private:
  // One entry of the list with what was measured for it.
  struct Criterion {
    Params params;
    std::string quantity, body, when;
    std::set<std::string> bodies;  // several, whose values are added up to `together`
    Vec3 together = Vec3::Zero();
    bool any = false;  // of them has a value in this state
    double from = -INFINITY, until = INFINITY;
    // So that a mean of whole cycles has each of their steps once. Times are sums of steps: a hair of rounding decides nothing.
    bool counts(double t) const { return t > from + 1e-9 && t < until + 1e-9; }
    int axis = -1;  // 0..2, 3: length
    double first = NAN, last = NAN, smallest = NAN, largest = NAN, sum = 0;
    long count = 0;
    bool not_finite = false;  // once: no bound holds
    void record(double v);
    void record(const Vec3& v) { record(axis == 3 ? v.norm() : v[axis]); }
  };
  void record(const std::string& quantity, double v);
  void record(const std::string& quantity, const std::string& body, double v);
  void record(const std::string& quantity, const std::string& body, const Vec3& v);
  bool wants(const std::string& quantity, const std::string& body) const;
  void measure(const MeasuredBody& body, const StateReport& now);
  void momentum(const StateReport& now);
  double value(const Criterion& c) const;
  Verdict judge(const Criterion& c, Exit status, const std::string& message) const;

  double now_ = 0;  // time of the state or step that is looked at [s]
  std::vector<Criterion> criteria_;
  std::vector<MeasuredBody> bodies_;
  EnergyAudit energy_;
  std::vector<std::string> contacts_;  // effects by role
  std::string inertia_;
  std::vector<double> start_;  // points at rest
  double momentum_scale_ = 0, force_tolerance_ = 0;
  std::optional<Vec3> momentum_first_;
};

}  // namespace mortise::audit
