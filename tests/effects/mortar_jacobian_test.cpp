// The whole Jacobian of mortar contact and friction, H + U, against central differences of forces with everything fresh.
#include <gtest/gtest.h>

#include "contact_scene.h"
#include "geometry/midsides.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

constexpr double kHat = 0.05, kKappa = 1e4;

Params table(std::initializer_list<std::pair<std::string, Params>> entries) {
  Params p = Params::make_table();
  for (const auto& [key, value] : entries) p.set(key, value);
  return p;
}

struct How {
  std::string weights = "consistent", quadrature = "3", master = "tool", other = "", gradient = "frozen", gap = "pointwise";
  double mu = 0, guard = 0;
};

Params contact_of(const How& how) {
  std::vector<Params> pairs;
  for (const std::string& master : {how.master, how.other})
    if (!master.empty()) pairs.push_back(table({{"slave", Params::make_text("pad")}, {"master", Params::make_text(master)}}));
  return table({{"pairs", Params::make_list(pairs)},
                {"d_hat", Params::make_number(kHat)},
                {"stiffness", Params::make_number(kKappa)},
                {"weights", Params::make_text(how.weights)},
                {"taper_width", Params::make_number(0.1)},
                {"quadrature", Params::make_text(how.quadrature)},
                {"gap", Params::make_text(how.gap)},
                {"gradient", Params::make_text(how.gradient)},
                {"guard", Params::make_number(how.guard)},
                {"rest_share", Params::make_number(0)},
                {"two_pass", Params::make_flag(false)}});
}

Params friction_of(double mu) {
  return table({{"follows", Params::make_text("mortar_contact")},
                {"mu", Params::make_number(mu)},
                {"creep_speed", Params::make_number(0.5)},
                {"lag_tolerance", Params::make_number(1e-3)},
                {"lag_iterations", Params::make_number(20)}});
}

struct Problem {
  model::Model model;
  std::vector<std::unique_ptr<fd::Subject>> effects;  // contact, and friction that follows it

  Problem(model::ModelInput in, const How& how) : model(std::move(in)) {
    effects.push_back(make_effect("mortar_contact", contact_of(how), model));
    if (how.mu > 0) effects.push_back(make_effect("friction", friction_of(how.mu), model));
    for (auto& effect : effects) effect->begin_step({0, 0.01, 0, false});
  }
  // Everything fresh at x.
  void linearise(const fd::Vector& x, effects::Want want) {
    const device::Buffer<Vec3> q(fd::blocks_of(x));
    fd::Subject& contact = *effects[0];
    contact.effect->linearise(q.view(), want, contact.here());
    if (effects.size() == 1) return;
    contact.effect->sample(contact.here());
    if (want.whole) contact.effect->sample_changes(contact.here());
    effects[1]->effect->lag(contact.here().contact, effects[1]->here());
    effects[1]->effect->linearise(q.view(), want, effects[1]->here());
  }
  fd::Vector forces(const fd::Vector& x) {
    linearise(x, {});
    fd::Vector sum = fd::Vector::Zero(x.size());
    for (auto& effect : effects) sum += fd::dense(effect->here().stencils, x.size(), false).gradient;
    return sum;
  }
  // H + U; moving: of the field's samples too.
  fd::Matrix jacobian(const fd::Vector& x, bool moving = true) {
    effects::Want want = effects::Want::jacobian(effects::Curvature(true, 1));
    if (!moving) want.moving = false;
    linearise(x, want);
    fd::Matrix sum = fd::Matrix::Zero(x.size(), x.size());
    for (auto& effect : effects) {
      effects::Linearisation& at = effect->here();
      EXPECT_TRUE(!moving || effect->effect->complete(at));
      sum += fd::dense(at.stencils, x.size(), true).hessian;
      // U d for every unit vector d
      for (Eigen::Index i = 0; i < x.size() && at.unsymmetric.any(); ++i) {
        linalg::multiply(at.unsymmetric, false, device::Buffer<Vec3>(fd::blocks_of(fd::Vector::Unit(x.size(), i))).view(), at.of_unsymmetric());
        sum.col(i) += fd::dense(at.of_unsymmetric(), x.size(), false).gradient;
      }
    }
    return sum;
  }
};

