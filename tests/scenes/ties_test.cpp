// Joints and bonds by elimination: pendulums against rigid bodies' equations, chains, forces through ties, batches and resumed runs.
#include <fmt/format.h>

#include "audit/state_audit.h"
#include "rig.h"
#include "scene/pass_through.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

constexpr double kG = 9.81;

// Boxes of a * a * c in a row along x from the origin, joined by hinges about y at their ends; the last may be heavier. `first`: what
// the first hangs on.
std::string chain(int links, double heavy, const std::string& first, double dt_ms, const std::string& integrator = "backward_euler",
                  const std::string& more = "") {
  std::string bodies, joints;
  for (int i = 0; i < links; ++i) {
    bodies += fmt::format(
        "  link{}: {{type: stiff, shape: {{box: {{size: [100 mm, 20 mm, 20 mm], edge_length: 100 mm}}}}, material: {}, position: [{} mm, 0, 0]}}\n",
        i, i + 1 == links ? "end" : "link", 50 + 100 * i);
    if (i > 0) joints += fmt::format("    - {{type: revolute, body: link{}, to: link{}, at: [{} mm, 0, 0], axis: [0, 1, 0]}}\n", i, i - 1, 100 * i);
  }
  return fmt::format(R"(
mortise: 1
name: chain
time: {{step: {} ms, steps: 1000}}
materials: {{link: {{density: 1000}}, end: {{density: {}}}}}
bodies:
{}effects:
  inertia: {{integrator: {}}}
  gravity: {{acceleration: [0, 0, -9.81]}}
  affine_body: {{stiffness: 1 GPa}}
  joint:
{}{}{})",
                     dt_ms, 1000 * heavy, bodies, integrator, first.empty() ? "" : "    - {" + first + "}\n", joints, more);
}
const std::string kHung = "type: revolute, body: link0, at: [0, 0, 0], axis: [0, 1, 0]";

// The turn about y of a link from what it was at the start: positive from x to -z.
double angle(Rig& rig, int link) {
  const std::vector<double> now = rig.engine->points();
  std::size_t first = 0;
  for (int i = 0; i < link; ++i) first += rig.input.bodies[i].nodes.size();
  const std::vector<Vec3>& rest = rig.input.bodies[link].nodes;
  Mat3 from = Mat3::Zero(), to = Mat3::Zero();
  const Vec3 x0(now[3 * first], now[3 * first + 1], now[3 * first + 2]);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const Vec3 d = rest[i] - rest[0], e = Vec3(now[3 * (first + i)], now[3 * (first + i) + 1], now[3 * (first + i) + 2]) - x0;
    from += d * d.transpose(), to += e * d.transpose();
  }
  const Mat3 A = to * from.inverse();
  return std::atan2(-A(2, 0), A(0, 0));
}

// Angles of two links of length l that hang on each other, from the horizontal downwards, by their Lagrangian equations; classical Runge-Kutta.
struct Links {
  double m1, m2, l = 0.1, inertia1, inertia2;
  using State = std::array<double, 4>;  // angles and their rates
  Links(double mass1, double mass2)
      : m1(mass1), m2(mass2), inertia1(mass1 * (0.1 * 0.1 + 0.02 * 0.02) / 12), inertia2(mass2 * (0.1 * 0.1 + 0.02 * 0.02) / 12) {}
  State rate(const State& s) const {
    const double h = l / 2, c = std::cos(s[0] - s[1]), sn = std::sin(s[0] - s[1]);
    const double a11 = m1 * h * h + inertia1 + m2 * l * l, a12 = m2 * l * h * c, a22 = m2 * h * h + inertia2;
    const double b1 = -m2 * l * h * sn * s[3] * s[3] + (m1 * h + m2 * l) * kG * std::cos(s[0]),
                 b2 = m2 * l * h * sn * s[2] * s[2] + m2 * h * kG * std::cos(s[1]);
    const double det = a11 * a22 - a12 * a12;
    return {s[2], s[3], (a22 * b1 - a12 * b2) / det, (a11 * b2 - a12 * b1) / det};
  }
  State at(double t) const {
    State s{};
    const int n = 20000;
    const double dt = t / n;
    const auto plus = [](const State& a, const State& b, double w) {
      State out;
      for (int k = 0; k < 4; ++k) out[k] = a[k] + w * b[k];
      return out;
    };
    for (int i = 0; i < n; ++i) {
      const State k1 = rate(s), k2 = rate(plus(s, k1, dt / 2)), k3 = rate(plus(s, k2, dt / 2)), k4 = rate(plus(s, k3, dt));
      for (int k = 0; k < 4; ++k) s[k] += dt / 6 * (k1[k] + 2 * k2[k] + 2 * k3[k] + k4[k]);
    }
    return s;
  }
};

}  // namespace

// A link on a hinge, from the horizontal, by BDF2: the error is that of the integrator and falls with the square of the step.
TEST(Joints, CompoundPendulum) {
  // I theta'' = m g l/2 cos(theta),   I = m (l^2 / 3 + a^2 / 12) about the hinge; by semi-implicit Euler in steps of 0.1 us.
  const double I = 0.1 * 0.1 / 3 + (0.02 * 0.02) / 12, T = 0.2;
  double theta = 0, rate = 0;
  constexpr int n = 2000000;
  for (int i = 0; i < n; ++i) rate += T / n * kG * 0.05 * std::cos(theta) / I, theta += T / n * rate;
  double error[2];
  for (int k = 0; k < 2; ++k) {
    Rig rig(chain(1, 1, kHung, k == 0 ? 4 : 1, "bdf2"));
    rig.steps(k == 0 ? 50 : 200);
    error[k] = std::abs(angle(rig, 0) - theta);
  }
  EXPECT_GT(theta, 1.5);
  EXPECT_LT(error[1], 1e-3);
  EXPECT_LT(error[1], error[0] / 8);
}

TEST(Joints, DoublePendulum) {
  for (double heavy : {1.0, 100.0}) {
    const Links::State exact = Links(0.04, 0.04 * heavy).at(0.3);
    double error[2];
    for (int k = 0; k < 2; ++k) {
      const double dt = k == 0 ? 2 : 1;
      Rig rig(chain(2, heavy, kHung, dt, "bdf2"));
      rig.steps(static_cast<int>(std::lround(300 / dt)));
      error[k] = std::max(std::abs(std::remainder(angle(rig, 0) - exact[0], 2 * M_PI)), std::abs(std::remainder(angle(rig, 1) - exact[1], 2 * M_PI)));
    }
    EXPECT_LT(error[1], 5e-3) << heavy << ": " << exact[0] << " " << exact[1];
    EXPECT_LT(error[1], error[0] / 3) << heavy;  // second order
  }
}

