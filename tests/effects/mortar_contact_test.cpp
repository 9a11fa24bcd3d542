// mortar_contact as a whole: frozen energy and its derivatives, balance, samples, weights, supports, stiffness.
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/memory_archive.h"
#include "contact_scene.h"
#include "effects/contact/barrier.h"
#include "effects/mortar_contact/frozen.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

constexpr double kHat = 0.05, kKappa = 1e4;

struct Options {
  std::string weights = "consistent", gap = "pointwise", gradient = "frozen", quadrature = "3", slave = "pad", master = "tool";
  double stiffness = kKappa, guard = 0, rest_share = 0, d_hat = kHat;
  bool two_pass = false;
};

Params params(const Options& o) {
  Params p = Params::make_table(), pair = Params::make_table(), pairs = Params::make_list();
  pair.set("slave", Params::make_text(o.slave));
  pair.set("master", Params::make_text(o.master));
  pairs.push(pair);
  p.set("pairs", pairs);
  p.set("d_hat", Params::make_number(o.d_hat));
  if (o.stiffness > 0) p.set("stiffness", Params::make_number(o.stiffness));
  p.set("weights", Params::make_text(o.weights));
  p.set("taper_width", Params::make_number(0.1));
  p.set("quadrature", Params::make_text(o.quadrature));
  p.set("gap", Params::make_text(o.gap));
  p.set("gradient", Params::make_text(o.gradient));
  p.set("guard", Params::make_number(o.guard));
  p.set("rest_share", Params::make_number(o.rest_share));
  p.set("two_pass", Params::make_flag(o.two_pass));
  return p;
}

struct Problem {
  model::Model model;
  std::unique_ptr<fd::Subject> contact;
  Problem(model::ModelInput in, const Options& o) : model(std::move(in)), contact(make_effect("mortar_contact", params(o), model)) {
    contact->begin_step({});
  }
  std::vector<model::ContactSample> samples() { return contact->samples(); }
  Recorder report() {
    Recorder r;
    contact->report(r);
    return r;
  }
};

model::ModelInput scene(std::vector<model::BodyInput> bodies) {
  model::ModelInput in;
  in.scene = Params::make_table();
  in.bodies = std::move(bodies);
  return in;
}

// Two boxes face to face with different meshes, `gap` apart.
model::ModelInput stack(double gap, bool stiff = false, Index cells = 3, double size = 1) {
  const auto lower = geometry::box({1, 1, 0.5}, std::array<Index, 3>{2, 2, 1});
  const auto upper = geometry::box({size, size, 0.5}, std::array<Index, 3>{cells, cells, 1});
  const Vec3 up(0, 0, 0.5 + gap);
  return scene({soft_body("pad", lower, gel()), stiff ? stiff_body("tool", upper, gel(), up) : soft_body("tool", upper, gel(), up)});
}

// A cube pushed corner first, edge first or face first (angle from it) towards a pad, over a half-space.
model::ModelInput tilted(double gap, const Mat3& R, bool stiff = true) {
  const auto cube = geometry::box({0.4, 0.4, 0.4}, 0.2);
  auto tool = stiff ? stiff_body("tool", cube, gel()) : soft_body("tool", cube, gel());
  double low = 1e9;
  for (Vec3& x : tool.nodes) x = R * x, low = std::min(low, x.z());
  for (Vec3& x : tool.nodes) x += Vec3(0.03, 0.02, 0.25 + gap - low);
  return scene({soft_body("pad", geometry::box({1, 1, 0.5}, 0.5), gel()), tool});
}
Mat3 turn(double degrees, const Vec3& axis) { return Eigen::AngleAxisd(degrees * M_PI / 180, axis.normalized()).toRotationMatrix(); }

double mean_edge(const model::Model& m) {  // of the first body's surface
  double sum = 0;
  const auto triangles = m.surface.triangles.download();
  const auto y = m.rest_points.download();
  for (Index t = 0; t < m.bodies[0].triangle_end; ++t)
    for (int k = 0; k < 3; ++k) sum += (y[triangles[t].v[k]] - y[triangles[t].v[(k + 1) % 3]]).norm();
  return sum / (3.0 * m.bodies[0].triangle_end);
}