// Of J against differences of forces, by directions.
double error(Problem& p, const fd::Vector& x) {
  const fd::Matrix J = p.jacobian(x);
  double worst = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const fd::Vector d = shaken(fd::Vector::Zero(x.size()), 1, seed);
    double least = 1;
    for (const double h : {1e-6, 1e-7}) {  // of bodies of size 1; a step may lead over a bend, where corners appear
      const auto at = [&](double s) { return p.forces(x + s * h * d); };
      const fd::Vector slope = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h);
      EXPECT_GT(slope.norm(), 0);
      least = std::min(least, (J * d - slope).norm() / slope.norm());
    }
    worst = std::max(worst, least);
  }
  return worst;
}

geometry::TetMesh block(Index cells, bool quadratic = false, double size = 1) {
  const auto mesh = geometry::box({size, size, 0.5}, std::array<Index, 3>{cells, cells, 1});
  return quadratic ? geometry::with_midsides(mesh) : mesh;
}

// A block over a pad, turned a little, `gap` above it; a wide one covers it.
model::ModelInput stack(double gap, bool stiff, double degrees, bool quadratic_pad = false, bool quadratic_tool = false, double width = 1.3) {
  model::ModelInput in;
  in.scene = Params::make_table();
  in.bodies.push_back(soft_body("pad", block(2, quadratic_pad), gel()));
  const geometry::TetMesh mesh = block(3, quadratic_tool, width);
  in.bodies.push_back(stiff ? stiff_body("tool", mesh, gel()) : soft_body("tool", mesh, gel()));
  const Mat3 R = Eigen::AngleAxisd(degrees * M_PI / 180, Vec3(0.3, 1, 0.2).normalized()).toRotationMatrix();
  double low = 1e9;
  for (Vec3& x : in.bodies.back().nodes) x = R * x, low = std::min(low, x.z());
  for (Vec3& x : in.bodies.back().nodes) x += Vec3(0.03, 0.02, 0.25 + gap - low);
  return in;
}

model::ModelInput on_floor(double gap, bool quadratic) {
  model::ModelInput in;
  in.scene = Params::make_table();
  in.bodies.push_back(soft_body("pad", block(2, quadratic), gel()));
  in.bodies.push_back(half_space("floor", {0, 0, -0.25 - gap}, {0, 0, 1}));
  return in;
}

}  // namespace

TEST(Jacobian, OfFacesIsThatOfForces) {
  for (double mu : {0.0, 0.5})
    for (const bool stiff : {false, true})
      for (const double degrees : {0.0, 1.0, 2.0})
        for (unsigned seed : {1u, 2u}) {
          Problem p(stack(0.02, stiff, degrees), {.mu = mu});
          const fd::Vector x = shaken(positions(p.model), 0.004, seed);
          const double e = error(p, x);
          EXPECT_LT(e, 1e-6) << "mu " << mu << " stiff " << stiff << " angle " << degrees << " seed " << seed;
        }
}

// Ridges and tips of the block above the pad, and of what is bent: neighbours take part.
TEST(Jacobian, OfEdgesAndTips) {
  for (double mu : {0.0, 0.5})
    for (const bool stiff : {false, true})
      for (const double degrees : {0.0, 1.0, 12.0, 40.0})
        for (const char* weights : {"consistent", "tapered"})
          for (const bool quadratic : {false, true}) {
            if (quadratic && (mu == 0 || degrees == 1)) continue;
            Problem p(stack(0.01, stiff, degrees, quadratic, false, 0.9), {.weights = weights, .mu = mu});
            const fd::Vector x = shaken(positions(p.model), 0.002, 6);
            EXPECT_LT(error(p, x), 1e-6) << "mu " << mu << " stiff " << stiff << " angle " << degrees << " " << weights << " quadratic " << quadratic;
          }
}

TEST(Jacobian, OfEveryRuleAndWeighting) {
  for (const char* weights : {"consistent", "tapered"})
    for (const char* quadrature : {"1", "3", "6", "7", "exact"}) {
      Problem p(stack(0.02, false, 1), {.weights = weights, .quadrature = quadrature});
      EXPECT_LT(error(p, shaken(positions(p.model), 0.004, 3)), 1e-6) << weights << " " << quadrature;
    }
}

