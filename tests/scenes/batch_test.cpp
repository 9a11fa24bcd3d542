// Several environments in one model: each has the bits that it has alone, whatever the others do.
#include <bit>
#include <set>

#include "base/memory_archive.h"
#include "base/snapshot.h"
#include "engine/join.h"
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// One environment's part of a batch: the same scene with values of its own for bodies and materials.
struct Environment {
  std::vector<std::string> overrides;
  bool fails = false;  // alone; in a batch it is given up, and the others go on
};

model::ModelInput batch(const std::string& yaml, const std::vector<std::string>& common, const std::vector<Environment>& envs) {
  std::vector<model::ModelInput> all;
  for (const Environment& e : envs) {
    std::vector<std::string> overrides = common;
    overrides.insert(overrides.end(), e.overrides.begin(), e.overrides.end());
    all.push_back(engine::make_input(scene::read_scene_text(yaml, "batch.yaml", overrides, engine::effect_tables()).root));
  }
  std::vector<const model::ModelInput*> inputs;
  for (const model::ModelInput& one : all) inputs.push_back(&one);
  return engine::join(inputs);
}

// Positions after every step, up to the first that fails.
struct Run {
  std::vector<std::vector<double>> points;
  std::string failure;
};
Run run(const model::ModelInput& input, int steps) {
  std::unique_ptr<engine::Engine> engine;
  Rig::check(engine::chosen().api->create(input, engine));
  Run out;
  for (int i = 0; i < steps; ++i) {
    solver::StepReport report;
    const engine::Outcome outcome = engine->step({}, report);
    if (outcome.code != 0) {
      out.failure = outcome.message;
      return out;
    }
    out.points.push_back(engine->points());
  }
  return out;
}

// steps: of the batch; the environments' own points are compared after each.
void expect_alone(const std::string& yaml, const std::vector<std::string>& common, const std::vector<Environment>& envs, int steps,
                  const std::string& what) {
  const Run together = run(batch(yaml, common, envs), steps);
  ASSERT_EQ(together.failure, "") << what;
  std::size_t first = 0;
  for (std::size_t e = 0; e < envs.size(); ++e) {
    const Run alone = run(batch(yaml, common, {envs[e]}), steps);
    ASSERT_EQ(alone.failure != "", envs[e].fails) << what << ", environment " << e << " alone: " << alone.failure;
    const std::size_t n = together.points[0].size() / envs.size();
    for (int i = 0; i < steps && !envs[e].fails; ++i) {
      const std::vector<double> part(together.points[i].begin() + first, together.points[i].begin() + first + n);
      EXPECT_EQ(part, alone.points[i]) << what << ", environment " << e << ", step " << i;
    }
    first += n;
  }
}

// Stiff bodies have no stress: NaN.
std::map<std::string, std::vector<std::uint64_t>> bits(const std::map<std::string, Snapshot::Values>& fields) {
  std::map<std::string, std::vector<std::uint64_t>> out;
  for (const auto& [name, values] : fields)
    for (double v : values) out[name].push_back(std::bit_cast<std::uint64_t>(v));
  return out;
}

// What each is told of itself after every step, its iterations, and its state, against what it is told alone.
struct Told {
  Index substeps = 0;
  std::set<double> stiffness;  // of the block's contact with the pad, after every step
  double guard = 0;            // the largest share of the force that mortar's guard bore
};
std::vector<Told> expect_told_alone(const std::string& scene, const std::vector<std::string>& common, const std::vector<Environment>& envs, int steps,
                                    const std::string& what) {
  std::vector<Told> out(envs.size());
  std::unique_ptr<engine::Engine> together;
  Rig::check(engine::chosen().api->create(batch(scene, common, envs), together));
  std::vector<std::unique_ptr<engine::Engine>> alone(envs.size());
  for (std::size_t e = 0; e < envs.size(); ++e) Rig::check(engine::chosen().api->create(batch(scene, common, {envs[e]}), alone[e]));
  for (int step = 0; step <= steps; ++step) {
    std::vector<Snapshot> seen(envs.size());
    std::vector<FieldSink*> sinks;
    for (Snapshot& s : seen) sinks.push_back(&s);
    std::vector<solver::StepReport> reports(envs.size());
    if (step > 0) Rig::check(together->step({}, reports));
    together->report(FieldSinks(sinks));
    std::vector<MemoryArchive> saved(envs.size());
    std::vector<Archive*> archives;
    for (MemoryArchive& a : saved) archives.push_back(&a);
    Rig::check(together->checkpoint(archives));
    for (std::size_t e = 0; e < envs.size(); ++e) {
      const std::string where = what + ", environment " + std::to_string(e) + ", step " + std::to_string(step);
      Snapshot own;
      solver::StepReport report;
      if (step > 0) Rig::check(alone[e]->step({}, report));
      alone[e]->report(own);
      EXPECT_EQ(seen[e].number, own.number) << where;
      EXPECT_EQ(seen[e].row, own.row) << where;
      EXPECT_EQ(seen[e].point, own.point) << where;
      EXPECT_EQ(bits(seen[e].cell), bits(own.cell)) << where;
      EXPECT_EQ(reports[e].newton, report.newton) << where;
      EXPECT_EQ(reports[e].substeps, report.substeps) << where;
      EXPECT_EQ(reports[e].residual, report.residual) << where;
      EXPECT_EQ(reports[e].energy, report.energy) << where;
      MemoryArchive of_alone;
      Rig::check(alone[e]->checkpoint(of_alone));
      EXPECT_EQ(saved[e].data(), of_alone.data()) << where;
      out[e].substeps += report.substeps;
      const auto stiffness = own.number.find("mortar_contact/stiffness_pad_block");
      if (stiffness != own.number.end()) out[e].stiffness.insert(stiffness->second);
      const auto guard = own.number.find("mortar_contact/force_share_guard");
      if (guard != own.number.end()) out[e].guard = std::max(out[e].guard, guard->second);
    }
  }
  return out;
}