// Energy of the samples frozen at x0 against its gradient, and the gradient against the Gauss-Newton Hessian, which is exact for
// linear gaps: (E(x + hd) - 2 E(x) + E(x - hd)) / h^2 = d^T H d.
void expect_frozen_derivatives(Problem& p, const fd::Vector& x, double h) {
  const fd::Dense d = fd::effect_assemble(*p.contact, x, true);
  ASSERT_GT(d.gradient.norm(), 0);
  const auto E = [&](const fd::Vector& y) { return fd::effect_energy(*p.contact, y); };
  const fd::Vector g = fd::difference_gradient(E, x, h);
  EXPECT_LT(fd::relative_error(d.gradient, g), 1e-6);
  EXPECT_GT(fd::lowest_eigenvalue(d.hessian), -1e-12);
  // Directions: those that the Hessian feels most, and random ones.
  for (unsigned seed = 1; seed <= 4; ++seed) {
    fd::Vector v = d.hessian * shaken(fd::Vector::Zero(x.size()), 1, seed);
    v /= v.cwiseAbs().maxCoeff();
    const double s = 2 * h;  // small: b''' jumps where a gap passes d_hat
    const auto at = [&](double a) { return E(x + a * s * v); };
    const double second = (-at(2) + 16 * at(1) - 30 * at(0) + 16 * at(-1) - at(-2)) / (12 * s * s);
    const double exact = v.dot(d.hessian * v);
    EXPECT_NEAR(second / exact, 1, 1e-5);
  }
}

void expect_balance(Problem& p, const fd::Vector& x) {
  const fd::Dense d = fd::effect_assemble(*p.contact, x, false);
  ASSERT_GT(d.gradient.norm(), 0);
  const auto [force, moment] = resultant(p.model, x, d.gradient);
  EXPECT_LT(force.norm(), 1e-12 * d.gradient.norm());
  EXPECT_LT(moment.norm(), 1e-12 * d.gradient.norm() * x.cwiseAbs().maxCoeff() * 10);
}

}  // namespace

TEST(MortarContact, FrozenEnergyMatchesItsDerivatives) {
  for (const char* gap : {"pointwise", "averaged"})
    for (const char* gradient : {"frozen", "exact"})
      for (const char* weights : {"consistent", "tapered"})
        for (bool stiff : {false, true}) {
          Options o;
          o.gap = gap, o.gradient = gradient, o.weights = weights;
          Problem flat(stack(0.03, stiff), o);
          expect_frozen_derivatives(flat, shaken(positions(flat.model), 3e-3, 3), 1e-5);
          Problem edge(tilted(0.02, turn(30, {1, 0.1, 0.2}), stiff), o);
          expect_frozen_derivatives(edge, shaken(positions(edge.model), 1e-3, 4), 1e-5);
        }
}

// The pressure of averaged gaps: kappa phi of each node's mean gap, linear in between; that of parallel faces is the pointwise one.
TEST(MortarContact, AveragedGapsGivePressuresLinearOverSlaveTriangles) {
  for (const bool parallel : {true, false}) {
    Options o;
    o.gap = "averaged";
    model::ModelInput in = stack(0.03, true);
    if (!parallel)
      for (Vec3& x : in.bodies[1].nodes) x.z() += 0.01 * x.x() + 0.005 * x.y() * x.x();
    Problem p(std::move(in), o);
    std::map<Index, double> area, mean;  // by slave node
    std::vector<model::ContactSample> samples;
    const std::vector<double> kind = p.report().values.at("mortar_contact/kind");
    for (std::size_t i = 0; i < kind.size(); ++i)
      if (kind[i] == 0) samples.push_back(p.samples()[i]);
    ASSERT_GT(samples.size(), 30u);
    for (const model::ContactSample& s : samples)
      for (int k = 0; k < 3; ++k) area[s.point[k]] += -s.weight[k] * s.area, mean[s.point[k]] += -s.weight[k] * s.area * s.gap;
    double pointwise = 0;
    for (const model::ContactSample& s : samples) {
      double pressure = 0;
      for (int k = 0; k < 3; ++k) pressure -= s.weight[k] * kKappa * effects::barrier::phi(mean[s.point[k]] / area[s.point[k]] / kHat);
      EXPECT_NEAR(s.pressure, pressure, 1e-11 * kKappa);
      pointwise = std::max(pointwise, std::abs(kKappa * effects::barrier::phi(s.gap / kHat) / s.pressure - 1));
    }
    if (parallel)
      EXPECT_LT(pointwise, 1e-12);
    else
      EXPECT_GT(pointwise, 1e-2);
  }
}

