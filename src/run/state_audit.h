#pragma once
// Energy and balance of the states of a run, from what effects report of each: `mortise run` writes them to every frame (group `audit` of
// fields.vtkhdf) and to certificate.json, and judges criteria by them.
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/archive.h"
#include "model/input.h"
#include "run/measured_body.h"

namespace mortise::run {

// The report of one state.
struct StateReport {
  std::map<std::string, std::vector<double>> fields;  // of points, three components
  std::map<std::string, double> scalars;              // "group/name"
  std::vector<double> points;                         // [m]

  double scalar(const std::string& name) const {
    const auto it = scalars.find(name);
    return it == scalars.end() ? NAN : it->second;
  }
  Vec3 vector(const std::string& stem) const { return {scalar(stem + "x"), scalar(stem + "y"), scalar(stem + "z")}; }
  // Null where no effect reported it.
  const std::vector<double>* field(const char* name) const {
    const auto it = fields.find(name);
    return it == fields.end() || it->second.empty() ? nullptr : &it->second;
  }
};

// Sum of all forces [N], and what it is to be held against: the largest force of one effect on one body or, where larger, what supports hold
// the points with, summed without regard to direction (forces inside of one body have no resultant). NaN before anything was solved.
struct ForceBalance {
  double defect = NAN, scale = NAN;
};
ForceBalance force_balance(const std::map<std::string, double>& scalars, double support_forces);
double sum_of_sizes(const std::vector<double>& vectors);

class EnergyAudit {
 public:
  explicit EnergyAudit(const model::ModelInput& input);

  struct Result {
    double total = NAN;           // kinetic and stored energy [J], without the turning of pinned stiff bodies, whose moment is not reported
    double support_work = 0;      // of moving supports since the start [J]
    double gain = NAN;            // of this step: change of total less the work of supports [J]; NaN: the first state
    double largest_gain = NAN;    // of all steps so far [J]
    double scale = 0;             // largest energy of the run so far [J]
    bool work_is_known = true;    // false: dead loads do work that is not counted, or nothing moves in time; then `gain` stays NaN
  };
  const Result& state(const StateReport& now);
  const Result& result() const { return r_; }
  void checkpoint(Archive& archive);

 private:
  double total(const StateReport& now);
  double turning(const StateReport& now) const;
  double support_work(const StateReport& now) const;

  std::vector<MeasuredBody> bodies_;
  Result r_;
  double all_ = NAN;  // total energy, turning of pinned bodies included
  std::vector<double> points_before_;
  double gravity_first_ = NAN;
};

}  // namespace mortise::run