// The joints of a swinging chain are exact, whatever the step and the masses.
TEST(Joints, OfAChainHold) {
  for (double heavy : {1.0, 1e4})
    for (double dt : {1.0, 20.0}) {
      Rig rig(chain(10, heavy, kHung, dt));
      double worst = 0;
      for (int i = 0; i < 20; ++i) {
        rig.step();
        worst = std::max(worst, rig.fields().at("joint/tie_error"));
      }
      EXPECT_LT(worst, 1e-14) << heavy << " " << dt;
      EXPECT_GT(std::abs(angle(rig, 0)), 1e-3);
    }
}

// A chain that hangs straight: every joint bears what is below it, the first all of it, and the world feels that.
TEST(Joints, BearWhatHangsOnThem) {
  for (const char* linear : {"direct", "reuse", "cg"}) {
    Rig rig(chain(4, 50, "type: spherical, body: link0, at: [0, 0, 0]", 5),
            {"effects.gravity.acceleration=[9.81, 0, 0]", std::string("solver.linear=") + linear});
    rig.steps(10);  // the links have a strain of 1e-6, which has to come to rest
    const Captured f = rig.fields();
    const double link = 1000 * 0.1 * 0.02 * 0.02 * kG, weight = 53 * link;
    for (int i = 0; i < 4; ++i) {
      const std::string name = i == 0 ? "link0_world" : fmt::format("link{}_link{}", i, i - 1);
      EXPECT_LT((vector(f, "joint/" + name + "_force_") + Vec3(weight - i * link, 0, 0)).norm(), 1e-7 * weight) << linear << " " << name;
      EXPECT_LT((vector(f, "joint/" + name + "_place_") - Vec3(0.1 * i, 0, 0)).norm(), 1e-5);
      EXPECT_LT(vector(f, "joint/" + name + "_moment_").norm(), 1e-7 * weight * 0.1);
    }
    // Newton's first law with the world's share, to rounding: what residual is left is left in both.
    EXPECT_LT((vector(f, "balance/joint_") - vector(f, "joint/link0_world_force_")).norm(), 1e-12 * weight);
    EXPECT_LT(vector(f, "balance/defect_").norm(), 1e-7 * weight);
  }
}

// A hinge holds what would turn its body about other axes: a link that sticks out along x from a hinge about z.
TEST(Joints, BearMoments) {
  Rig rig(chain(1, 1, "name: bearing, type: revolute, body: link0, at: [0, 0, 0], axis: [0, 0, 1]", 5));
  rig.steps(3);
  const Captured f = rig.fields();
  const double weight = 1000 * 0.1 * 0.02 * 0.02 * kG;
  EXPECT_LT((vector(f, "joint/bearing_force_") - Vec3(0, 0, weight)).norm(), 1e-6 * weight);
  EXPECT_LT((vector(f, "joint/bearing_moment_") - Vec3(0, -weight * 0.05, 0)).norm(), 1e-6 * weight * 0.05);
}

// A chain that flies: its joints do not push it as a whole, and make no energy.
TEST(Joints, KeepMomentumAndEnergy) {
  const std::string velocity = ", velocity: [0.3, 0.1, -0.2]";
  std::string scene = chain(3, 20, "", 5);
  scene.replace(scene.find("position: [50 mm, 0, 0]"), 23, "position: [50 mm, 0, 0]" + velocity + ", angular_velocity: [0, 6, 0]");
  Rig rig(scene, {"effects.gravity.acceleration=[0, 0, 0]"});
  rig.step();
  Captured before = rig.fields();
  const Vec3 p = vector(before, "inertia/momentum_");
  EXPECT_GT(p.norm(), 0.1);
  audit::EnergyAudit audit(rig.input);
  for (int i = 0; i < 60; ++i) {
    rig.step();
    const Captured now = rig.fields();
    EXPECT_LT((vector(now, "inertia/momentum_") - p).norm(), 1e-9 * p.norm());
    const std::vector<double> points = rig.engine->points();
    audit.state({now, points});
    before = now;
  }
  EXPECT_LT(audit.result().largest_gain, 1e-9 * audit.result().scale);
  EXPECT_TRUE(audit.result().work_is_known);
  EXPECT_GT(std::abs(angle(rig, 0) - angle(rig, 1)), 0.3);
  EXPECT_LT(before.at("balance/joint_x"), 1e-9);
}

namespace {

// A plate that is pinned or moved, turned against the axes, with a pad of poisson's ratio 0 bonded under it; the pad's other side is bonded to a
// second plate.
std::string sandwich(const std::string& effects, const std::string& mode = "mode: static, steps: 2") {
  return fmt::format(R"(
mortise: 1
name: sandwich
time: {{{}}}
materials: {{gel: {{model: linear, youngs_modulus: 0.1 MPa, poisson_ratio: 0, density: 1000}}, steel: {{density: 7800}}}}
bodies:
  top: {{type: stiff, shape: {{cylinder: {{radius: 20 mm, height: 5 mm, edge_length: 7 mm}}}}, material: steel, position: [3 mm, 1 mm, 12 mm]}}
  pad: {{type: soft, shape: {{cylinder: {{radius: 12 mm, height: 10 mm, edge_length: 4 mm}}}}, material: gel, position: [0, 0, 4.5 mm]}}
  base: {{type: stiff, shape: {{box: {{size: [50 mm, 40 mm, 6 mm], edge_length: 20 mm}}}}, material: steel, rotation: {{axis: [0, 0, 1], angle: 20 deg}}, position: [1 mm, 0, -3.5 mm]}}
effects:
  elasticity: {{}}
  affine_body: {{stiffness: 1 GPa}}
{})",
                     mode, effects);
}
const std::string kBonds = R"(  bond:
    - {body: pad, where: {side: z_max}, to: top}
    - {body: pad, where: {side: z_min}, to: base}
)";

}  // namespace