TEST(MortarContact, ForcesAndMomentsBalance) {
  for (const char* gap : {"pointwise", "averaged"})
    for (const char* gradient : {"frozen", "exact"})
      for (const char* weights : {"consistent", "tapered"})
        for (bool two_pass : {false, true}) {
          Options o;
          o.gap = gap, o.gradient = gradient, o.weights = weights, o.two_pass = two_pass, o.guard = 0.5;
          Problem flat(stack(0.03), o);
          expect_balance(flat, shaken(positions(flat.model), 5e-3, 3));
          Problem corner(tilted(0.02, turn(40, {1, 0.4, 0.2})), o);
          expect_balance(corner, shaken(positions(corner.model), 1e-3, 5));
        }
}

// The exact gap gradient is the derivative of the gap at a fixed slave point: the force on a slave triangle of one face sample
// agrees with finite differences of the gap found anew by projection. The frozen one does not.
TEST(MortarContact, ExactGradientIsThatOfTheProjectedGap) {
  for (const bool exact : {true, false}) {
    Options o;
    o.gradient = exact ? "exact" : "frozen";
    o.quadrature = "1";
    Problem p(tilted(0.01, turn(20, {1, 0, 0}), false), o);
    const fd::Vector x = positions(p.model);
    fd::effect_assemble(*p.contact, x, false);
    const std::vector<model::ContactSample> all = p.samples();
    const auto within = std::find_if(all.begin(), all.end(), [](const model::ContactSample& c) {  // on no edge: of a face
      return c.points == 6 && std::all_of(c.weight, c.weight + 6, [](double w) { return std::abs(w) > 1e-3; });
    });
    ASSERT_NE(within, all.end());
    const model::ContactSample s = *within;
    // Gap from the slave point with fixed weights along the slave normal to the master plane.
    const auto gap = [&](const fd::Vector& y) {
      Vec3 v[6], xs = Vec3::Zero();
      for (int k = 0; k < 6; ++k) v[k] = y.segment<3>(3 * s.point[k]);
      for (int k = 0; k < 3; ++k) xs -= s.weight[k] * v[k];
      const Vec3 n = (v[1] - v[0]).cross(v[2] - v[0]).normalized(), nm = (v[4] - v[3]).cross(v[5] - v[3]).normalized();
      return nm.dot(v[3] - xs) / nm.dot(n);
    };
    EXPECT_NEAR(gap(x), s.gap, 1e-14);
    const fd::Vector slope = fd::difference_gradient(gap, x, 1e-5);
    const double normal = std::sqrt(slope.segment<3>(3 * s.point[3]).squaredNorm() + slope.segment<3>(3 * s.point[4]).squaredNorm() +
                                    slope.segment<3>(3 * s.point[5]).squaredNorm());
    Vec3 published[6];
    double error = 0;
    for (int k = 3; k < 6; ++k) {
      published[k] = s.weight[k] * Vec3(s.normal[0], s.normal[1], s.normal[2]) * (s.force / (s.pressure * s.area));
      error = std::max(error, (published[k] - slope.segment<3>(3 * s.point[k])).norm() / normal);
    }
    if (exact)
      EXPECT_LT(error, 1e-8);
    else
      EXPECT_GT(error, 0.1);
  }
}

TEST(MortarContact, MovesRigidlyWithTheScene) {
  const Mat3 R = turn(50, {1, -2, 0.5});
  const Vec3 t(3, -1, 2);
  for (const char* weights : {"consistent", "tapered"}) {
    Options o;
    o.weights = weights, o.guard = 0.3;
    Problem p(tilted(0.02, turn(30, {1, 0.3, 0.2})), o);
    const fd::Vector x = shaken(positions(p.model), 1e-3, 7);
    fd::Vector moved = x;
    for (const model::Body& b : p.model.bodies)
      for (Index i = b.block_begin; i < b.block_end; ++i) {
        const bool column = b.type == model::BodyType::stiff && i > b.block_begin;
        moved.segment<3>(3 * i) = R * x.segment<3>(3 * i) + (column ? Vec3(Vec3::Zero()) : t);
      }
    const fd::Vector g = fd::effect_assemble(*p.contact, x, false).gradient;
    const double e = fd::effect_energy(*p.contact, x);
    const fd::Vector gm = fd::effect_assemble(*p.contact, moved, false).gradient;
    EXPECT_NEAR(fd::effect_energy(*p.contact, moved) / e, 1, 1e-11);
    double error = 0;
    for (Eigen::Index i = 0; i < x.size(); i += 3) error = std::max(error, (gm.segment<3>(i) - R * g.segment<3>(i)).norm());
    EXPECT_LT(error, 1e-11 * g.norm());
  }
}

