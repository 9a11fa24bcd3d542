// barrier_contact as a whole: candidates, merged terms, stencils over degrees of freedom, samples, step limits.
#include <gtest/gtest.h>

#include "base/error.h"
#include "contact_scene.h"
#include "effects/contact/barrier.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

constexpr double kHat = 0.05, kKappa = 1e4;

struct Problem {
  model::Model model;
  std::unique_ptr<fd::Subject> contact;
  explicit Problem(model::ModelInput in, const std::string& form = "area_weighted", double d_hat = kHat)
      : model(std::move(in)), contact(make_effect("barrier_contact", contact_params(d_hat, kKappa, form), model)) {}
  const std::vector<model::ContactSample> samples() { return contact->samples(); }
};

model::ModelInput scene(std::vector<model::BodyInput> bodies) {
  model::ModelInput in;
  in.scene = Params::make_table();
  in.bodies = std::move(bodies);
  return in;
}

// Two soft boxes face to face with different meshes, `gap` apart; the upper one may be stiff.
model::ModelInput stack(double gap, bool stiff = false, Index upper_cells = 3) {
  const auto lower = geometry::box({1, 1, 0.5}, std::array<Index, 3>{2, 2, 1});
  const auto upper = geometry::box({1, 1, 0.5}, std::array<Index, 3>{upper_cells, upper_cells, 1});
  const Vec3 up(0, 0, 0.5 + gap);
  return scene({soft_body("lower", lower, gel()), stiff ? stiff_body("upper", upper, gel(), up) : soft_body("upper", upper, gel(), up)});
}

// A tilted stiff box whose corner and edges come close to a soft one, over a half-space.
model::ModelInput mixed(double gap) {
  auto stiff = stiff_body("tool", geometry::box({0.4, 0.4, 0.4}, 0.4), gel());
  const Mat3 R = (Eigen::AngleAxisd(0.7, Vec3(1, 0.3, 0.2).normalized()) * Eigen::AngleAxisd(0.4, Vec3::UnitZ())).toRotationMatrix();
  double low = 1e9;
  for (Vec3& x : stiff.nodes) x = R * x, low = std::min(low, x.z());
  for (Vec3& x : stiff.nodes) x.z() += 0.25 + gap - low;
  return scene({soft_body("pad", geometry::box({1, 1, 0.5}, 0.5), gel()), stiff, half_space("floor", {0, 0, -0.25 - gap}, {0, 0, 1})});
}

void expect_exact_derivatives(Problem& p, const fd::Vector& x, double h, const char* what) {
  const auto d = fd::effect_assemble(*p.contact, x, true);
  const auto g = fd::difference_gradient([&](const fd::Vector& y) { return fd::effect_energy(*p.contact, y); }, x, h);
  const double error = fd::relative_error(d.gradient, g);
  EXPECT_GT(d.gradient.norm(), 0) << what;
  EXPECT_LT(error, 1e-6) << what;
  EXPECT_GT(fd::lowest_eigenvalue(d.hessian), -1e-12) << what;
  const auto exact = fd::effect_assemble(*p.contact, x, effects::Curvature(true, 1));
  const auto H = fd::difference_jacobian([&](const fd::Vector& y) { return fd::effect_assemble(*p.contact, y, false).gradient; }, x, h / 20);
  EXPECT_LT(fd::relative_error(exact.hessian, H), 1e-5) << what;
  const auto half = fd::effect_assemble(*p.contact, x, effects::Curvature(true, 0.5));
  EXPECT_LT(fd::relative_error(half.hessian, fd::Matrix(0.5 * (d.hessian + exact.hessian))), 1e-12) << what;
  const auto [force, moment] = resultant(p.model, x, d.gradient);
  if (p.model.half_spaces.empty()) {
    EXPECT_LT(force.norm(), 1e-12 * d.gradient.norm()) << what;
    EXPECT_LT(moment.norm(), 1e-11 * d.gradient.norm()) << what;
  }
  std::printf("%s: gradient %.1e\n", what, error);
}

}  // namespace

