// Effects that the program does not know by name get everything that those get which it comes with: nobody asks for names.
#include <fmt/format.h>

#include "audit/certificate.h"
#include "audit/checks.h"
#include "base/pass_on.h"
#include "effects/list.h"
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;
using effects::Effect;
using effects::Kind;
using effects::Linearisation;
using effects::Positions;
using effects::StepInfo;

namespace {

// What an effect reports under its name, under another one.
class Renamed : public PassOn {
 public:
  Renamed(FieldSink& next, std::string_view from, std::string_view to) : PassOn(&next), from_(from), to_(to) {}
  void rows(std::string_view group, std::string_view name, std::string_view unit, int components, std::span<const double> v) override {
    PassOn::rows(group == from_ ? to_ : group, name, unit, components, v);
  }
  void scalar(std::string_view group, std::string_view name, std::string_view unit, double v) override {
    PassOn::scalar(group == from_ ? to_ : group, name, unit, v);
  }

 private:
  std::string_view from_, to_;
};

// A known effect under a name of its own: `my_x` is x.
class Own final : public Effect {
 public:
  Own(const Kind& kind, std::unique_ptr<Effect> known, model::Model& model) : kind_(kind), known_(std::move(known)) {
    if (kind.role == effects::Role::contact) model.add_contact(kind.name);
  }
  const Kind& kind() const override { return kind_; }
  void connect() override { known_->connect(); }
  void begin_step(const StepInfo& info) override { known_->begin_step(info); }
  std::unique_ptr<Linearisation> linearisation() const override { return known_->linearisation(); }
  void linearise(Positions q, effects::Want want, Linearisation& at) override { known_->linearise(q, want, at); }
  void sample(Linearisation& at) override { known_->sample(at); }
  void energy(Positions q, const Linearisation& at, device::EnvValues out) override { known_->energy(q, at, out); }
  void max_step(device::View<const Vec3> dq, Linearisation& at, device::EnvValues alpha) override { known_->max_step(dq, at, alpha); }
  void reach(Linearisation& at) override { known_->reach(at); }
  bool loses_energy() const override { return known_->loses_energy(); }
  Positions carried() const override { return known_->carried(); }
  void end_step(const StepInfo& info, Positions q, const Linearisation& at) override { known_->end_step(info, q, at); }
  void report(const FieldSinks& sinks, const Linearisation& at) override {
    Renamed renamed(sinks[0], known_->name(), name());
    known_->report(renamed, at);
  }
  void checkpoint(Archive& archive) override { known_->checkpoint(archive); }

 private:
  const Kind& kind_;
  std::unique_ptr<Effect> known_;
};

template <const char* (*known)()>
std::unique_ptr<Effect> make(const Params& p, model::Model& m) {
  const std::string own = std::string("my_") + known();
  return std::make_unique<Own>(*effects::find_kind(own), effects::find_kind(known())->make(p, m), m);
}
const char* inertia() { return "inertia"; }
const char* barrier() { return "barrier_contact"; }

void add_own() {
  static const bool done = [] {
    const auto own = [](const char* name, const char* of, auto make) {
      Kind kind = *effects::find_kind(of);
      kind.name = name, kind.make = make;
      return kind;
    };
    static const Kind kinds[] = {own("my_inertia", "inertia", make<inertia>), own("my_barrier_contact", "barrier_contact", make<barrier>)};
    for (const Kind& k : kinds) effects::add(k);
    return true;
  }();
  (void)done;
}

std::string scene_text(const std::string& my) {
  return R"(
mortise: 1
name: own
time: {step: 4 ms, steps: 4}
materials:
  gel: {model: neo_hookean, youngs_modulus: 0.2 MPa, poisson_ratio: 0.4, density: 1000}
bodies:
  block: {type: soft, shape: {box: {size: [20 mm, 20 mm, 10 mm], edge_length: 7 mm}}, material: gel, position: [0, 0, 6 mm], velocity: [0, 0, -0.4]}
  floor: {type: half_space}
effects:
  )" + my +
         R"(inertia: {}
  elasticity: {}
  )" + my +
         R"(barrier_contact: {d_hat: 2 mm, stiffness: 1 kPa}
checks:
  - {quantity: kinetic_energy, above: 0 J}
  - {quantity: min_distance, above: 0 m}
  - {quantity: contact_force, body: block, axis: z, when: end, above: 0.1 N}
  - {quantity: energy_gain, below: 1e-3}
  - {quantity: velocity, body: block, axis: z, when: end, below: 1 m/s}
)";
}

struct Result {
  std::vector<double> points;
  std::map<std::string, double> number;
  std::string certificate;
  std::vector<std::string> verdicts;
  std::map<std::string, std::vector<std::string>> kernels;
  Index newton = 0;
};

std::string without_my(std::string s) {
  for (std::size_t at; (at = s.find("my_")) != std::string::npos;) s.erase(at, 3);
  return s;
}

Result result(const std::string& my) {
  Rig rig(scene_text(my));
  audit::Certificate certificate(rig.input);
  audit::Checks checks(rig.input);
  Result out;
  for (int i = 0; i < 4; ++i) {
    out.newton += rig.step().newton;
    Snapshot said;
    rig.engine->report(said);
    certificate.state(said);
    out.certificate = without_my(certificate.json({"own", "", "", Exit::done, "", checks.state(said, rig.engine->points())}));
  }
  out.points = rig.engine->points();
  for (const auto& [name, v] : rig.fields().number) out.number[without_my(name)] = v;
  for (const audit::Checks::Verdict& v : checks.verdicts(Exit::done, "")) {
    EXPECT_FALSE(std::isnan(v.value)) << v.text << " was not measured";
    out.verdicts.push_back(fmt::format("{} {} {}", v.text, v.pass, v.value));
  }
  for (const engine::PlanItem& item : rig.engine->plan()) out.kernels[without_my(item.effect)] = item.kernels;
  return out;
}

}  // namespace

TEST(OwnEffect, GetsEverythingUnderAnyName) {
  add_own();
  const Result known = result(""), own = result("my_");
  EXPECT_EQ(own.points, known.points);
  EXPECT_EQ(own.newton, known.newton);
  EXPECT_EQ(own.number, known.number);
  EXPECT_TRUE(own.number.count("supports/work")) << "the energy guard measures";
  EXPECT_EQ(own.verdicts, known.verdicts);
  EXPECT_EQ(own.kernels, known.kernels);
  EXPECT_EQ(own.certificate, known.certificate);
}