// Parallel faces at gap g press with kappa phi(g/d_hat) everywhere, whichever the slave and the rule; the weights cover the
// overlap.
TEST(MortarContact, FlatFacesPressUniformly) {
  const double gap = 0.6 * kHat, p0 = kKappa * effects::barrier::phi(0.6);
  for (const char* quadrature : {"1", "3", "6", "7"})
    for (bool two_pass : {false, true})
      for (const char* slave : {"pad", "tool"}) {
        Options o;
        o.quadrature = quadrature, o.two_pass = two_pass, o.slave = slave, o.master = slave == o.slave && o.slave == "pad" ? "tool" : "pad";
        if (o.slave == "pad") o.master = "tool";
        Problem p(stack(gap, false, 3, 0.5), o);
        double area = 0;
        for (const model::ContactSample& s : p.samples()) {
          EXPECT_NEAR(s.pressure / p0, 1, 1e-11);
          area += s.area;
        }
        EXPECT_NEAR(area, 0.25, 1e-14);
        const Recorder r = p.report();
        EXPECT_NEAR(r("mortar_contact/force_tool_z"), 0.25 * p0, 1e-10 * p0);
        EXPECT_EQ(r("mortar_contact/force_share_faces"), 1);
        EXPECT_LE(r("mortar_contact/clip_partition_defect"), 1e-12);
        for (double v : r.values.at("contact_pressure")) EXPECT_TRUE(v == 0 || std::abs(v / p0 - 1) < 1e-11) << v;
      }
}

// A tool that leans over a pad presses a strip of it: a node's pressure is that over its area, not over what of it is within the layer.
TEST(MortarContact, PressuresTimesAreasAreTheForce) {
  const auto pad = geometry::box({1, 1, 0.5}, std::array<Index, 3>{4, 4, 1});
  auto tool = geometry::box({2, 2, 0.5}, std::array<Index, 3>{1, 1, 1});
  for (Vec3& x : tool.points) x = turn(4, {0, 1, 0}) * x;
  Problem p(scene({soft_body("pad", pad, gel()), soft_body("tool", tool, gel(), {0, 0, 0.5 + 0.05})}), {});
  const Recorder r = p.report();
  const std::vector<double> pressure = r.values.at("contact_pressure");
  const std::vector<Triangle> top = [&] {
    std::vector<Triangle> out;
    for (const Triangle& t : geometry::boundary_triangles(pad))
      if (std::all_of(t.v, t.v + 3, [&](Index v) { return pad.points[v].z() > 0.25 - 1e-12; })) out.push_back(t);
    return out;
  }();
  const std::vector<double> area = geometry::vertex_areas(pad.points, top);
  double sum = 0, reached = 0, all = 0;
  for (std::size_t i = 0; i < area.size(); ++i) sum += pressure[i] * area[i], all += pressure[i] > 0 ? area[i] : 0;
  for (const model::ContactSample& s : p.samples()) reached += s.area;
  ASSERT_LT(reached, 0.8 * all) << "most of the area of the nodes in contact is, and nothing is tested";
  EXPECT_NEAR(sum / -r("mortar_contact/force_pad_z"), 1, 1e-12);
}