TEST(BarrierContact, GradientMatchesEnergy) {
  for (const char* form : {"area_weighted", "classic"})
    for (bool stiff : {false, true}) {
      Problem p(stack(0.01, stiff), form);
      p.contact->begin_step({});
      expect_exact_derivatives(p, shaken(positions(p.model), 2e-3, 3), 5e-7, form);
    }
  for (const char* form : {"area_weighted", "classic"})
    for (double gap : {0.02, 0.004}) {
      Problem p(mixed(gap), form);
      p.contact->begin_step({});
      expect_exact_derivatives(p, shaken(positions(p.model), gap / 10, 5), 1e-4 * gap, form);
    }
}

// Crossing edges of two boxes, too close for the points to see each other.
TEST(BarrierContact, CrossingEdgesKeepApart) {
  auto roof = [](const std::string& name, double angle_z, double flip) {
    auto b = soft_body(name, geometry::box({1, 0.2, 0.2}, std::array<Index, 3>{1, 1, 1}), gel());
    const Mat3 R = (Eigen::AngleAxisd(angle_z, Vec3::UnitZ()) * Eigen::AngleAxisd(EIGEN_PI / 4, Vec3::UnitX())).toRotationMatrix();
    for (Vec3& x : b.nodes) x = R * x, x.z() += flip * 0.1 * std::sqrt(2.0);
    return b;
  };
  for (const char* form : {"area_weighted", "classic"}) {
    auto upper = roof("upper", 1.2, 1);
    for (Vec3& x : upper.nodes) x.z() += 0.005;
    Problem p(scene({roof("lower", 0, -1), upper}), form);
    p.contact->begin_step({});
    const auto x = shaken(positions(p.model), 1e-4, 1);
    expect_exact_derivatives(p, x, 1e-6, form);
    const auto [lower_force, unused] = resultant(p.model, x, fd::effect_assemble(*p.contact, x, false).gradient);
    EXPECT_LT(lower_force.norm(), 1e-9);
  }
}

// The sum of all sample areas is the common area, whatever the meshes, and the force is area times pressure.
TEST(BarrierContact, FlatFacesCarryTheirAreaOnce) {
  for (Index cells : {1, 2, 3, 5}) {
    const double gap = 0.6 * kHat;
    Problem p(stack(gap, false, cells));
    p.contact->begin_step({});
    double area = 0;
    for (const auto& s : p.samples()) area += s.area;
    EXPECT_NEAR(area, 1, 1e-12) << cells;
    Recorder r;
    p.contact->end_step(p.model.q.view());
    p.contact->report(r);
    const double pressure = kKappa * effects::barrier::phi(0.6);
    EXPECT_NEAR(r("barrier_contact/force_upper_z"), pressure, 1e-10 * pressure) << cells;
    EXPECT_NEAR(r("barrier_contact/force_lower_z"), -pressure, 1e-10 * pressure) << cells;
    EXPECT_NEAR(r("barrier_contact/min_distance"), gap, 1e-12);
  }
}

TEST(BarrierContact, BlockOnHalfSpaceObeysTheBarrierIdentity) {
  for (double P : {1e-3, 0.1, 1.0, 10.0}) {
    const double gap = kHat * effects::barrier::phi_inverse(P);
    Problem p(scene({soft_body("block", geometry::box({1, 1, 0.5}, 0.25), gel()), half_space("floor", {0, 0, -0.25 - gap}, {0, 0, 1})}));
    p.contact->begin_step({});
    const auto g = fd::effect_assemble(*p.contact, positions(p.model), false).gradient;
    const auto [force, moment] = resultant(p.model, positions(p.model), g);
    EXPECT_NEAR(force.z() / (kKappa * P), 1, 1e-8);
    EXPECT_NEAR(force.head<2>().norm(), 0, 1e-12 * force.z());
    for (const auto& s : p.samples()) EXPECT_NEAR(s.pressure / (kKappa * P), 1, 1e-8);
  }
}