// Compressed by 1 % between plates that it is bonded to without a matching vertex, the pad is strained evenly; the bonds hand on its force.
TEST(Bonds, PassThePatchTest) {
  Rig rig(sandwich(kBonds + R"(  pin:
    - {body: base, where: {side: all}}
    - {body: top, where: {side: all}, motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, -0.1 mm]]}}
)"));
  rig.steps(2);
  const Captured f = rig.fields();
  const std::vector<double>& u = *f.of_points("displacement", 3);
  const std::size_t first = rig.input.bodies[0].nodes.size();
  const std::vector<Vec3>& rest = rig.input.bodies[1].nodes;
  double worst = 0, lo = INFINITY, hi = -INFINITY;
  for (const Vec3& x : rest) lo = std::min(lo, x[2]), hi = std::max(hi, x[2]);
  for (std::size_t i = 0; i < rest.size(); ++i)
    worst = std::max(
        worst, (Vec3(u[3 * (first + i)], u[3 * (first + i) + 1], u[3 * (first + i) + 2]) - Vec3(0, 0, -1e-4 * (rest[i][2] - lo) / (hi - lo))).norm());
  EXPECT_LT(worst, 1e-10 * 1e-4);
  const Vec3 upper = vector(f, "bond/pad_top_force_"), lower = vector(f, "bond/pad_base_force_");
  EXPECT_LT(upper[2], -0.4);
  EXPECT_LT((upper + lower).norm(), 1e-10 * upper.norm());
  // What the supports of the plates bear.
  EXPECT_LT((vector(f, "supports/top_") - upper).norm(), 1e-10 * upper.norm());
  EXPECT_LT((vector(f, "supports/base_") - lower).norm(), 1e-10 * upper.norm());
  EXPECT_LT(f.at("supports/top_defect"), 1e-10 * upper.norm());
  EXPECT_LT(vector(f, "balance/defect_").norm(), 1e-10 * upper.norm());
  // And node by node.
  const std::vector<double>& force = *f.of_points("tie_force", 3);
  Vec3 sum = Vec3::Zero(), above = Vec3::Zero();
  for (std::size_t i = 0; i < force.size() / 3; ++i) {
    const Vec3 v(force[3 * i], force[3 * i + 1], force[3 * i + 2]);
    sum += v;
    if (i >= first && i < first + rest.size() && rest[i - first][2] > 5e-3) above += v;
  }
  EXPECT_LT(sum.norm(), 1e-10 * upper.norm());
  EXPECT_LT((above - upper).norm(), 1e-10 * upper.norm());
  EXPECT_LT(f.at("bond/tie_error"), 1e-16);
  // The moment about the middle of the bond: none but what the mesh makes of an even pressure.
  EXPECT_LT(vector(f, "bond/pad_top_moment_").norm(), 1e-3 * upper.norm() * 12e-3);
}

// The same through a chain: the upper plate hangs on the world by a fixed joint, the lower one on the pad alone.
TEST(Bonds, CarryWhatHangsOnThem) {
  for (const char* linear : {"direct", "reuse", "cg"}) {
    Rig rig(sandwich(kBonds + R"(  gravity: {acceleration: [0, 0, -9.81]}
  joint: [{type: fixed, body: top}]
)"),
            {std::string("solver.linear=") + linear});
    rig.steps(2);
    const Captured f = rig.fields();
    const auto weight = [&](int body) {
      const model::BodyInput& b = rig.input.bodies[body];
      audit::MeasuredBody measured(b, 0);
      return measured.mass() * kG;
    };
    const double below = weight(2) + weight(1);
    EXPECT_LT((vector(f, "bond/pad_base_force_") - Vec3(0, 0, -weight(2))).norm(), 1e-7 * below) << linear;
    EXPECT_LT((vector(f, "bond/pad_top_force_") - Vec3(0, 0, below)).norm(), 1e-7 * below) << linear;
    EXPECT_LT((vector(f, "joint/top_world_force_") - Vec3(0, 0, below + weight(0))).norm(), 1e-7 * below) << linear;
    EXPECT_LT(vector(f, "balance/defect_").norm(), 1e-7 * below) << linear;
    EXPECT_LT(std::max(f.at("bond/tie_error"), f.at("joint/tie_error")), 1e-16);
  }
}

// What a stiff body at the origin feels of a pad is rounded as the pad's places are: nothing acts, and 5e-15 N were too much.
TEST(Bonds, OfABodyAtTheOriginRest) {
  Rig rig(R"(
mortise: 1
name: rest
time: {step: 5 ms, steps: 4}
materials: {steel: {density: 7850}, gel: {model: linear, youngs_modulus: 0.1 MPa, poisson_ratio: 0, density: 1000}}
bodies:
  block: {type: stiff, shape: {box: {size: [0.02, 0.02, 0.02], edge_length: 0.01}}, material: steel}
  pad: {type: soft, shape: {box: {size: [0.01, 0.02, 0.02], edge_length: 0.005}}, material: gel, position: [0.015, 0, 0]}
effects:
  inertia: {}
  elasticity: {}
  affine_body: {}
  joint: [{name: slide, type: prismatic, body: block, axis: [1, 0, 0]}]
  bond: [{body: pad, to: block, within: 1 um}]
)");
  for (int i = 0; i < 4; ++i) EXPECT_LT(rig.step().newton, 10);
}

// Nodes inside of a stiff core, and near to it.
TEST(Bonds, WithinAStiffBody) {
  const auto bonded = [](const std::string& within) {
    Rig rig(fmt::format(R"(
mortise: 1
name: core
time: {{mode: static, steps: 1}}
materials: {{gel: {{model: linear, youngs_modulus: 0.1 MPa, poisson_ratio: 0.3, density: 1000}}, steel: {{density: 7800}}}}
bodies:
  pad: {{type: soft, shape: {{box: {{size: [40 mm, 40 mm, 40 mm], edge_length: 10 mm}}}}, material: gel}}
  core: {{type: stiff, shape: {{box: {{size: [20 mm, 20 mm, 20 mm], edge_length: 20 mm}}}}, material: steel}}
effects:
  elasticity: {{}}
  affine_body: {{}}
  gravity: {{acceleration: [1, 2, -9.81]}}
  pin: [{{body: core, where: {{side: all}}}}]
  bond: [{{body: pad, to: core, {}}}]
)",
                        within));
    rig.step();
    const Captured f = rig.fields();
    const std::vector<double>& force = *f.of_points("tie_force", 3);
    int n = 0;
    for (std::size_t i = 0; i < force.size() / 3; ++i) n += force[3 * i] != 0 || force[3 * i + 1] != 0 || force[3 * i + 2] != 0;
    return n;
  };
  EXPECT_EQ(bonded("within: 0"), 27);              // a grid of 5 x 5 x 5 nodes, of which 3 x 3 x 3 are in the core or on it
  EXPECT_EQ(bonded("within: 10 mm"), 27 + 6 * 9);  // and those before its faces
  EXPECT_EQ(bonded("within: 10 mm, where: {side: x_max}"), 9);
}

