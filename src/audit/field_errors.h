#pragma once
// Estimates of the errors of fields: at the state that was loaded most, where a run is judged by what it was made for, and at the last one that was
// still loaded, which is what people look at. Each is the worst of any bodies that press each other: what stands by itself tells nothing of others.
// Stresses besides by what each phase of the scene changed (asked.h): a pad that is squeezed hides how badly its mesh bends, and so does what comes
// later.
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "audit/asked.h"
#include "audit/facet_depth.h"
#include "audit/layer_error.h"
#include "audit/linear_law.h"
#include "audit/load_turned.h"
#include "audit/pressure_error.h"
#include "audit/rim_error.h"
#include "audit/stiffness_error.h"
#include "audit/stress_error.h"
#include "base/archive.h"
#include "base/snapshot.h"

namespace mortise::audit {

class FieldErrors {
 public:
  explicit FieldErrors(const model::ModelInput& input);

  void state(const Snapshot& said, double time = NAN);  // after a step that ended then [s]; NaN: within a phase
  struct Result {
    double stress = NAN, turned = NAN, load_turned = NAN;  // stress_error.h, linear_law.h, load_turned.h
    PressureError::Result pressure;
    double stiffness = NAN;                      // what is left of `stress` in forces and motions (stiffness_error.h)
    double guard = NAN;                          // share of the force between two bodies that the guard bears
    double layer = NAN;                          // layer_error.h
    double layer_over_way = NAN;                 // stiffness_error.h
    double rim = NAN;                            // rim_error.h, of forces and motions as `stiffness` is
    double facets = NAN, facets_over_way = NAN;  // as `layer` and `layer_over_way` (facet_depth.h)
  };
  Result result() const;
  void checkpoint(Archive& archive);

 private:
  // Contact samples of an effect: what the pressure bears, and the guard.
  struct Samples {
    LayerError::Samples pressed;
    std::vector<double> guard_bodies, guard_force;
  };
  using AllSamples = std::map<std::string, Samples>;
  static AllSamples samples_of(const Snapshot& said);
  static double elastic_of(const Snapshot& said);  // [J]
  static double pressed_of(const Snapshot& said);  // sum of nodal pressures [Pa]
  struct Judged {
    bool stress = false, pressure = false, layer = false;
  };
  // A state, and what of it has been judged: where a run is loaded most now, checkpoint after checkpoint asks for it twice.
  struct State {
    Snapshot said;
    Judged judged;
    Result result;
  };
  void judge(State& state, Judged what, Result& r) const;
  void judge_stress(const Snapshot& said, const AllSamples& samples, Result& r) const;
  void judge_pressure(const Snapshot& said, const AllSamples& samples, Result& r) const;
  void judge_layer(const Snapshot& said, const AllSamples& samples, Result& r) const;
  Result at_most() const;
  Result at_last() const;
  void phase(const Snapshot& said, double time);
  double of_phases(const std::vector<double>& errors) const;
  // Of stresses, or their change, and the displacements that belong to them.
  struct OfStress {
    double energy, stress, stiffness;
  };
  OfStress of_stress(const StressError::Stresses& stresses, std::span<const double> displacement, const Snapshot& said,
                     const AllSamples& samples) const;
  static LayerError::Fields fields_of(const Snapshot& said);
  static ContactPatch::Fields patch_of(const Snapshot& said);
  std::vector<LayerError::Travel> travels(const Snapshot& said, const AllSamples& samples) const;
  StiffnessError::Bases bases(const LayerError::Fields& fields) const;
  static void io(Archive& archive, const std::string& prefix, Result& r);
  std::vector<std::size_t> groups(const AllSamples& samples) const;

  StressError stress_;
  StiffnessError stiffness_;
  PressureError pressure_;
  RimError rim_;
  LayerError layer_;
  FacetDepth facets_;
  LinearLaw linear_law_;
  LoadTurned load_turned_;
  std::vector<bool> passes_on_;  // by body that has points, what presses it to others: soft ones, and stiff ones that nothing holds
  std::vector<std::pair<std::size_t, std::size_t>> tied_;  // of those
  double energy_floor_ = 0;                                // of strains that are rounding [J]
  std::vector<Phase> phases_;
  long phase_ = 0;                                                // under way
  std::vector<double> stress_then_, displacement_then_;           // when it began; empty: at rest
  std::vector<double> changed_, changed_badly_, changed_forces_;  // by every phase that ended: energy [J], stress_error.h, stiffness_error.h
  double most_elastic_ = 0, most_pressed_ = 0;                    // [J], [Pa]
  // Judged when someone asks: the state that was stressed most, that which was pressed most, and the latest that was pressed as much.
  std::shared_ptr<State> stressed_, pressed_, layered_;  // null: none since the run was resumed, or a checkpoint asked
  Result at_most_;                                       // until then
  std::shared_ptr<State> last_;
  bool resumed_ = false;  // no state has come since: the last one is known by
  Result resumed_last_;
};

}  // namespace mortise::audit