// The terms of a state that was foreseen are there without waiting, with the same bits; at any other state they are found as ever.
TEST(BarrierContact, TermsOfAForeseenStateAreThere) {
  Problem p(mixed(0.01));
  p.contact->begin_step({});
  const auto forces = [&](const fd::Vector& x, bool foreseen, bool ask, long long& waits) {
    const device::Buffer<Vec3> q(fd::blocks_of(x));
    if (ask) {
      device::Fetch fetch;
      p.contact->effect->foresee(q.view(), *p.contact->at, fetch);
      fetch.now();
    }
    const long long before = device::transfers().to_host;
    effects::Want want{true, true};
    want.foreseen = foreseen;
    p.contact->effect->linearise(q.view(), want, *p.contact->at);
    waits = device::transfers().to_host - before;
    const linalg::StencilView v = p.contact->at->stencils.view();
    device::Buffer<Vec3> g(v.grad.n);
    device::copy(g.view().p, v.grad.p, v.grad.n * sizeof(Vec3));
    return g.download();
  };
  const fd::Vector x = shaken(positions(p.model), 1e-3, 5), other = shaken(x, 1e-3, 6);
  long long waits = 0;
  const auto here = forces(x, false, false, waits), there = forces(other, false, false, waits);
  ASSERT_NE(here, there);
  EXPECT_GT(waits, 0);
  EXPECT_EQ(forces(x, true, true, waits), here);
  EXPECT_EQ(waits, 0);
  EXPECT_EQ(forces(other, false, true, waits), there);
  EXPECT_EQ(forces(x, true, false, waits), here) << "what was foreseen is used once";
  EXPECT_GT(waits, 0);
}

// Away from the closest feature all terms of a flat surface cancel, so each vertex has one sample.
TEST(BarrierContact, TermsThatCancelDisappear) {
  Problem p(stack(0.6 * kHat));
  p.contact->begin_step({});
  EXPECT_EQ(p.samples().size(), 9u + 16u);
}

// Energy and gradient along a slide of one surface over the other's edges and vertices do not jump.
TEST(BarrierContact, SlidingAcrossEdgesIsSmooth) {
  Problem p(stack(0.6 * kHat, true));
  p.contact->begin_step({});
  const auto x0 = positions(p.model);
  const Index first = p.model.bodies[1].block_begin;
  auto at = [&](double s) {
    fd::Vector x = x0;
    x[3 * first] += s, x[3 * first + 1] += 0.37 * s, x[3 * (first + 1) + 2] += 0.02;
    return x;
  };
  double last = fd::effect_energy(*p.contact, at(0)), scale = last;
  fd::Vector g = fd::effect_assemble(*p.contact, at(0), false).gradient;
  const double norm = g.norm();
  for (int i = 1; i <= 2000; ++i) {
    const double e = fd::effect_energy(*p.contact, at(i * 1e-4));
    const fd::Vector h = fd::effect_assemble(*p.contact, at(i * 1e-4), false).gradient;
    EXPECT_LT(std::abs(e - last), 2e-3 * scale) << i;
    EXPECT_LT((h - g).norm(), 2e-2 * norm) << i;
    last = e, g = h;
  }
}

// In a concave corner two faces see the same vertex, and a term of negative weight takes one of the two back. Those who follow the
// published forces (friction) must see that, too, or the vertex would count twice there.
TEST(BarrierContact, SamplesCarryTheForcesOnPointsInAConcaveCorner) {
  auto valley = geometry::box({1, 1, 0.5}, std::array<Index, 3>{2, 2, 1});
  for (Vec3& x : valley.points)
    if (x.x() == 0 && x.z() > 0) x.z() -= 0.1;
  auto tool = geometry::box({0.3, 0.3, 0.3}, std::array<Index, 3>{1, 1, 1});
  const Mat3 R = (Eigen::AngleAxisd(std::atan(std::sqrt(2.0)), Vec3(1, 1, 0).normalized())).toRotationMatrix();
  double low = 1e9;
  for (Vec3& x : tool.points) x = R * x, low = std::min(low, x.z());
  Problem p(scene({soft_body("valley", valley, gel()), soft_body("tool", tool, gel(), {0, 0.13, 0.15 - low + 0.6 * kHat})}));
  p.contact->begin_step({});
  p.contact->end_step(std::as_const(p.model.q).view());
  std::vector<Vec3> force(p.model.points, Vec3::Zero());
  double least = 0;
  for (const model::ContactSample& s : p.samples()) {
    least = std::min(least, s.force);
    for (Index k = 0; k < s.points; ++k) force[s.point[k]] += s.force * s.weight[k] * Vec3(s.normal[0], s.normal[1], s.normal[2]);
  }
  EXPECT_LT(least, 0);
  const auto g = fd::blocks_of(fd::effect_assemble(*p.contact, positions(p.model), false).gradient);
  double norm = 0;
  for (const Vec3& f : g) norm = std::max(norm, f.norm());
  EXPECT_GT(norm, 0);
  for (std::size_t i = 0; i < g.size(); ++i) EXPECT_LT((force[i] + g[i]).norm(), 1e-12 * norm) << i;
}