// Tapered weights: what the taper takes from faces comes back by edges and points (the README of mortar_contact). The rule has to resolve the
// taper, hence the fine pad; with 24 cells master edges and vertices lie on slave edges and vertices and must count once.
TEST(MortarContact, TaperedWeightsConserveTheTotalLoad) {
  Options o;
  o.weights = "tapered", o.quadrature = "7";
  for (Index cells : {23, 24})
    for (double size : {0.5, 1.0}) {  // 1: the rims coincide
      const auto pad = geometry::box({1, 1, 0.5}, std::array<Index, 3>{cells, cells, 1});
      const auto tool = geometry::box({size, size, 0.5}, std::array<Index, 3>{2, 2, 1});
      Problem p(scene({soft_body("pad", pad, gel()), soft_body("tool", tool, gel(), {0, 0, 0.5 + 0.6 * kHat})}), o);
      const Recorder r = p.report();
      const double wanted = size * size * kKappa * effects::barrier::phi(0.6);
      EXPECT_NEAR(r("mortar_contact/force_tool_z") / wanted, 1, 0.015);
      EXPECT_NEAR(r("mortar_contact/force_share_faces"), 1 - 0.3 + 0.027, 0.01);
      EXPECT_NEAR(r("mortar_contact/force_share_points"), 0.003, 1e-3);
    }
}

// A ridge and a tip are seen by edge and point samples, which flat faces do not have.
TEST(MortarContact, SharpFeaturesHaveSamples) {
  Problem ridge(tilted(0.01, turn(45, {1, 0, 0})), {});
  EXPECT_GT(ridge.report()("mortar_contact/force_share_edges"), 0.1);
  Problem tip(tilted(0.01, turn(45, {1, 0, 0}) * turn(35, {0, 1, 0})), {});
  EXPECT_GT(tip.report()("mortar_contact/force_share_points"), 0.3);
}

// Half-space as master: the gap is exact, the force is that of the pressure on the area.
TEST(MortarContact, HalfSpaceIsAMaster) {
  Options o;
  o.slave = "pad", o.master = "floor";
  const double gap = 0.6 * kHat, p0 = kKappa * effects::barrier::phi(0.6);
  model::ModelInput in = stack(1);
  in.bodies.push_back(half_space("floor", {0, 0, -0.25 - gap}, {0, 0, 1}));
  Problem p(std::move(in), o);
  EXPECT_NEAR(p.report()("mortar_contact/force_pad_z"), p0, 1e-10 * p0);
  for (const model::ContactSample& s : p.samples()) {
    EXPECT_EQ(s.points, 3);
    EXPECT_EQ(s.body_b, 2);
    EXPECT_NEAR(s.weight[0] + s.weight[1] + s.weight[2], 1, 1e-15);
    EXPECT_EQ(s.normal[2], 1);
  }
  expect_frozen_derivatives(p, shaken(positions(p.model), 2e-3, 3), 1e-5);
}

// A block stands on one edge, turned by an angle theta: within d_hat there are strips of its lower face and of one side, much narrower than
// their triangles. With area cos theta as weight, what presses is kappa b(g) (cot theta + tan theta) per length, whatever the mesh;
// three points per strip find all but 5 % of it.
TEST(MortarContact, NarrowStripsOverAHalfSpaceAreSeen) {
  const double theta = 0.35, gap = 0.3 * kHat, expected = kKappa * effects::barrier::value(gap, kHat) * (1 / std::tan(theta) + std::tan(theta));
  const Mat3 R = Eigen::AngleAxisd(theta, Vec3::UnitY()).toRotationMatrix();
  for (Index cells : {1, 2, 3}) {
    model::BodyInput pad = soft_body("pad", geometry::box({1, 1, 0.5}, std::array<Index, 3>{cells, cells, 1}), gel());
    double low = 1e9;
    for (Vec3& x : pad.nodes) x = R * x, low = std::min(low, x.z());
    Options o;
    o.master = "floor";
    Problem p(scene({pad, half_space("floor", {0, 0, low - gap}, {0, 0, 1})}), o);
    EXPECT_NEAR(p.report()("mortar_contact/force_pad_z"), expected, 0.08 * expected) << cells;
  }
}