namespace {

// A pendulum with a bonded pad that strikes a plate, in two environments.
model::ModelInput striking(const std::vector<std::string>& overrides, const std::vector<double>& densities) {
  model::ModelInput out;
  for (std::size_t e = 0; e < densities.size(); ++e) {
    std::vector<std::string> all = overrides;
    all.push_back(fmt::format("materials.steel.density={}", densities[e]));
    model::ModelInput one = engine::make_input(scene::read_scene_text(R"(
mortise: 1
name: striking
time: {step: 4 ms, steps: 40}
materials: {gel: {youngs_modulus: 0.3 MPa, poisson_ratio: 0.4, density: 1000}, steel: {density: 2000}}
bodies:
  upper: {type: stiff, shape: {box: {size: [60 mm, 8 mm, 8 mm], edge_length: 60 mm}}, material: steel, position: [30 mm, 0, 0], angular_velocity: [0, 4, 0]}
  lower: {type: stiff, shape: {box: {size: [60 mm, 8 mm, 8 mm], edge_length: 60 mm}}, material: steel, position: [90 mm, 0, 0], angular_velocity: [0, 4, 0]}
  pad: {type: soft, shape: {box: {size: [20 mm, 20 mm, 10 mm], edge_length: 5 mm}}, material: gel, position: [110 mm, 0, -7 mm], velocity: [-0.028, 0, -0.44], angular_velocity: [0, 4, 0]}
  plate: {type: stiff, shape: {box: {size: [60 mm, 60 mm, 8 mm], edge_length: 60 mm}}, material: steel, position: [110 mm, 0, -20 mm]}
effects:
  inertia: {}
  gravity: {}
  elasticity: {}
  affine_body: {}
  pin: [{body: plate, where: {side: all}}]
  joint:
    - {type: revolute, body: upper, at: [0, 0, 0], axis: [0, 1, 0]}
    - {type: spherical, body: lower, to: upper, at: [60 mm, 0, 0]}
  bond: [{body: pad, where: {side: z_max}, to: lower}]
  barrier_contact: {d_hat: 1 mm, stiffness: 50 kPa}
  friction: {follows: barrier_contact, mu: 0.4}
)",
                                                                      "striking.yaml", all, engine::effect_tables())
                                                   .root);
    if (e == 0) out.scene = one.scene;
    for (model::BodyInput& body : one.bodies) {
      body.env = static_cast<Index>(e);
      out.bodies.push_back(std::move(body));
    }
  }
  return out;
}

std::vector<double> after(const model::ModelInput& input, int steps, Captured* last = nullptr) {
  Rig rig(input);
  rig.steps(steps);
  if (last) *last = rig.fields();
  return rig.engine->points();
}

}  // namespace

// The pad strikes the plate; every environment has the bits that it has alone, and every solver finds the same.
TEST(Ties, InBatchesWithEveryLinearSolver) {
  std::vector<double> direct;
  for (const char* linear : {"direct", "reuse", "cg"}) {
    const std::vector<std::string> with{std::string("solver.linear=") + linear};
    Captured f;
    const std::vector<double> both = after(striking(with, {2000, 5000}), 5), one = after(striking(with, {2000}), 5, &f),
                              other = after(striking(with, {5000}), 5);
    std::vector<double> apart = one;
    apart.insert(apart.end(), other.begin(), other.end());
    EXPECT_EQ(both, apart) << linear;
    EXPECT_GT(f.at("barrier_contact/force_pad_z"), 0.01);
    EXPECT_LT(std::max(f.at("bond/tie_error"), f.at("joint/tie_error")), 1e-16);
    if (direct.empty()) direct = one;
    double worst = 0;
    for (std::size_t i = 0; i < one.size(); ++i) worst = std::max(worst, std::abs(one[i] - direct[i]));
    EXPECT_LT(worst, 1e-6) << linear;  // m: Newton's tolerance, friction's lag
  }
}

TEST(Ties, ResumeWithTheSameBits) {
  const model::ModelInput input = striking({}, {2000});
  Rig unbroken(input), broken(input);
  unbroken.steps(6);
  broken.steps(3);
  broken.resume();
  broken.steps(3);
  EXPECT_EQ(unbroken.engine->points(), broken.engine->points());
}

namespace {

std::string refused(const std::string& yaml) {
  try {
    Rig rig(yaml);
    return "";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::scene);
    return e.what();
  }
}

// Three links in a row, with these effects besides.
std::string links(const std::string& effects, const std::string& bodies = "") {
  return R"(
mortise: 1
name: links
time: {step: 4 ms, steps: 1}
materials: {gel: {youngs_modulus: 0.3 MPa, poisson_ratio: 0.4, density: 1000}, steel: {density: 2000}}
bodies:
  a: {type: stiff, shape: {box: {size: [50 mm, 8 mm, 8 mm], edge_length: 60 mm}}, material: steel}
  b: {type: stiff, shape: {box: {size: [50 mm, 8 mm, 8 mm], edge_length: 60 mm}}, material: steel, position: [60 mm, 0, 0]}
  c: {type: stiff, shape: {box: {size: [50 mm, 8 mm, 8 mm], edge_length: 60 mm}}, material: steel, position: [120 mm, 0, 0]}
  pad: {type: soft, shape: {box: {size: [20 mm, 20 mm, 10 mm], edge_length: 5 mm}}, material: gel, position: [0, 0, 20 mm]}
  floor: {type: half_space, point: [0, 0, -50 mm]}
)" + bodies +
         "effects:\n  inertia: {}\n  elasticity: {}\n  affine_body: {}\n" + effects;
}

}  // namespace