TEST(BarrierContact, EnergyIsTheSameOnAndOffTheSweptPath) {
  Problem p(mixed(0.02)), fresh(mixed(0.02));
  p.contact->begin_step({}), fresh.contact->begin_step({});
  const auto x = positions(p.model);
  const auto end = shaken(x, 0.01, 9);
  const device::Buffer<Vec3> q(fd::blocks_of(x)), dq(fd::blocks_of(end - x));
  const double alpha = fd::longest_step(*p.contact, dq.view());
  EXPECT_GT(alpha, 0);
  EXPECT_LE(alpha, 1);
  const fd::Vector y = x + 0.5 * alpha * (end - x);
  EXPECT_NEAR(fd::effect_energy(*p.contact, y), fd::effect_energy(*fresh.contact, y), 1e-12 * fd::effect_energy(*p.contact, y));
}

TEST(BarrierContact, StepsStopBeforeContact) {
  for (bool plane : {false, true}) {
    Problem p(plane ? scene({soft_body("block", geometry::box({1, 1, 0.5}, 0.5), gel()), half_space("floor", {0, 0, -0.26}, {0, 0, 1})})
                    : stack(0.01));
    p.contact->begin_step({});
    auto q = p.model.q.download();
    std::vector<Vec3> down(q.size(), Vec3::Zero());
    const auto& mover = p.model.bodies.back();
    for (Index b = mover.block_begin; b < mover.block_end; ++b) down[b] = Vec3(0, 0, -1);
    const device::Buffer<Vec3> dq(down);
    const double alpha = fd::longest_step(*p.contact, dq.view());
    EXPECT_LE(alpha, 0.007 * (1 + 1e-9)) << plane;  // at least 30 % of the gap of 0.01 stays
    EXPECT_GT(alpha, 0.0069) << plane;
    // What would pass through costs an infinite energy only by touching; NaN is infinite too.
    fd::Vector x = positions(p.model);
    x[0] = std::nan("");
    EXPECT_EQ(fd::effect_energy(*p.contact, x), INFINITY);
    if (plane) {
      EXPECT_EQ(fd::effect_energy(*p.contact, positions(p.model) + fd::flatten(down)), INFINITY);
    }
  }
}