// A block that slides on a pad, and a stone that falls on the floor beside it.
constexpr const char* kSlide = R"(
mortise: 1
name: slide
time: {step: 4 ms, steps: 3}
materials:
  gel: {model: neo_hookean, youngs_modulus: 0.2 MPa, poisson_ratio: 0.4, density: 1000}
  rubber: {model: neo_hookean, youngs_modulus: 1 MPa, poisson_ratio: 0.4, density: 1200}
bodies:
  pad: {type: soft, shape: {box: {size: [60 mm, 40 mm, 10 mm], edge_length: 10 mm}}, material: gel, position: [0, 0, -5 mm]}
  block: {type: soft, shape: {box: {size: [20 mm, 20 mm, 10 mm], edge_length: 7 mm}}, material: rubber, position: [0, 0, 5.5 mm], velocity: [0.2, 0, -0.2]}
  stone: {type: stiff, shape: {box: {size: [10 mm, 10 mm, 10 mm], edge_length: 10 mm}}, material: rubber, position: [60 mm, 0, -5.5 mm], velocity: [0.1, 0, -0.3]}
  floor: {type: half_space, point: [0, 0, -11.5 mm]}
effects:
  inertia: {}
  gravity: {acceleration: [0, 0, -9.81]}
  elasticity: {}
  affine_body: {stiffness: 10 MPa}
  pin: [{body: pad, where: {side: z_min}}]
  barrier_contact: {d_hat: 1 mm, stiffness: 50 kPa}
  friction: {follows: barrier_contact, mu: 0.4, creep_speed: 1 mm/s}
)";
// The same with mortar contact.
std::string with_mortar(std::string text) {
  const auto replace = [&](const std::string& from, const std::string& to) { text.replace(text.find(from), from.size(), to); };
  replace("barrier_contact: {d_hat: 1 mm, stiffness: 50 kPa}",
          "mortar_contact: {d_hat: 1 mm, pairs: [{slave: pad, master: block}, {slave: stone, master: floor}]}");
  replace("follows: barrier_contact", "follows: mortar_contact");
  return text;
}
const std::vector<Environment> kEnvironments{{{}},
                                             {{"bodies.block.velocity=[0.5, 0.1, -0.6]", "materials.rubber.youngs_modulus=0.3 MPa"}},
                                             {{"bodies.block.position=[2 mm, 1 mm, 30 mm]", "bodies.stone.velocity=[0, 0, -1]"}}};

}  // namespace

TEST(Batch, FrictionWithEveryLinearSolver) {
  for (const char* linear : {"direct", "reuse", "cg"}) expect_alone(kSlide, {std::string("solver.linear=") + linear}, kEnvironments, 3, linear);
}

TEST(Batch, SchwarzPreconditioner) { expect_alone(kSlide, {"solver.linear=cg", "solver.preconditioner=mas"}, kEnvironments, 2, "mas"); }

TEST(Batch, MortarContactWithFriction) {
  for (const char* linear : {"direct", "reuse", "cg"})
    expect_alone(with_mortar(kSlide), {std::string("solver.linear=") + linear}, kEnvironments, 3, std::string("mortar, ") + linear);
}