// Every message cites the place, and says what to do.
TEST(Ties, BadScenesGetOneClearMessage) {
  const std::string ab = "    - {type: spherical, body: a, to: b, at: [30 mm, 0, 0]}\n",
                    bc = "    - {type: spherical, body: b, to: c, at: [90 mm, 0, 0]}\n";
  const std::vector<std::pair<std::string, std::string>> cases{
      {"  joint: [{type: spherical, body: a, to: bb, at: [0, 0, 0]}]\n", "test.yaml:16:42: error: effects.joint.0.to: no body 'bb'"},
      {"  joint: [{type: spheric, body: a, at: [0, 0, 0]}]\n", "did you mean 'spherical'?"},
      {"  joint: [{body: a, at: [0, 0, 0]}]\n", "effects.joint.0 has no 'type'"},
      {"  joint: [{type: spherical, body: a}]\n", "test.yaml:16:11: error: a spherical joint needs 'at'"},
      {"  joint: [{type: revolute, body: a, at: [0, 0, 0]}]\n", "a revolute joint needs 'axis'"},
      {"  joint: [{type: revolute, body: a, at: [0, 0, 0], axis: [0, 0, 0]}]\n", "is zero; a direction is wanted"},
      {"  joint: [{type: fixed, body: a, axis: [0, 0, 1]}]\n", "axis has no meaning"},
      {"  joint: [{type: fixed, body: a, to: a}]\n", "ties 'a' to itself"},
      {"  joint: [{type: fixed, body: a, to: floor}]\n", "is a half_space, which belongs to the world: leave 'to' out"},
      {"  joint: [{type: fixed, body: pad, to: a}]\n", "'pad' is soft; joints are between stiff bodies"},
      {"  joint: [{type: fixed, body: a, to: pad}]\n", "'pad' is soft; joints and bonds tie to stiff bodies"},
      {"  joint: [{name: A b, type: fixed, body: a}]\n", "'A b' is not a name"},
      {"  pin: [{body: a, where: {side: all}}]\n  joint: [{type: fixed, body: a}]\n", "supports hold both already"},
      {"  pin: [{body: a, where: {side: all}}, {body: b, where: {side: all}}]\n  joint:\n" + ab, "supports hold both already"},
      {"  joint:\n" + ab + "  barrier_contact: {d_hat: 1 mm, stiffness: 1 kPa, pairs: [[a, b]]}\n",
       "barrier_contact lists 'a' and 'b' as a pair, but a joint ties them"},
      {"  bond: [{body: pad, to: a}]\n", "which nodes are bonded?"},
      {"  bond: [{body: pad, to: a, where: {side: z_min}, within: 1 mm}]\n", "no node of 'pad' among them is that near to 'a'"},
      {"  bond: [{body: pad, where: {side: z_min}}]\n", "effects.bond.0 has no 'to'"},
      {"  bond: [{body: b, to: a, within: 1 mm}]\n", "'b' is stiff; bonds are of soft bodies"},
      {"  pin: [{body: pad, where: {side: x_min}}]\n  bond: [{body: pad, to: a, where: {side: z_min}}]\n",
       "ties 5 nodes of 'pad' that a pin holds or moves"},
      {"  bond: [{body: pad, to: a, where: {side: z_min}}, {body: pad, to: b, where: {side: x_min}}]\n", "ties already: parts of 'pad'"},
      {"  bond: [{body: pad, to: a, where: {side: z_min}}, {body: pad, to: a, where: {side: z_max}}]\n", "two ties are called 'pad_a'"},
  };
  for (const auto& [effects, message] : cases)
    EXPECT_NE(refused(links(effects)).find(message), std::string::npos) << effects << refused(links(effects));
  EXPECT_EQ(refused(links("  joint:\n" + ab + bc +
                          "    - {type: fixed, body: c}\n  bond: [{body: pad, to: a, where: {side: z_min}}, {name: other, body: pad, to: b, where: "
                          "{side: z_max}}]\n")),
            "");
}

// Bodies that are tied pass through each other, and only they, unless the scene wants contact.
TEST(Ties, LeaveContactOut) {
  const auto list = [](const std::string& contact) {
    const std::string yaml = links(
        "  barrier_contact: {d_hat: 1 mm, stiffness: 1 kPa}\n  joint:\n    - {type: spherical, body: a, to: b, at: [30 mm, 0, 0]" + contact + "}\n");
    std::vector<std::string> out;
    for (const scene::PassThrough& p :
         scene::pass_through(scene::read_scene_text(yaml, "test.yaml", {}, engine::effect_tables()).root, engine::effect_tables()))
      out.push_back(p.text());
    return out;
  };
  EXPECT_EQ(list(""), std::vector<std::string>{"'a' and 'b' pass through each other: a joint ties them to each other (it may say contact: true)"});
  EXPECT_TRUE(list(", contact: true").empty());
  // Links that overlap at their hinge.
  std::string yaml = links("  barrier_contact: {d_hat: 1 mm, stiffness: 1 kPa}\n  joint: [{type: spherical, body: a, to: b, at: [30 mm, 0, 0]}]\n");
  yaml.replace(yaml.find("size: [50 mm"), 12, "size: [80 mm");
  EXPECT_EQ(refused(yaml), "");
  Rig rig(yaml);
  rig.step();
  yaml.replace(yaml.find("at: [30 mm, 0, 0]"), 17, "at: [30 mm, 0, 0], contact: true");
  Rig touching(yaml);
  EXPECT_NE(touching.engine->begin().message.find("'a'"), std::string::npos);
}