// Two thin plates over one slave: only the nearer presses.
TEST(MortarContact, OnlyTheNearestLayerPresses) {
  const auto plate = geometry::box({1, 1, 0.01}, std::array<Index, 3>{3, 3, 1});
  const auto alone = [&](std::vector<model::BodyInput> bodies, std::vector<std::string> masters) {
    bodies.insert(bodies.begin(), soft_body("pad", geometry::box({1, 1, 0.5}, std::array<Index, 3>{2, 2, 1}), gel()));
    model::Model m(scene(std::move(bodies)));
    Params p = params({}), pairs = Params::make_list();
    for (const std::string& master : masters) {
      Params pair = Params::make_table();
      pair.set("slave", Params::make_text("pad"));
      pair.set("master", Params::make_text(master));
      pairs.push(pair);
    }
    p.set("pairs", pairs);
    const auto contact = make_effect("mortar_contact", p, m);
    contact->begin_step({});
    Recorder r;
    contact->report(r);
    return r("mortar_contact/force_pad_z");
  };
  const auto near = soft_body("near", plate, gel(), {0, 0, 0.25 + 0.01 + 0.005});
  const auto far = soft_body("far", plate, gel(), {0, 0, 0.25 + 0.03 + 0.005});
  const double one = alone({near}, {"near"}), both = alone({near, far}, {"near", "far"});
  EXPECT_LT(one, 0);
  EXPECT_NEAR(both / one, 1, 1e-12);
}

// max_step: no corner of an overlap uses up more than nine tenths of its gap, even before any Gauss point sees it.
TEST(MortarContact, StepsKeepGaps) {
  Problem p(tilted(0.01, turn(10, {1, 0.2, 0})), {});
  fd::Vector down = fd::Vector::Zero(positions(p.model).size());
  const model::Body& tool = p.model.bodies[1];
  down[3 * tool.block_begin + 2] = -1;
  const device::Buffer<Vec3> q(fd::blocks_of(positions(p.model))), dq(fd::blocks_of(down));
  p.contact->linearise(q.view(), true);
  const double alpha = fd::longest_step(*p.contact, dq.view());
  EXPECT_LE(alpha, 0.0071);
  EXPECT_GE(alpha, 0.0069);
}

// Samples that a step brings into range take part in its line search.
TEST(MortarContact, LineSearchSeesWhatComesIntoRange) {
  Problem p(stack(1.05 * kHat), {});
  const fd::Vector x = positions(p.model);
  fd::Vector d = fd::Vector::Zero(x.size());
  const model::Body& tool = p.model.bodies[1];
  for (Index b = tool.block_begin; b < tool.block_end; ++b) d[3 * b + 2] = -0.5 * kHat;
  const device::Buffer<Vec3> q(fd::blocks_of(x)), dq(fd::blocks_of(d));
  p.contact->linearise(q.view(), true);
  fd::longest_step(*p.contact, dq.view());
  EXPECT_EQ(fd::effect_energy(*p.contact, x), 0);
  EXPECT_NEAR(fd::effect_energy(*p.contact, x + d) / (kKappa * effects::barrier::value(0.55 * kHat, kHat)), 1, 1e-10);
}

// A frozen gap that closes need not mean that surfaces meet: the energy goes on along its tangent, and collision detection has the say.
TEST(MortarContact, FrozenGapsMayClose) {
  Problem p(stack(0.5 * kHat), {});
  fd::Vector x = positions(p.model);
  fd::effect_assemble(*p.contact, x, true);
  const double at = fd::effect_energy(*p.contact, x) / effects::barrier::value(0.5 * kHat, kHat), least = 0.05 * kHat;
  ASSERT_GT(at, 0);
  const auto lower_by = [&](double way) {
    const model::Body& tool = p.model.bodies[1];
    for (Index b = tool.block_begin; b < tool.block_end; ++b) x[3 * b + 2] -= way;
    return fd::effect_energy(*p.contact, x) / at;
  };
  EXPECT_NEAR(lower_by(0.45 * kHat) / effects::barrier::value(least, kHat), 1, 1e-10);
  const double tangent = effects::barrier::value(least, kHat) - 0.25 * kHat * effects::barrier::first(least, kHat);
  EXPECT_NEAR(lower_by(0.25 * kHat) / tangent, 1, 1e-10);
}

// A half-space has no rim that a sample could slide over.
TEST(MortarContact, EnergyIsInfiniteOnAHalfSpace) {
  Options o;
  o.slave = "pad", o.master = "floor";
  model::ModelInput in = stack(1);
  in.bodies.push_back(half_space("floor", {0, 0, -0.25 - 0.5 * kHat}, {0, 0, 1}));
  Problem p(std::move(in), o);
  fd::Vector x = positions(p.model);
  fd::effect_assemble(*p.contact, x, true);
  EXPECT_TRUE(std::isfinite(fd::effect_energy(*p.contact, x)));
  const model::Body& pad = p.model.bodies[0];
  for (Index b = pad.block_begin; b < pad.block_end; ++b) x[3 * b + 2] -= 0.5 * kHat;
  EXPECT_EQ(fd::effect_energy(*p.contact, x), INFINITY);
}

