#pragma once
// What all benchmarks share: rows of results, contact methods that can be exchanged in a scene, and a solver run in memory.
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "audit/certificate.h"
#include "base/snapshot.h"
#include "geometry/mesh.h"
#include "model/input.h"
#include "scene/scene.h"
#include "solver/report.h"

namespace mortise::bench {

// One measured quantity. NaN: there is none (no reference, no gate, the run failed).
struct Row {
  std::string name;  // "case" in tables
  std::string method, quantity;
  double value = NAN, reference = NAN, error = NAN;
  double gate = NAN;  // largest error that passes; NaN: reported only
  double seconds = 0;
  long newton_iterations = 0, dofs = 0;
  bool failed = false;       // the run did not converge
  audit::Grade as;           // that a certificate of the run would give; no letter: there is none
  double cpu_seconds = NAN;  // of the same steps: user and system time of all threads
  bool gated() const { return !std::isnan(gate); }
  bool pass() const { return !failed && (!gated() || error <= gate); }  // an error that is not a number does not pass a gate
};
std::string json_line(const Row& row);  // one object; `pass` is null for a converged run without a gate
std::string table_header();
std::string table_line(const Row& row);

// A form of contact. Scenes of benchmarks are written with mortar_contact; the IPC methods take its d_hat and stiffness.
struct Method {
  std::string name, effect, weights;  // weights: `weights` of mortar_contact, `form` of barrier_contact
  bool gated = false;                 // the gates are those of the product's own method
};
const std::vector<Method>& methods();

// Text of a scene with changes. Values are YAML; a path's parts are keys or places in lists.
class SceneText {
 public:
  explicit SceneText(std::string yaml) : yaml_(std::move(yaml)) {}
  void set(const std::string& path, const std::string& value);
  void set(const std::string& path, double value);
  void add(const std::string& list, const std::string& value);  // at its end
  std::string get(const std::string& path) const;
  double number(const std::string& path) const;  // a plain number or one with a unit of length, pressure ... is read as text
  // Paths of pins: of the only one that moves, and of the first of a body that holds these axes. Throw Error(Exit::internal) where there is none.
  std::string moving_pin() const;
  std::string pin(const std::string& body, const std::string& axes) const;
  // Exchanges mortar_contact for the method. In the classic form every pair counts with d_hat^2 whatever the mesh; its stiffness is
  // chosen so that a pair weighs node_area [m^2] times that of the scene.
  void use(const Method& method, double node_area);
  const std::string& text() const { return yaml_; }

 private:
  std::string yaml_;
};

struct Solved {
  model::ModelInput input;
  Snapshot fields;             // of the last state
  std::vector<double> points;  // 3 per point [m]
  std::vector<solver::StepReport> steps;
  bool converged = false;
  std::string why;  // it did not converge
  long newton = 0, dofs = 0;
  double seconds = 0;          // of the steps
  double cpu_seconds = 0;      // the same, user and system time of all threads
  double contact_share = NAN;  // of these seconds, spent in contact effects
  audit::Grade as;             // of the certificate that `mortise run` would write
  // A row with the costs filled in; value and error are NaN when the run did not converge, whatever was reported before.
  Row row(const std::string& name, const Method& method, const std::string& quantity, double value, double reference, double error,
          double gate) const;
};

// Runs all steps of a scene on the chosen device. `prepare` may exchange meshes before the engine sees them; `each` is called after every step.
// Throws Error for all but steps that do not converge.
Solved solve(const SceneText& scene, const std::function<void(model::ModelInput&)>& prepare = {},
             const std::function<void(const Snapshot&)>& each = {});

// The same for a scene that was read; paths in it hold.
Solved solve(const scene::Scene& scene, const std::function<void(model::ModelInput&)>& prepare = {},
             const std::function<void(const Snapshot&)>& each = {});

// Gives a body this mesh, placed as it is (world coordinates).
void set_mesh(model::ModelInput& input, const std::string& body, const geometry::TetMesh& mesh);

}  // namespace mortise::bench