// A crank that is turned by a pin, a plate that is fixed to it, and a link that hangs on it and carries a pad: what is fixed goes where the path
// says, and the supports' work is all the energy that there is.
TEST(Ties, FollowWhatSupportsMove) {
  constexpr const char* kCrank = R"(
mortise: 1
name: crank
time: {step: 2 ms, steps: 100}
materials: {gel: {youngs_modulus: 1 MPa, poisson_ratio: 0.4, density: 1000}, steel: {density: 2000}}
bodies:
  crank: {type: stiff, shape: {box: {size: [60 mm, 8 mm, 8 mm], edge_length: 60 mm}}, material: steel, position: [30 mm, 0, 0]}
  plate: {type: stiff, shape: {box: {size: [8 mm, 30 mm, 30 mm], edge_length: 60 mm}}, material: steel, position: [0, 0, 0]}
  link: {type: stiff, shape: {box: {size: [8 mm, 8 mm, 60 mm], edge_length: 60 mm}}, material: steel, position: [60 mm, 0, -30 mm]}
  pad: {type: soft, shape: {box: {size: [16 mm, 16 mm, 16 mm], edge_length: 8 mm}}, material: gel, position: [60 mm, 0, -64 mm]}
effects:
  inertia: {}
  gravity: {}
  elasticity: {}
  affine_body: {}
  pin: [{body: crank, where: {side: all}, motion: {time: [0, 200 ms], rotation: {axis: [0, 1, 0], angle: [0, 60 deg]}, interpolation: smooth}}]
  joint:
    - {type: fixed, body: crank, to: plate}
    - {type: revolute, body: link, to: crank, at: [60 mm, 0, 0], axis: [0, 1, 0]}
  bond: [{body: pad, to: link, within: 0}]
)";
  for (const char* linear : {"direct", "cg"}) {
    Rig rig(kCrank, {std::string("solver.linear=") + linear});
    audit::EnergyAudit audit(rig.input);
    double work = 0;
    for (int i = 0; i < 100; ++i) {
      rig.step();
      const Captured now = rig.fields();
      const std::vector<double> points = rig.engine->points();
      work += now.at("supports/work");
      audit.state({now, points});
      EXPECT_LT(std::max(now.at("joint/tie_error"), now.at("bond/tie_error")), 1e-16);
      EXPECT_LT(now.at("supports/crank_defect"), 1e-6);
    }
    const Mat3 R = Eigen::AngleAxisd(M_PI / 3, Vec3::UnitY()).toRotationMatrix();
    const std::vector<double> points = rig.engine->points();
    const std::size_t first = rig.input.bodies[0].nodes.size();
    for (std::size_t i = 0; i < rig.input.bodies[1].nodes.size(); ++i)
      EXPECT_LT((Vec3(points[3 * (first + i)], points[3 * (first + i) + 1], points[3 * (first + i) + 2]) - R * rig.input.bodies[1].nodes[i]).norm(),
                1e-16)
          << linear;
    EXPECT_GT(std::abs(work), 1e-3);
    EXPECT_LT(audit.result().largest_gain, 1e-6 * audit.result().scale) << linear;
    EXPECT_GT(audit.result().total, audit.result().support_work - 0.1 * audit.result().scale) << linear;  // backward Euler loses some
  }
}

// A plate that is fixed to a driven body is prescribed as that is: in another prescribed body's way the step fails, and says so.
TEST(Ties, WhatIsFixedToADrivenBodyMeetsOthers) {
  constexpr const char* kMeeting = R"(
mortise: 1
name: meeting
time: {step: 10 ms, steps: 10}
materials: {steel: {density: 2000}}
bodies:
  ram: {type: stiff, shape: {box: {size: [10 mm, 10 mm, 10 mm], edge_length: 10 mm}}, material: steel, position: [0, 0, 40 mm]}
  head: {type: stiff, shape: {box: {size: [20 mm, 20 mm, 4 mm], edge_length: 10 mm}}, material: steel, position: [0, 0, 20 mm]}
  anvil: {type: stiff, shape: {box: {size: [20 mm, 20 mm, 4 mm], edge_length: 10 mm}}, material: steel}
effects:
  inertia: {}
  affine_body: {}
  pin:
    - {body: ram, where: {side: all}, motion: {time: [0, 100 ms], translation: [[0, 0, 0], [0, 0, -30 mm]]}}
    - {body: anvil, where: {side: all}}
  joint: [{type: fixed, body: head, to: ram}]
  barrier_contact: {d_hat: 1 mm, stiffness: 10 kPa}
)";
  Rig rig(kMeeting);
  std::string message;
  for (int i = 0; i < 10 && message.empty(); ++i) {
    solver::StepReport report;
    message = rig.engine->step({}, report).message;
  }
  EXPECT_NE(message.find("'head' meets 'anvil'"), std::string::npos) << message;
}

namespace {

// Two blocks on each other, the upper one smaller, with meshes of their own; the lower side is pinned, the upper one pushed down and aside, and where
// they meet they are tied.
std::string tied_blocks(const std::string& upper, const std::string& lower, const std::string& more = "", double gap = 0) {
  return fmt::format(R"(
mortise: 1
name: tied_blocks
time: {{mode: static, steps: 1}}
materials: {{gel: {{model: linear, youngs_modulus: 0.1 MPa, poisson_ratio: 0, density: 1000}}}}
solver: {{relative_tolerance: 1e-12}}
bodies:
  upper: {{type: soft, shape: {{box: {{size: [20 mm, 20 mm, 10 mm], edge_length: {}}}}}, material: gel, position: [0, 0, {} mm]}}
  lower: {{type: soft, shape: {{box: {{size: [20 mm, 20 mm, 10 mm], edge_length: {}}}}}, material: gel, position: [0, 0, -5 mm]}}
effects:
  elasticity: {{}}
  pin:
    - {{body: lower, where: {{side: z_min}}}}
    - {{body: upper, where: {{side: z_max}}, motion: {{time: [0, 1], translation: [[0, 0, 0], [0, 0, -0.2 mm]]}}}}
  mortar_tie: [{{body: upper, where: {{side: z_min}}, to: lower{}}}]
)",
                     upper, 5 + gap, lower, more);
}

// The largest difference from u_z = -0.01 (z + 10 mm), over 0.2 mm; the force through the tie.
double unevenness(Rig& rig, double height = 20e-3) {
  rig.step();
  const Captured f = rig.fields();
  const std::vector<double>& u = *f.of_points("displacement", 3);
  double worst = 0;
  std::size_t i = 0;
  for (const model::BodyInput& body : rig.input.bodies)
    for (const Vec3& x : body.nodes) {
      worst = std::max(worst, (Vec3(u[3 * i], u[3 * i + 1], u[3 * i + 2]) - Vec3(0, 0, -2e-4 * (x[2] + 10e-3) / height)).norm());
      ++i;
    }
  const Vec3 through = vector(f, "mortar_tie/upper_lower_force_"), top = vector(f, "supports/upper_"), bottom = vector(f, "supports/lower_");
  EXPECT_GT(through[2], 0.35);
  EXPECT_LT((through + top).norm(), 1e-10 * through.norm());
  EXPECT_LT((through - bottom).norm(), 1e-10 * through.norm());
  EXPECT_LT(vector(f, "balance/mortar_tie_").norm(), 1e-12 * through.norm());
  EXPECT_LT(f.at("mortar_tie/tie_error"), 1e-16);
  return worst / 2e-4;
}

}  // namespace