// rest_share 1: nothing presses where it stands, and what moves nearer does.
TEST(MortarContact, RestShareLeavesTheStartAlone) {
  Options o;
  o.rest_share = 1;
  Problem p(stack(0.5 * kHat), o);
  EXPECT_EQ(fd::effect_assemble(*p.contact, positions(p.model), false).gradient.norm(), 0);
  fd::Vector x = positions(p.model);
  const model::Body& tool = p.model.bodies[1];
  for (Index b = tool.block_begin; b < tool.block_end; ++b) x[3 * b + 2] -= 0.2 * kHat;
  const fd::Vector g = fd::effect_assemble(*p.contact, x, false).gradient;
  double fz = 0;
  for (Index b = tool.block_begin; b < tool.block_end; ++b) fz -= g[3 * b + 2];
  EXPECT_NEAR(fz / (kKappa * effects::barrier::phi(0.6)), 1, 1e-10);
}

// Automatic stiffness: k = kappa b'' h / E* = 4 at the pressure it was chosen for, adapted between steps as far as energy allows, kept by
// checkpoints.
TEST(MortarContact, AutomaticStiffness) {
  Options o;
  o.stiffness = 0, o.d_hat = 2e-2;
  Problem p(stack(0.2 * o.d_hat), o);
  const auto stiffness = [&] { return p.report()("mortar_contact/stiffness_pad_tool"); };
  // What is reported after a step belongs to its solution; the next step begins with what was adapted.
  const auto adapted = [&](double budget) {
    const double solved = stiffness();
    p.contact->end_step(device::Buffer<Vec3>(fd::blocks_of(positions(p.model))).view());
    p.contact->adapt(budget);
    EXPECT_EQ(stiffness(), solved);
    p.contact->begin_step({});
    return stiffness();
  };
  const double first = p.report()("mortar_contact/stiffness_pad_tool");
  const double E = 1e5 / (1 - 0.09) / 2, h = mean_edge(p.model);
  // At 1 % of E*, the first guess.
  const double t = effects::barrier::phi_inverse(0.01 * E / first);
  EXPECT_NEAR(first * effects::barrier::second(t * o.d_hat, o.d_hat) * h / E, 4, 1e-6);
  // 0.2 d_hat presses far more, so kappa has to grow: by what the budget pays for.
  const double energy = fd::effect_energy(*p.contact, positions(p.model));
  EXPECT_EQ(adapted(0), first);
  const double more = adapted(0.1 * energy);
  EXPECT_GT(more, first);
  EXPECT_NEAR(fd::effect_energy(*p.contact, positions(p.model)), 1.1 * energy, 1e-9 * energy);
  const double second = adapted(INFINITY);
  EXPECT_GT(second, more);
  MemoryArchive archive;
  p.contact->end_step(device::Buffer<Vec3>(fd::blocks_of(positions(p.model))).view());
  p.contact->adapt(0);
  p.contact->checkpoint(archive);
  Problem again(stack(0.2 * o.d_hat), o);
  MemoryArchive loading = archive;
  loading.rewind();
  again.contact->checkpoint(loading);
  EXPECT_EQ(again.report()("mortar_contact/stiffness_pad_tool"), second);
  const fd::Vector x = positions(p.model);
  EXPECT_EQ(fd::effect_assemble(*again.contact, x, false).gradient, fd::effect_assemble(*p.contact, x, false).gradient);
}

// A restart keeps the support radii of the first start.
TEST(MortarContact, CheckpointsKeepSupports) {
  Options o;
  o.rest_share = 1;
  Problem first(stack(0.5 * kHat), o), second(stack(0.8 * kHat), o);
  fd::Vector x = positions(first.model);
  const model::Body& tool = first.model.bodies[1];
  for (Index b = tool.block_begin; b < tool.block_end; ++b) x[3 * b + 2] -= 0.1 * kHat;
  const fd::Vector g = fd::effect_assemble(*first.contact, x, false).gradient;
  EXPECT_NE(fd::effect_assemble(*second.contact, x, false).gradient, g);
  MemoryArchive archive;
  first.contact->checkpoint(archive);
  archive.rewind();
  second.contact->checkpoint(archive);
  EXPECT_EQ(fd::effect_assemble(*second.contact, x, false).gradient, g);
}

