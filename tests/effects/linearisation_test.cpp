// A linearisation is a value: two at two states live side by side, and neither knows what the other was filled with.
#include <gtest/gtest.h>

#include "contact_scene.h"

using namespace mortise;
using namespace mortise::testing;
using effects::Effect;
using effects::Linearisation;
using effects::Want;

namespace {

constexpr double kHat = 0.05;

// A soft block over a soft pad, and a stiff one over a half-space.
model::ModelInput scene() {
  model::ModelInput in;
  in.scene = Params::make_table();
  const auto mesh = geometry::box({1, 1, 0.5}, std::array<Index, 3>{2, 2, 1});
  in.bodies.push_back(half_space("floor", {0, 0, -0.25 - 0.5 * kHat}, {0, 0, 1}));
  in.bodies.push_back(soft_body("pad", geometry::box({1, 1, 0.5}, std::array<Index, 3>{3, 3, 1}), gel()));
  in.bodies.push_back(soft_body("block", mesh, gel(), Vec3(0.05, 0.03, 0.5 + 0.6 * kHat)));
  in.bodies.push_back(stiff_body("stone", mesh, gel(), Vec3(2, 0, 0)));
  return in;
}

Params table(std::initializer_list<std::pair<std::string, Params>> entries) {
  Params p = Params::make_table();
  for (const auto& [k, v] : entries) p.set(k, v);
  return p;
}

Params mortar(const std::string& gap) {
  Params pair = table({{"slave", Params::make_text("pad")}, {"master", Params::make_text("block")}}),
         floor = table({{"slave", Params::make_text("stone")}, {"master", Params::make_text("floor")}});
  return table({{"pairs", Params::make_list({pair, floor})},
                {"d_hat", Params::make_number(kHat)},
                {"stiffness", Params::make_number(1e4)},
                {"weights", Params::make_text("consistent")},
                {"taper_width", Params::make_number(0.1)},
                {"quadrature", Params::make_text("3")},
                {"gap", Params::make_text(gap)},
                {"gradient", Params::make_text("frozen")},
                {"guard", Params::make_number(0.2)},
                {"rest_share", Params::make_number(0)},
                {"two_pass", Params::make_flag(false)}});
}

struct Whole {
  fd::Vector gradient;
  std::vector<Mat3> hessian;
  double energy = 0;
  std::vector<double> forces;  // of samples
  bool operator==(const Whole& o) const { return gradient == o.gradient && hessian == o.hessian && energy == o.energy && forces == o.forces; }
};

struct Case {
  std::string name;
  model::Model model;
  std::unique_ptr<Effect> contact, effect;  // the contact that it follows, if it does
  Case(const std::string& name, const Params& params, const Params* followed = nullptr) : name(name), model(scene()) {
    if (followed) contact = effects::find_kind("barrier_contact")->make(*followed, model);
    effect = effects::find_kind(name)->make(params, model);
    for (Effect* e : {contact.get(), effect.get()})
      if (e) e->connect();
    for (Effect* e : {contact.get(), effect.get()})
      if (e) e->begin_step({0, 0.01, 0, false});
  }
  void fill(const fd::Vector& x, Linearisation& at) {
    const device::Buffer<Vec3> q(fd::blocks_of(x));
    if (contact) {
      const auto of = contact->linearisation();
      contact->linearise(q.view(), Want::frozen(), *of);
      contact->sample(*of);
      effect->lag(of->contact, at);
    }
    effect->linearise(q.view(), {true, {true, 0.5}}, at);
    effect->sample(at);
  }
  // What `at` holds, and the energy a little beside its state x.
  Whole read(const fd::Vector& x, Linearisation& at) {
    Whole w;
    const linalg::StencilView s = at.stencils.view();
    w.gradient = fd::Vector::Zero(x.size());
    const auto block = fd::fetch(s.block);
    const auto grad = fd::fetch(s.grad);
    for (std::size_t i = 0; i < block.size(); ++i) w.gradient.segment<3>(3 * block[i]) += grad[i];
    w.hessian = fd::fetch(s.hess);
    const device::Buffer<Vec3> q(fd::blocks_of(shaken(x, 0.05 * kHat, 9)));
    w.energy = effect->energy_now(q.view(), at, 1);
    for (const model::ContactSample& c : at.contact.samples.download()) w.forces.push_back(c.force);
    return w;
  }
};

void expect_value(Case c) {
  const fd::Vector x = shaken(positions(c.model), 0.1 * kHat, 1), y = shaken(positions(c.model), 0.1 * kHat, 2);
  const auto alone = c.effect->linearisation(), first = c.effect->linearisation(), second = c.effect->linearisation();
  c.fill(y, *alone);
  const Whole at_y = c.read(y, *alone);
  c.fill(x, *first);
  const Whole at_x = c.read(x, *first);
  EXPECT_GT(at_x.gradient.norm(), 0) << c.name;
  c.fill(y, *second);
  EXPECT_TRUE(c.read(y, *second) == at_y) << c.name << ": depends on what another was filled with";
  EXPECT_TRUE(c.read(x, *first) == at_x) << c.name << ": changed as another was filled";
  c.fill(y, *first);
  EXPECT_TRUE(c.read(y, *first) == at_y) << c.name << ": depends on what it was filled with before";
}

}  // namespace

TEST(Linearisation, TwoLiveSideBySide) {
  const Params barrier = contact_params(kHat, 1e4), none = Params::make_table();
  expect_value({"elasticity", none});
  expect_value({"affine_body", table({{"stiffness", Params::make_number(1e6)}})});
  expect_value({"gravity", table({{"acceleration", vec({0, 0, -9.81})}})});
  expect_value({"inertia", table({{"integrator", Params::make_text("backward_euler")}})});
  expect_value({"barrier_contact", barrier});
  expect_value({"mortar_contact", mortar("pointwise")});
  expect_value(
      {"friction",
       table({{"follows", Params::make_text("barrier_contact")}, {"mu", Params::make_number(0.5)}, {"creep_speed", Params::make_number(0.1)}}),
       &barrier});
}

// Forces alone are the forces that come with a matrix, bit for bit.
TEST(Linearisation, ForcesDoNotDependOnWhatElseIsWanted) {
  for (const char* name : {"elasticity", "barrier_contact", "mortar_contact"}) {
    Case c(name, name == std::string("elasticity")        ? Params::make_table()
                 : name == std::string("barrier_contact") ? contact_params(kHat, 1e4)
                                                          : mortar("pointwise"));
    const fd::Vector x = shaken(positions(c.model), 0.1 * kHat, 1);
    const device::Buffer<Vec3> q(fd::blocks_of(x));
    const auto with = c.effect->linearisation(), without = c.effect->linearisation();
    c.fill(x, *with);
    c.effect->linearise(q.view(), {}, *without);
    EXPECT_EQ(c.read(x, *with).gradient, c.read(x, *without).gradient) << name;
  }
}