TEST(Jacobian, OverAHalfSpace) {
  for (const bool quadratic : {false, true})
    for (double mu : {0.0, 0.5})
      for (const char* quadrature : {"3", "7", "exact"}) {
        Problem p(on_floor(0.03, quadratic), {.quadrature = quadrature, .master = "floor", .mu = mu});
        EXPECT_LT(error(p, shaken(positions(p.model), 0.01, 4)), 1e-6) << quadratic << " " << mu << " " << quadrature;
      }
}

TEST(Jacobian, OfQuadraticFaces) {
  for (double mu : {0.0, 0.5})
    for (const auto& [pad, tool] : {std::pair{true, false}, {true, true}, {false, true}})
      for (const bool stiff : {false, true}) {
        if (stiff && tool) continue;
        Problem p(stack(0.02, stiff, 1, pad, tool), {.mu = mu});
        EXPECT_LT(error(p, shaken(positions(p.model), 0.004, 5)), 1e-6) << mu << " " << pad << tool << stiff;
      }
}

// Along the master's normal, with the turning of the slave's.
TEST(Jacobian, OfTheThreeTermGradient) {
  for (double mu : {0.0, 0.5})
    for (const bool stiff : {false, true})
      for (const double degrees : {0.0, 2.0, 12.0, 40.0})
        for (const auto& [pad, tool] : {std::pair{false, false}, {true, false}, {true, true}}) {
          if (pad && (degrees != 2 || mu == 0 || (stiff && tool))) continue;
          const double least = degrees > 2 ? 0.01 : 0.02, width = degrees > 2 ? 0.9 : 1.3;
          Problem p(stack(least, stiff, degrees, pad, tool, width), {.gradient = "exact", .mu = mu});
          const fd::Vector x = shaken(positions(p.model), 0.002, 6);
          EXPECT_LT(error(p, x), 1e-6) << "mu " << mu << " stiff " << stiff << " angle " << degrees << " quadratic " << pad << tool;
        }
}

// A barrier per node, over what all samples around it make together.
TEST(Jacobian, OfAveragedGaps) {
  for (const bool stiff : {false, true})
    for (const double degrees : {0.0, 2.0, 12.0})
      for (const char* gradient : {"frozen", "exact"})
        for (const char* master : {"tool", "floor"}) {
          const bool floor = master == std::string("floor");
          if (floor && (stiff || degrees > 0)) continue;
          Problem p(floor ? on_floor(0.03, false) : stack(0.01, stiff, degrees, false, false, degrees > 2 ? 0.9 : 1.3),
                    {.master = master, .gradient = gradient, .gap = "averaged"});
          const fd::Vector x = shaken(positions(p.model), 0.002, 6);
          EXPECT_LT(error(p, x), 1e-6) << master << " stiff " << stiff << " angle " << degrees << " " << gradient;
        }
}

// A sheet between pad and block hides a part of the block, more of it where its rim lies nearer.
TEST(Jacobian, OfWhatOthersHide) {
  for (double mu : {0.0, 0.5})
    for (const bool stiff : {false, true})
      for (const char* weights : {"consistent", "tapered"})
        for (const double width : {0.9, 1.3}) {
          model::ModelInput in = stack(0.035, stiff, 0.5, false, false, width);
          in.bodies.push_back(soft_body("sheet", geometry::box({0.43, 0.37, 0.008}, std::array<Index, 3>{2, 1, 1}), gel()));
          for (Vec3& x : in.bodies.back().nodes) x += Vec3(0.05, -0.03, 0.25 + 0.01 + 0.004);
          Problem p(std::move(in), {.weights = weights, .other = "sheet", .mu = mu});
          const fd::Vector x = shaken(positions(p.model), 0.0015, 8);
          EXPECT_LT(error(p, x), 1e-6) << "mu " << mu << " stiff " << stiff << " " << weights << " width " << width;
        }
}