// Samples of the guard among those of the pressure field: in environments that have some, and beside such.
TEST(Batch, MortarContactWhoseGuardRubs) {
  const std::vector<std::string> guarded{"effects.mortar_contact.guard=1", "effects.mortar_contact.stiffness=50 kPa"};
  const std::vector<Told> told = expect_told_alone(with_mortar(kSlide), guarded, kEnvironments, 4, "guard");
  EXPECT_GT(told[0].guard, 0.1);
  for (const char* linear : {"direct", "cg"}) {
    std::vector<std::string> common = guarded;
    common.push_back(std::string("solver.linear=") + linear);
    expect_alone(with_mortar(kSlide), common, kEnvironments, 3, std::string("guard, ") + linear);
  }
}

// Few iterations: some environments have to halve their steps, each by itself.
TEST(Batch, EveryEnvironmentCutsItsStepsByItself) {
  const std::vector<std::string> few{"solver.iterations=10", "effects.friction.lag_iterations=1", "solver.linear=direct"};
  const auto substeps = [&](const Environment& e) {
    std::unique_ptr<engine::Engine> engine;
    Rig::check(engine::chosen().api->create(batch(kSlide, few, {e}), engine));
    Index n = 0;
    for (int i = 0; i < 3; ++i) {
      solver::StepReport report;
      Rig::check(engine->step({}, report));
      n += report.substeps;
    }
    return n;
  };
  Index least = 1000, most = 0;
  for (const Environment& e : kEnvironments) least = std::min(least, substeps(e)), most = std::max(most, substeps(e));
  EXPECT_LT(least, most) << "they have to differ for this test to mean something";
  expect_alone(kSlide, few, kEnvironments, 3, "halving");
  // BDF2 knows the length of the last step.
  std::string bdf2 = kSlide;
  bdf2.replace(bdf2.find("inertia: {}"), 11, "inertia: {integrator: bdf2}");
  std::vector<std::string> more = few;
  more[1] = "effects.friction.lag_iterations=2";  // its first parts are the smallest that there are
  expect_alone(bdf2, more, kEnvironments, 3, "halving, BDF2");
}

// Ways of what turns far are arcs, and those of environments in which nothing does stay straight: a ball that rolls against a pad, one that only
// stands, one that is thrown spinning, and one that tumbles far beyond an arc.
TEST(Batch, WhatTurnsGoesOnItsOwnArc) {
  const std::string scene = R"(
mortise: 1
name: arcs
time: {step: 5 ms, steps: 12}
materials:
  gel: {youngs_modulus: 0.3 MPa, poisson_ratio: 0.45, density: 1050}
  steel: {density: 7850}
bodies:
  pad: {type: soft, shape: {box: {size: [8 mm, 20 mm, 20 mm], edge_length: 5 mm}}, material: gel, position: [-15 mm, 0, 15 mm]}
  ball: {type: stiff, shape: {sphere: {radius: 10 mm, edge_length: 5 mm}}, material: steel, position: [0, 0, 10.05 mm]}
  floor: {type: half_space}
effects:
  inertia: {}
  gravity: {}
  elasticity: {}
  affine_body: {}
  pin: [{body: pad, where: {side: x_min}, motion: {time: [0, 0.3], translation: [[0, 0, 0], [60 mm, 0, 0]]}}]
  barrier_contact: {}
  friction: {follows: barrier_contact, mu: 0.5}
)";
  const std::string ball = "bodies.ball.";
  expect_alone(scene, {},
               {{{}},
                {{ball + "position=[0.5, 0, 0.01005]"}},
                {{ball + "position=[0, 0, 0.1]", ball + "angular_velocity=[30, 40, 0]"}},
                {{ball + "position=[0, 0, 0.1]", ball + "angular_velocity=[300, 400, 0]"}}},
               12, "arcs");
}

// One block is shot at the pad: no step is short enough. The others never notice.
TEST(Batch, OneThatFailsIsGivenUpAlone) {
  std::vector<Environment> envs = kEnvironments;
  envs[1] = {{"bodies.block.velocity=[0, 0, -20000]"}, true};
  for (const char* linear : {"direct", "reuse", "cg"})
    expect_alone(kSlide, {std::string("solver.linear=") + linear, "solver.iterations=12", "effects.friction.lag_iterations=2", "solver.halvings=0"},
                 envs, 3, std::string("failure, ") + linear);
}