// The guard is the classic barrier within guard d_hat, with the weight kappa h^2 / 7 for every pair of primitives.
TEST(MortarContact, GuardIsTheClassicBarrier) {
  Options with, without;
  with.guard = 0.5;
  const auto input = [] { return tilted(0.01, turn(40, {1, 0.4, 0.2})); };
  Problem guarded(input(), with), bare(input(), without);
  model::Model m(input());
  const double range = 0.5 * kHat, weight = kKappa * mean_edge(m) * mean_edge(m) / 7;
  const auto classic = make_effect("barrier_contact", contact_params(range, weight / (range * range), "classic"), m);
  classic->begin_step({});
  const fd::Vector x = shaken(positions(m), 1e-3, 5);
  const fd::Dense a = fd::effect_assemble(*guarded.contact, x, true), b = fd::effect_assemble(*bare.contact, x, true);
  const fd::Dense c = fd::effect_assemble(*classic, x, true);
  ASSERT_GT(c.gradient.norm(), 0);
  EXPECT_LT((a.gradient - b.gradient - c.gradient).norm(), 1e-10 * a.gradient.norm());
  EXPECT_LT((a.hessian - b.hessian - c.hessian).norm(), 1e-10 * a.hessian.norm());
  EXPECT_NEAR(fd::effect_energy(*guarded.contact, x), fd::effect_energy(*bare.contact, x) + fd::effect_energy(*classic, x), 1e-12);
}

// The limit of a step by itself, without collision detection behind it: only frozen gaps of quadratic faces and half-spaces count.
TEST(MortarContact, FrozenGapsLimitSteps) {
  using namespace effects::mortar;
  const device::Buffer<Triangle> triangles({{{0, 1, 2}}, {{3, 5, 4}}});
  FrozenSamples f;
  // The master's lowest corner lies beyond the slave, whose corner (0, 0) sees it at height 0.2.
  f.y.upload({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0.1}, {3, -1, 0.3}, {-1, 3, 0.3}});
  Pair p{};
  p.under.count = 3;
  for (int k = 0; k < 3; ++k) p.under.point[k] = 3 + k;
  p.slave = 0, p.n = p.m = Vec3::UnitZ(), p.begin = 0, p.end = 1;
  for (Vec3& k : p.k) k = Vec3::Zero();
  const Sample s{SampleKind::face, 0, 1, 0.25, {1.0 / 3, 1.0 / 3, 1.0 / 3}, {0.5, 0.25, 0.25}};
  f.env_pairs = f.env_samples = {0, 1};
  f.samples.upload({s});
  MortarView view{};
  view.surface.triangles = triangles.view();
  std::vector<Vec3> down(6, Vec3::Zero());
  for (int k = 3; k < 6; ++k) down[k] = -Vec3::UnitZ();
  const device::Buffer<Vec3> dy(down);
  const auto limited = [&](Index master, bool quadratic) {
    p.master = master;
    p.on.count = quadratic ? 6 : 3, p.on.quarter = quadratic ? 0 : -1;
    for (int k = 0; k < p.on.count; ++k) p.on.point[k] = 0;
    for (int k = 0; k < 3; ++k) p.on.point[p.on.vertex(k)] = k;
    f.pairs.upload({p});
    std::vector<double> alpha{1};
    device::Fetch fetch;
    limit(view, f, dy.view(), 0.1, {alpha, fetch});
    fetch.now();
    return alpha[0];
  };
  EXPECT_EQ(limited(1, false), 1);
  EXPECT_NEAR(limited(1, true), 0.9 * 0.2, 1e-14) << "corner";
  EXPECT_NEAR(limited(-1, false), 0.9 * 0.25, 1e-14) << "sample";
}

TEST(MortarContact, BadPairsAreRefused) {
  for (const auto& [slave, master] : {std::pair{"pad", "nobody"}, {"nobody", "pad"}, {"pad", "pad"}}) {
    Options o;
    o.slave = slave, o.master = master;
    EXPECT_THROW(Problem(stack(0.01), o), Error) << slave << " " << master;
  }
}