TEST(Bonds, TiedMeshesPassThePatchTest) {
  const char* meshes[] = {"3.3 mm", "5 mm", "7 mm"};
  for (const char* upper : meshes)
    for (const char* lower : meshes)
      for (int orders = 0; orders < 4; ++orders) {
        Rig rig(tied_blocks(upper, lower),
                {fmt::format("bodies.upper.order={}", 1 + orders % 2), fmt::format("bodies.lower.order={}", 1 + orders / 2)});
        EXPECT_LT(unevenness(rig), 1e-10) << upper << " on " << lower << ", orders " << 1 + orders % 2 << " " << 1 + orders / 2;
      }
}

// A gap is strained as the lower block is, and what it does to the tetrahedra that carry it is of the order of gap over edge, 1.6 % here.
TEST(Bonds, TiedMeshesMayBeApart) {
  Rig rig(tied_blocks("4 mm", "6 mm", ", within: 1 mm", 0.1));
  EXPECT_LT(unevenness(rig, 20.1e-3), 0.016);
}

// Tied blocks that are turned as a whole are not strained: by 40 degrees, in steps that follow the way.
TEST(Bonds, TiedMeshesTurn) {
  for (double gap : {0.0, 0.5}) {
    std::string yaml = tied_blocks("4 mm", "7 mm", ", within: 1 mm", gap);
    const auto replace = [&](const std::string& from, const std::string& to) { yaml.replace(yaml.find(from), from.size(), to); };
    replace("model: linear", "model: neo_hookean");
    replace("steps: 1", "steps: 10");
    replace(
        "    - {body: lower, where: {side: z_min}}\n",
        "    - {body: lower, where: {side: z_min}, motion: {time: [0, 1], rotation: {axis: [1, 0.3, 0], centre: [0, 0, 0], angle: [0, 40 deg]}}}\n");
    replace("translation: [[0, 0, 0], [0, 0, -0.2 mm]]", "rotation: {axis: [1, 0.3, 0], centre: [0, 0, 0], angle: [0, 40 deg]}");
    Rig rig(yaml, {"solver.relative_tolerance=1e-9"});
    rig.steps(10);
    const Captured f = rig.fields();
    const Mat3 R = Eigen::AngleAxisd(40 * M_PI / 180, Vec3(1, 0.3, 0).normalized()).toRotationMatrix();
    const std::vector<double> points = rig.engine->points();
    std::size_t i = 0;
    double worst = 0;
    for (const model::BodyInput& body : rig.input.bodies)
      for (const Vec3& x : body.nodes) {
        worst = std::max(worst, (Vec3(points[3 * i], points[3 * i + 1], points[3 * i + 2]) - R * x).norm());
        ++i;
      }
    EXPECT_LT(worst, 1e-7) << gap;
  }
}

TEST(Bonds, TiesThatDoNotFitAreRefused) {
  EXPECT_NE(refused(tied_blocks("5 mm", "5 mm", "", 3)).find("test.yaml:15:16: error: a face of 'upper' near"), std::string::npos)
      << refused(tied_blocks("5 mm", "5 mm", "", 3));
  std::string wide = tied_blocks("5 mm", "5 mm");
  wide.replace(wide.find("[20 mm, 20 mm, 10 mm]"), 21, "[24 mm, 20 mm, 10 mm]");
  EXPECT_NE(refused(wide).find("the side that reaches farther has to be the one that is tied 'to'"), std::string::npos) << refused(wide);
  std::string pinned = tied_blocks("5 mm", "5 mm");
  pinned.replace(pinned.find("{side: z_max}"), 13, "{side: x_max}");
  EXPECT_NE(refused(pinned).find("that a pin holds or moves"), std::string::npos) << refused(pinned);
}

namespace {

// A four-bar linkage in the x-z plane: crank, coupler and rocker on two bearings, and what else hangs on it.
std::string four_bar(const std::string& last, const std::string& more = "") {
  return R"(
mortise: 1
name: four_bar
time: {step: 2 ms, steps: 200}
materials: {steel: {density: 2000}}
bodies:
  crank: {type: stiff, shape: {box: {size: [8 mm, 8 mm, 40 mm], edge_length: 60 mm}}, material: steel, position: [0, 0, -20 mm]}
  coupler: {type: stiff, shape: {box: {size: [100 mm, 8 mm, 8 mm], edge_length: 100 mm}}, material: steel, position: [50 mm, 0, -40 mm]}
  rocker: {type: stiff, shape: {box: {size: [8 mm, 8 mm, 60 mm], edge_length: 60 mm}}, material: steel, position: [100 mm, 0, -10 mm]}
effects:
  inertia: {}
  gravity: {acceleration: [3, 0, -9.81]}
  affine_body: {}
  joint:
    - {type: revolute, body: crank, at: [0, 0, 0], axis: [0, 1, 0]}
    - {type: revolute, body: coupler, to: crank, at: [0, 0, -40 mm], axis: [0, 1, 0]}
    - {type: revolute, body: rocker, to: coupler, at: [100 mm, 0, -40 mm], axis: [0, 1, 0]}
    - {name: last, )" +
         last + ", body: rocker, at: [100 mm, 0, 20 mm]}\n" + more;
}

}  // namespace

// A loop moves as one mechanism: its joints hold, its links keep their lengths, energy and balance hold; the same whichever joint comes last.
TEST(Joints, CloseLoops) {
  std::vector<double> first;
  for (const char* last : {"type: revolute, axis: [0, 1, 0]", "type: spherical"})
    for (const char* linear : {"direct", "cg"}) {
      Rig rig(four_bar(last), {std::string("solver.linear=") + linear});
      audit::EnergyAudit audit(rig.input);
      for (int i = 0; i < 100; ++i) {
        rig.step();
        const Captured f = rig.fields();
        const std::vector<double> points = rig.engine->points();
        audit.state({f, points});
        EXPECT_LT(f.at("joint/tie_error"), 1e-15);
        const Vec3 bearings = vector(f, "joint/crank_world_force_") + vector(f, "joint/last_force_");
        EXPECT_LT((vector(f, "balance/joint_") - bearings).norm(), 1e-9);
        EXPECT_LT(vector(f, "balance/defect_").norm(), 1e-6);
        EXPECT_LT((vector(f, "joint/last_place_") - Vec3(0.1, 0, 0.02)).norm(), 1e-15);
      }
      EXPECT_LT(audit.result().largest_gain, 1e-6 * audit.result().scale);
      EXPECT_GT(std::abs(angle(rig, 0)), 0.2);
      const std::vector<double> points = rig.engine->points();
      if (first.empty()) first = points;
      for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(points[i], first[i], 1e-6) << last << " " << linear;
    }
}