// Numbers of effects, and the radius and stiffness that contact chooses from mesh and material, are those of each environment, and it is told what it
// would be told alone: fields, samples with the numbers that bodies have alone, scalars, its own count of iterations.
TEST(Batch, EveryEnvironmentHasItsNumbersAndReports) {
  std::string left_open = kSlide;
  left_open.replace(left_open.find("{d_hat: 1 mm, stiffness: 50 kPa}"), 32, "{}");
  std::vector<Environment> envs = kEnvironments;
  envs[0].overrides = {"effects.friction.mu=0.1", "effects.gravity.acceleration=[0, 1, -5]",
                       "bodies.block.rotation={axis: [0, 0, 1], angle: 13 deg}"};
  envs[1].overrides.insert(envs[1].overrides.end(), {"effects.friction.creep_speed=2 mm/s", "effects.affine_body.stiffness=20 MPa"});
  for (const std::string& scene : {std::string(kSlide), left_open, with_mortar(kSlide)}) expect_told_alone(scene, {}, envs, 2, "numbers");
}

// Some cut their steps, each by itself, while contact chooses its stiffness from step to step and the others wait for them: what a wait or a
// neighbour's parts of a step change is neither state nor what is told of it, samples included.
TEST(Batch, AutomaticStiffnessWhileOthersCutTheirSteps) {
  const std::vector<std::string> few{"solver.iterations=4", "effects.friction.lag_iterations=1", "solver.linear=direct"};
  std::string barrier = kSlide, layer = with_mortar(kSlide);
  barrier.replace(barrier.find("{d_hat: 1 mm, stiffness: 50 kPa}"), 32, "{}");
  for (const std::string& scene : {barrier, layer}) {
    const bool mortar = scene == layer;
    const std::vector<Told> told = expect_told_alone(scene, few, kEnvironments, 10, mortar ? "mortar" : "barrier");
    const auto less = [](const Told& a, const Told& b) { return a.substeps < b.substeps; };
    EXPECT_LT(std::min_element(told.begin(), told.end(), less)->substeps, std::max_element(told.begin(), told.end(), less)->substeps)
        << "they have to differ for this test to mean something";
    EXPECT_EQ(mortar, std::any_of(told.begin(), told.end(), [](const Told& t) { return t.stiffness.size() > 1; })) << "and so has the stiffness";
  }
}

// An environment that comes later has a clock of its own, and those that were there go on from where they were.
TEST(Batch, EnvironmentsMayBeginAtAnyTime) {
  std::string driven = kSlide;
  driven.replace(driven.find("{body: pad, where: {side: z_min}}"), 33,
                 "{body: pad, where: {side: z_min}, motion: {time: [0, 30 ms], translation: [[0, 0, 0], [1 mm, 0, 0.5 mm]]}}");
  std::unique_ptr<engine::Engine> first, both;
  Rig::check(engine::chosen().api->create(batch(driven, {}, {kEnvironments[0]}), first));
  solver::StepReport report;
  Rig::check(first->step({}, report));
  Rig::check(first->step({}, report));
  MemoryArchive state;
  Rig::check(first->checkpoint(state));
  state.rewind();
  Rig::check(engine::chosen().api->create(batch(driven, {}, {kEnvironments[1], kEnvironments[0]}), both));
  Rig::check(both->checkpoint({nullptr, &state}));
  EXPECT_EQ(both->steps_done(0), 0);
  EXPECT_EQ(both->steps_done(1), 2);
  const ::Run alone = run(batch(driven, {}, {kEnvironments[1]}), 2), before = run(batch(driven, {}, {kEnvironments[0]}), 4);
  for (int step = 0; step < 2; ++step) {
    std::vector<solver::StepReport> reports(2);
    Rig::check(both->step({}, reports));
    const std::vector<double> all = both->points();
    const auto half = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    EXPECT_EQ(std::vector<double>(all.begin(), half), alone.points[step]);
    EXPECT_EQ(std::vector<double>(half, all.end()), before.points[step + 2]);
  }
  EXPECT_EQ(both->time(0), 2 * 4e-3);
  EXPECT_EQ(both->time(1), 4 * 4e-3);
  // One that rests stands still.
  both->rest(0);
  const std::vector<double> there = both->points();
  std::vector<solver::StepReport> reports(2);
  Rig::check(both->step({}, reports));
  const std::vector<double> then = both->points();
  const auto half = static_cast<std::ptrdiff_t>(there.size() / 2);
  EXPECT_TRUE(std::equal(there.begin(), there.begin() + half, then.begin()));
  EXPECT_FALSE(std::equal(there.begin() + half, there.end(), then.begin() + half));
  EXPECT_EQ(both->steps_done(0), 2);
  EXPECT_EQ(both->steps_done(1), 5);
}