// The guard's samples rub too, and move with the points and edges they are between.
TEST(Jacobian, OfTheGuard) {
  for (const bool stiff : {false, true})
    for (const double degrees : {0.0, 12.0, 40.0}) {
      Problem p(stack(0.01, stiff, degrees, false, false, 0.9), {.mu = 0.5, .guard = 0.9});
      EXPECT_LT(error(p, shaken(positions(p.model), 0.002, 6)), 1e-6) << "stiff " << stiff << " angle " << degrees;
    }
  Problem p(on_floor(0.03, false), {.master = "floor", .mu = 0.5, .guard = 0.9});
  EXPECT_LT(error(p, shaken(positions(p.model), 0.01, 4)), 1e-6);
}

// Whether those of the field are asked for or not.
TEST(Jacobian, OfTheGuardBesideAFieldAtRest) {
  for (const bool floor : {false, true}) {
    fd::Matrix own[2], all;  // the guard's, without and with changes of the field
    for (const bool moving : {false, true}) {
      const auto jacobian = [&](double guard) {
        Problem p(floor ? on_floor(0.03, false) : stack(0.01, true, 12, false, false, 0.9),
                  {.master = floor ? "floor" : "tool", .mu = 0.5, .guard = guard});
        return p.jacobian(shaken(positions(p.model), 0.002, 6), moving);
      };
      all = jacobian(0.9);
      own[moving] = all - jacobian(0);
    }
    EXPECT_GT(own[1].norm(), 1e-3 * all.norm()) << floor;
    EXPECT_LT((own[0] - own[1]).norm(), 1e-12 * all.norm()) << floor;
  }
}

// What slips meets mu times all that presses, whether the field bears it or the guard; between two bodies both get the same.
TEST(Jacobian, FrictionIsThatOfFieldAndGuard) {
  for (const bool floor : {false, true}) {
    std::vector<model::ContactSample> field;
    for (const double guard : {0.0, 0.9}) {
      const double mu = 0.5;
      Problem p(floor ? on_floor(0.01, false) : stack(0.01, true, 0, false, false, 0.8),
                {.master = floor ? "floor" : "tool", .mu = mu, .guard = guard});
      fd::Vector x = positions(p.model);
      const auto blocks = [](const model::Body& b) {  // that sum up to the force on it
        return std::pair{b.block_begin, b.type == model::BodyType::soft ? b.block_end : b.block_begin + 1};
      };
      const model::Body& moved = p.model.bodies.back();
      for (auto [i, end] = blocks(moved); i < end; ++i) x[3 * i] += 0.02;  // by far more than it may creep
      p.linearise(x, {});
      const auto force = [&](int effect, const model::Body& b) {
        const fd::Vector g = fd::dense(p.effects[effect]->here().stencils, x.size(), false).gradient;
        Vec3 sum = Vec3::Zero();
        for (auto [i, end] = blocks(b); i < end; ++i) sum -= g.segment<3>(3 * i);
        return sum;
      };
      const std::vector<model::ContactSample> samples = p.effects[0]->here().contact.samples.download();
      Vec3 press = Vec3::Zero(), rub = Vec3::Zero();  // on what moves
      for (const model::ContactSample& s : samples) {
        const Vec3 n(s.normal[0], s.normal[1], s.normal[2]), along = Vec3::UnitX() - n.x() * n;
        const bool at_it = model::against_obstacle(s) || s.body_b == static_cast<Index>(p.model.bodies.size()) - 1;
        press += (at_it ? s.force : -s.force) * n, rub -= mu * s.force * along.normalized();
      }
      ASSERT_GT(press.z(), 0);
      EXPECT_LT((force(0, moved) - press).norm(), 1e-12 * press.norm()) << floor << " " << guard;
      EXPECT_LT((force(1, moved) - rub).norm(), 1e-12 * rub.norm()) << floor << " " << guard;
      if (!floor) {
        EXPECT_LT((force(1, moved) + force(1, p.model.bodies.front())).norm(), 1e-12 * rub.norm()) << guard;
      }
      // In one list, those of the field first: the guard does not change them.
      if (guard == 0) {
        field = samples;
        continue;
      }
      ASSERT_GT(samples.size(), field.size());
      for (std::size_t i = 0; i < field.size(); ++i) EXPECT_EQ(samples[i].force, field[i].force);
    }
  }
}