// A slider-crank: the piston stays on its line, and is where crank and rod put it, in whatever order the joints stand and whatever it slides on.
TEST(Joints, ASlideInALoopKeepsToItsAxis) {
  constexpr double r = 0.05, l = 0.13, start = 0.9273;  // [m], [m], [rad]: 3-4-5 and 5-12-13 triangles, nearly
  const auto scene = [&](bool first, bool based) {
    const double x = r * std::cos(start), z = r * std::sin(start), tilt = std::asin(z / l), at = x + l * std::cos(tilt);
    std::ostringstream out;
    out.precision(17);
    const auto link = [&](const char* name, double length, double cx, double cz, double angle) {
      out << "  " << name << ": {type: stiff, shape: {box: {size: [" << length << ", 0.01, 0.01], edge_length: 0.2}}, mass: 0.1, position: [" << cx
          << ", 0, " << cz << "], rotation: {axis: [0, -1, 0], angle: " << angle << "}}\n";
    };
    out << "mortise: 1\nname: slider_crank\ntime: {step: 5 ms, steps: 60}\nbodies:\n";
    link("crank", r, x / 2, z / 2, start), link("rod", l, (x + at) / 2, z / 2, -tilt), link("piston", 0.03, at, 0, 0);
    if (based) link("base", 0.3, 0, -0.1, 0);
    out << "effects:\n  inertia: {}\n  affine_body: {stiffness: 100 GPa}\n"
        << (based ? "  pin: [{body: base, where: {side: all}}]\n" : "") << "  joint:\n";
    const std::string slide = std::string("    - {name: slide, type: prismatic, body: piston, axis: [1, 0, 0]") + (based ? ", to: base}\n" : "}\n");
    if (first) out << slide;
    const auto hinge = [&](const char* bodies, double hx, double hz) {
      out << "    - {type: revolute, axis: [0, -1, 0], " << bodies << ", at: [" << hx << ", 0, " << hz << "]}\n";
    };
    hinge(based ? "name: main, body: crank, to: base" : "name: main, body: crank", 0, 0), hinge("name: pin, body: rod, to: crank", x, z);
    if (!first) out << slide;
    hinge("name: wrist, body: rod, to: piston", at, 0);
    out << "  drive:\n    - {joint: main, mode: pd, kp: 20, kd: 1, angle: 0.2}\n    - {joint: slide, mode: effort, force: -20, effort: 100}\n";
    return out.str();
  };
  for (const bool first : {false, true})
    for (const bool based : {false, true}) {
      Rig rig(scene(first, based));
      Captured f;
      for (int i = 0; i < 60; ++i) {
        rig.step();
        f = rig.fields();
        const double angle = start + f.at("joint/main_angle"), x = r * std::cos(angle) + std::sqrt(l * l - std::pow(r * std::sin(angle), 2));
        EXPECT_NEAR(f.at("joint/slide_travel"), x - r * std::cos(start) - std::sqrt(l * l - std::pow(r * std::sin(start), 2)), 1e-7)
            << first << based;
        ASSERT_LT(f.at("joint/slide_beside"), 1e-10) << first << based;
      }
      // At rest the motor bears what the force on the piston makes of it: the work of both is none.
      const double angle = start + f.at("joint/main_angle"),
                   way = -r * std::sin(angle) * (1 + r * std::cos(angle) / std::sqrt(l * l - std::pow(r * std::sin(angle), 2)));
      EXPECT_NEAR(f.at("drive/main_torque"), 20 * way, 1e-3) << first << based;
      // What the guide bears: the rod's push across.
      const double tilt = std::asin(r * std::sin(angle) / l);
      EXPECT_NEAR(std::abs(f.at("joint/slide_guide_z")), 20 * std::tan(tilt), 1e-2) << first << based;
    }
}

// At rest the force in the loop is that of statics: a beam on two ball joints bears half of its weight on each side; a second hinge on the axis of
// the first says nothing new.
TEST(Joints, CloseLoopsAtRest) {
  constexpr const char* kBeam = R"(
mortise: 1
name: beam
time: {step: 2 ms, steps: 200}
materials: {steel: {density: 2000}}
bodies:
  beam: {type: stiff, shape: {box: {size: [100 mm, 10 mm, 10 mm], edge_length: 100 mm}}, material: steel}
effects:
  inertia: {}
  gravity: {}
  affine_body: {}
  joint:
    - {name: left, type: spherical, body: beam, at: [-50 mm, 0, 5 mm]}
    - {name: right, type: TYPE, body: beam, at: [50 mm, 0, 5 mm]}
)";
  const double weight = 2000 * 1e-5 * kG;
  std::string yaml = kBeam;
  yaml.replace(yaml.find("TYPE"), 4, "spherical");
  Rig rig(yaml);
  rig.steps(5);
  const Captured f = rig.fields();
  for (const char* side : {"left", "right"}) EXPECT_NEAR(f.at(std::string("joint/") + side + "_force_z"), weight / 2, 1e-6 * weight);
  EXPECT_LT(f.at("joint/tie_error"), 1e-16);

  yaml = kBeam;
  yaml.replace(yaml.find("type: spherical"), 15, "type: revolute, axis: [1, 0, 0]");
  yaml.replace(yaml.find("TYPE"), 4, "revolute, axis: [1, 0, 0]");
  Rig door(yaml);
  door.steps(5);
  const Captured g = door.fields();
  EXPECT_NEAR(g.at("joint/left_force_z"), weight, 1e-6 * weight);
  EXPECT_EQ(g.at("joint/right_force_z"), 0);
  EXPECT_LT(g.at("joint/tie_error"), 1e-16);
}