TEST(BarrierContact, BodiesMustStartApart) {
  auto message = [](model::ModelInput in) -> std::string {
    Problem p(std::move(in));
    try {
      p.contact->begin_step({});
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::scene);
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(message(stack(1e-6)), "");
  auto overlapping = stack(-0.1);
  for (Vec3& x : overlapping.bodies[1].nodes) x += Vec3(0.03, 0.05, 0);
  const std::string crossing = message(overlapping);
  EXPECT_NE(crossing.find("'lower'"), std::string::npos) << crossing;
  EXPECT_NE(crossing.find("'upper'"), std::string::npos) << crossing;
  EXPECT_NE(crossing.find("passes through triangle"), std::string::npos) << crossing;
  const std::string touching = message(stack(0));
  EXPECT_NE(touching.find("touches"), std::string::npos) << touching;
  const std::string below = message(scene({soft_body("block", geometry::box({1, 1, 1}, 1), gel()), half_space("floor", {0, 0, -0.4}, {0, 0, 1})}));
  EXPECT_NE(below.find("half-space 'floor'"), std::string::npos) << below;
}

TEST(BarrierContact, ExactlyTheChosenPairsTouch) {
  auto energy = [](const char* a, const char* b) {
    model::Model m(mixed(0.02));
    Params p = contact_params(kHat, kKappa);
    p.set("pairs", Params::make_list({Params::make_list({Params::make_text(a), Params::make_text(b)})}));
    auto contact = make_effect("barrier_contact", p, m);
    contact->begin_step({});
    return fd::effect_energy(*contact, positions(m));
  };
  Problem all(mixed(0.02));
  all.contact->begin_step({});
  const double tool = energy("tool", "pad"), floor = energy("floor", "pad");
  EXPECT_GT(tool, 0);
  EXPECT_GT(floor, 0);
  EXPECT_NEAR(tool + floor, fd::effect_energy(*all.contact, positions(all.model)), 1e-12 * floor);
  EXPECT_EQ(energy("tool", "floor"), 0);
  EXPECT_THROW(energy("tool", "nobody"), Error);

  // No forces between bodies whose motion is prescribed: what keeps them apart is that the step fails.
  model::Model held(stack(0.01));
  for (model::Body& body : held.bodies) body.carriage = model::Body::kStill;
  const auto between = make_effect("barrier_contact", contact_params(kHat, kKappa), held);
  between->begin_step({});
  EXPECT_EQ(fd::effect_energy(*between, positions(held)), 0);
}

TEST(BarrierContact, EnvironmentsDoNotSeeEachOther) {
  auto one = mixed(0.02);
  auto two = mixed(0.02), more = mixed(0.02);
  for (auto& b : more.bodies)
    if (b.type != model::BodyType::half_space) b.env = 1, two.bodies.push_back(b);
  Problem single(std::move(one)), both(std::move(two));
  single.contact->begin_step({}), both.contact->begin_step({});
  const auto expected = fd::effect_energies(*single.contact, positions(single.model));
  const auto got = fd::effect_energies(*both.contact, positions(both.model), 2);
  EXPECT_EQ(got[0], expected[0]);
  EXPECT_EQ(got[1], expected[0]);
  const auto& offset = both.contact->here().contact.env_offset;
  EXPECT_EQ(offset[1], offset[2] - offset[1]);
  const auto samples = both.samples();
  for (Index i = 0; i < offset[2]; ++i) EXPECT_EQ(samples[i].env, i < offset[1] ? 0 : 1);
}

// The first frame is written before the first step.
TEST(BarrierContact, ReportsBeforeTheFirstStep) {
  Problem p(stack(0.6 * kHat));
  Recorder r;
  p.contact->report(r);
  EXPECT_EQ(r.values["contact_pressure"].size(), static_cast<std::size_t>(p.model.points));
  EXPECT_GT(r("barrier_contact/force_upper_z"), 0);
}

// H27: a plate much thinner than d_hat, with triangles smaller than d_hat. At rest it must not push itself apart; squeezed flat it must.
TEST(BarrierContact, SelfContactIsSilentAtRestAndActsWhereSidesMeet) {
  for (const char* form : {"area_weighted", "classic"}) {
    const double thickness = kHat / 5;
    auto plate = soft_body("plate", geometry::box({0.1, 0.1, thickness}, std::array<Index, 3>{3, 3, 1}), gel());
    plate.params = body_params(Vec3::Zero(), Vec3::Zero(), true);
    Problem p(scene({plate}), form);
    p.contact->begin_step({});
    const fd::Vector rest = positions(p.model);
    EXPECT_EQ(fd::effect_energy(*p.contact, rest), 0) << form;
    EXPECT_EQ(fd::effect_assemble(*p.contact, rest, false).gradient.norm(), 0) << form;

    fd::Vector flat = rest;
    for (Eigen::Index i = 2; i < flat.size(); i += 3) flat[i] *= 0.4;  // sides at 0.4 of their distance at rest
    flat = shaken(flat, 1e-4, 7);
    const auto squeezed = fd::effect_assemble(*p.contact, flat, false);
    double apart = 0;
    for (Eigen::Index i = 2; i < flat.size(); i += 3)
      if (squeezed.gradient[i] != 0) apart += -squeezed.gradient[i] * (rest[i] > 0 ? 1 : -1);
    EXPECT_GT(apart, 0) << form;
    expect_exact_derivatives(p, flat, 1e-8, form);
  }
}
