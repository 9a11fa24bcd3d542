#pragma once
// The equations of joints that an augmented Lagrangian holds (equation.h), and what they did.
#include <string>
#include <vector>

#include "effects/coordinate_energy.h"
#include "effects/joint/equation.h"
#include "model/joints.h"

namespace mortise::effects::joint {

struct EquationLinearisation final : CoordinateLinearisation {
  device::Buffer<EquationReading> equations;
  std::size_t bytes() const override { return CoordinateLinearisation::bytes() + equations.bytes(); }
};

class Equations {
 public:
  explicit Equations(model::Model& model) : model_(model) {}

  // All effects exist. Joints follow others that no tie lets follow, and slides on bodies that move freely keep to their axes.
  void find();
  bool any() const { return !list_.empty(); }
  std::size_t bytes() const { return on_device_.bytes(); }
  Index size() const { return static_cast<Index>(list_.size()); }

  void begin_step(const StepInfo& step);
  void energy(Positions q, device::EnvValues per_env) const;
  void fill(Positions q, Want want, EquationLinearisation& at, Index first_block, Index first_pair) const;
  void max_step(View<const Vec3> dq, const EquationLinearisation& at, device::EnvValues alpha) const;
  void refit(Positions q, std::vector<Effect::Refit>& per_env);
  void object(Positions q, std::vector<std::string>& per_env) const;
  void end_step(const StepInfo& step, Positions q);
  void report(const FieldSinks& sinks) const;
  void checkpoint(Archive& archive);

  std::vector<double> misses(Positions q) const;  // c of every equation at q

 private:
  struct One {
    Index joint, env;
    Index leader = -1;           // -1: the way across a slide,
    Vec3 across = Vec3::Zero();  // along this direction at rest
    double inertia, effort;      // what is accelerated by x [kg m^2, kg], and a figure of the forces there are on it [N m, N]
    double scale;                // of x [1, m]
    Equation now{};              // of the step under way
    double lambda = 0, K = 0;    // of the accepted state
    double before = INFINITY;    // |c| when lambda was last changed in this step
    double miss = 0;             // c of the accepted state
  };
  void upload();
  void place(One& o) const;  // coordinates as the accepted state has them
  One described(Index joint) const;

  model::Model& model_;
  std::vector<One> list_;  // by environment
  std::vector<Index> env_offset_{0};
  device::Buffer<Equation> on_device_;
};

}  // namespace mortise::effects::joint
