#include "audit/certificate.h"

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "audit/contact_patch.h"
#include "place.h"

using namespace mortise;
using audit::Certificate;

namespace {

model::ModelInput scene() {
  Params solver = Params::make_table(), contact = Params::make_table(), friction = Params::make_table(), effects = Params::make_table(),
         root = Params::make_table();
  solver.set("relative_tolerance", Params::make_number(1e-6));
  contact.set("d_hat", Params::make_number(1e-3));
  friction.set("creep_speed", Params::make_number(1e-4));
  effects.set("mortar_contact", contact);
  effects.set("friction", friction);
  root.set("solver", solver);
  root.set("effects", effects);
  root.set("bodies", Params::make_table());
  return {root, {}};
}

// A state with a force balance of `defect` on forces of 10 N.
Snapshot state(double defect, double distance = 5e-4, double det = 0.9, double value = 1) {
  Snapshot sink;
  sink.scalar("balance", "gravity_x", "N", 0), sink.scalar("balance", "gravity_y", "N", 0), sink.scalar("balance", "gravity_z", "N", -10);
  sink.scalar("balance", "defect_x", "N", defect), sink.scalar("balance", "defect_y", "N", 0), sink.scalar("balance", "defect_z", "N", 0);
  sink.scalar("balance", "largest", "N", 10);
  sink.scalar("mortar_contact", "min_distance", "m", distance);
  sink.scalar("elasticity", "det_F_min", "1", det);
  sink.rows("mortar_contact", "gap", "m", 1, std::vector<double>{2e-4, 5e-4, 9e-4});
  sink.rows("mortar_contact", "force", "N", 1, std::vector<double>{0, 1, 1});
  sink.points("displacement", "m", 3, std::vector<double>{0, 0, value});
  sink.cells("cauchy_stress", "Pa", 1, std::vector<double>{NAN});  // of stiff bodies
  return sink;
}

solver::StepReport good() {
  solver::StepReport r;
  r.time = r.dt = 0.1, r.newton = 4, r.residual = 1e-9, r.tolerance = 1e-8;
  return r;
}

nlohmann::json certificate(double defect, Exit status = Exit::done, double distance = 5e-4, double det = 0.9, double value = 1,
                           const solver::StepReport& step = good()) {
  Certificate c(scene());
  c.state(state(0));
  c.state(state(defect, distance, det, value));
  c.step(step);
  return nlohmann::json::parse(c.json({"s", "abc", "cpu", status, ""}));
}

}  // namespace

TEST(Certificate, GradesByTheWorstBound) {
  EXPECT_EQ(certificate(1e-10)["grade"], "A");  // 1e-11 of 10 N
  EXPECT_EQ(certificate(1e-3)["grade"], "A");   // what residuals may leave
  const auto b = certificate(0.05);
  EXPECT_EQ(b["grade"], "B");
  EXPECT_EQ(b["grade_forces"], "B");
  EXPECT_EQ(b["reason"], "force_balance_defect is 0.005, more than 0.00101");
  EXPECT_DOUBLE_EQ(b["invariants"]["force_balance_defect_relative"], 5e-3);
  EXPECT_EQ(certificate(1)["grade"], "C");
}

// What the supports of a body do not bear, samples that do not add up to the forces on points, forces in the files that are not those of the
// solution, stiff bodies that are not.
TEST(Certificate, GradesWhatStatesSay) {
  const auto with = [](const char* group, const char* name, double value) {
    Certificate c(scene());
    Snapshot said = state(0);
    said.scalar("supports", "tool_defect", "N", 0);
    said.scalar(group, name, "1", value);
    c.state(said);
    c.step(good());
    return nlohmann::json::parse(c.json({"s", "abc", "cpu", Exit::done, ""}));
  };
  EXPECT_EQ(with("supports", "pad_defect", 1e-10)["grade"], "A");
  const auto b = with("supports", "pad_defect", 0.05);
  EXPECT_EQ(b["reason"], "support_balance_defect is 0.005, more than 0.00101");
  EXPECT_DOUBLE_EQ(b["invariants"]["support_balance_defect_N"], 0.05);
  EXPECT_DOUBLE_EQ(b["invariants"]["support_balance_defect_relative"], 5e-3);
  EXPECT_EQ(with("mortar_contact", "pressure_sum_defect", 1e-12)["grade"], "A");
  EXPECT_EQ(with("mortar_contact", "pressure_sum_defect", 1e-4)["grade"], "B");
  EXPECT_EQ(with("mortar_contact", "pressure_sum_defect", 1e-2)["grade"], "C");
  EXPECT_EQ(with("balance", "written_defect", 1e-3)["grade"], "B");  // contact of 0.459 N where supports bear 0.215 N
  EXPECT_EQ(with("balance", "written_defect", 2.4)["grade"], "C");
  EXPECT_EQ(with("affine_body", "rigidity_defect", 1e-4)["grade"], "A");
  EXPECT_EQ(with("affine_body", "rigidity_defect", 1.)["grade"], "C");
}

// A result is no better than its mesh: stresses that jump, pressures that alternate, a layer as thick as the indentation.
TEST(Certificate, GradesTheErrorsOfMeshes) {
  const auto with = [](const std::function<void(FieldSink&)>& add, bool at_start = false) {
    model::ModelInput input = scene();
    Params material = Params::make_table();
    material.set("youngs_modulus", Params::make_number(1e5)), material.set("poisson_ratio", Params::make_number(0.3));
    model::BodyInput pad;
    pad.name = "pad", pad.material = material;
    // Five nodes by five, and two tetrahedra somewhere under them; only the surface counts for pressures.
    for (double x : {0., 1., 2., 3., 4.})
      for (double y : {0., 1., 2., 3., 4.}) pad.nodes.push_back({x, y, 0});
    for (Index i = 0; i < 4; ++i)
      for (Index j = 0; j < 4; ++j) {
        const Index a = 5 * i + j;
        pad.triangles.push_back({{a, a + 5, a + 6}}), pad.triangles.push_back({{a, a + 6, a + 1}});
      }
    pad.nodes.push_back({0, 0, -1});
    pad.tets = {{{0, 1, 5, 25}}, {{6, 5, 1, 25}}};
    input.bodies.push_back(pad);
    Certificate c(input);
    Snapshot start = state(0), said = state(0);
    if (at_start)
      add(start);
    else
      add(said);
    c.state(start);
    c.state(said);
    c.step(good());
    return nlohmann::json::parse(c.json({"s", "abc", "cpu", Exit::done, ""}));
  };
  const auto stress = [](double one, double other) {
    return [=](FieldSink& sink) {
      std::vector<double> s(12, 0.0);
      s[2] = one, s[8] = other;
      sink.scalar("elasticity", "energy", "J", 1);
      sink.cells("cauchy_stress", "Pa", 6, s);
    };
  };
  EXPECT_EQ(with(stress(1e3, 1e3))["grade"], "A");
  const auto jump = with(stress(1e3, -1e3));
  EXPECT_EQ(jump["grade"], "C");
  EXPECT_EQ(std::string(jump["reason"]).substr(0, 12), "stress_error");
  EXPECT_EQ(std::string(jump["reason_forces"]).substr(0, 15), "stiffness_error");
  EXPECT_EQ(with(stress(1e3, -1e3), true)["grade"], "A") << "nothing is solved where a run starts";
  // Inner nodes carry 1 kPa, which is 1 kN each, but for the one in the middle.
  const auto pressure = [](double middle, double force) {
    return [=](FieldSink& sink) {
      std::vector<double> p(26, 0.0), f(78, 0.0);
      for (int i : {1, 2, 3})
        for (int j : {1, 2, 3}) p[5 * i + j] = 1e3, f[3 * (5 * i + j) + 2] = -1e3;
      p[12] = middle, f[3 * 12 + 2] = -force;
      sink.points("contact_pressure", "Pa", 1, p);
      sink.points("contact_force", "N", 3, f);
    };
  };
  EXPECT_EQ(with(pressure(1e3, 1e3))["grade"], "A");
  EXPECT_EQ(with(pressure(1.037e3, 1.037e3))["grade"], "B");
  EXPECT_NEAR(with(pressure(2e3, 2e3))["model"]["pressure_roughness"], 0.5, 1e-6);  // 1e3 of 2e3; no other node is in the interior
  EXPECT_NEAR(with(pressure(0, 0))["model"]["pressure_roughness"], 1, 1e-6) << "a node left out among others is no rim";
  EXPECT_EQ(with(pressure(2e3, 2e3), true)["grade"], "A");
  const auto uneven = with(pressure(1e3, 0.8e3));
  EXPECT_EQ(uneven["grade"], "C");
  EXPECT_EQ(uneven["grade_forces"], "A") << "their sum is right";
  EXPECT_NEAR(uneven["model"]["pressure_misfit"], 0.2, 1e-6);
  EXPECT_NEAR(uneven["model"]["pressure_roughness"], 0, 1e-6);
}

// A cube pressed from above and below: all its nodes are loaded, but what bears is the two faces that face the forces.
TEST(ContactPatch, EndsWhereNothingFacesTheForce) {
  model::ModelInput input = scene();
  model::BodyInput cube;
  for (double z : {0., 1.})
    for (double y : {0., 1.})
      for (double x : {0., 1.}) cube.nodes.push_back({x, y, z});
  for (const auto& [a, b, c, d] :
       std::vector<std::array<Index, 4>>{{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
    cube.triangles.push_back({{a, b, c}}), cube.triangles.push_back({{a, c, d}});
  input.bodies.push_back(cube);
  const std::vector<double> pressure(8, 1e3);
  std::vector<double> force(24, 0.0);
  for (int i = 0; i < 8; ++i) force[3 * i + 2] = i < 4 ? 250 : -250;
  const audit::ContactPatch patch(input);
  const auto nodes = patch.interior({pressure, force, {}});
  ASSERT_EQ(nodes.size(), 8u) << "the edge of a body is no rim";
  double area = 0;
  for (const auto& node : nodes) {
    for (const auto& [j, weight] : node.load) area += weight;
    for (Index j : node.ring) EXPECT_EQ(patch.rest()[j][2], patch.rest()[node.point][2]);
  }
  EXPECT_NEAR(area, 2, 1e-12) << "top and bottom";
}

// A pad of two triangles, held below and pressed by a held body to half of its way; the layer between them is a tenth of that.
TEST(Certificate, TheLayerCountsWhereATravelIsImposed) {
  const auto layer = [](double borne) {
    model::ModelInput input = scene();
    Params pin = Params::make_table(), pins = Params::make_list();
    pin.set("body", Params::make_text("pad"));
    pins.push(pin);
    Params effects = input.scene.at("effects");
    effects.set("pin", pins);
    input.scene.set("effects", effects);
    input.bodies.clear();
    model::BodyInput pad;
    pad.name = "pad", pad.type = model::BodyType::soft;
    pad.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
    input.bodies.push_back(pad);
    const std::vector<double> gap{0.01}, force{10}, bodies{0, 1}, pressure{20, 20, 20, 0};
    std::vector<double> moved(12, 0.0), contact(12, 0.0), support(12, 0.0);
    for (int i = 0; i < 3; ++i) moved[3 * i + 2] = -0.1, contact[3 * i + 2] = -10. / 3;
    support[11] = 10 * borne, support[9] = 1;
    return audit::LayerError::worst(audit::LayerError(input).travels({bodies, gap, force}, {moved, support, {}, contact, pressure}));
  };
  EXPECT_NEAR(layer(1), 0.1, 1e-12) << "a half-space, as body 1 is, bears what there is";
  EXPECT_NEAR(layer(0.75), 0.05, 1e-12) << "the rest is a load's";
  EXPECT_EQ(layer(0.5), 0);
}

// A stiff punch in the place of that body has no nodes of its own on which forces of supports are written, whatever holds it.
using Entries = std::vector<std::pair<const char*, Params>>;
Params texts(std::initializer_list<std::pair<const char*, const char*>> keys) {
  Params out = Params::make_table();
  for (const auto& [key, text] : keys) out.set(key, Params::make_text(text));
  return out;
}
Params with(Params to, const char* key, double v) {
  to.set(key, Params::make_number(v));
  return to;
}
Params with(Params to, const char* key, const std::vector<double>& v) {
  Params list = Params::make_list();
  for (double x : v) list.push(Params::make_number(x));
  to.set(key, list);
  return to;
}
model::ModelInput punched(const Entries& holds) {
  model::ModelInput input = scene();
  Params effects = input.scene.at("effects"), pins = Params::make_list();
  pins.push(texts({{"body", "pad"}}));
  effects.set("pin", pins);
  for (const auto& [effect, held] : holds) {
    Params list = effects.find(effect) ? *effects.find(effect) : Params::make_list();
    list.push(held);
    effects.set(effect, list);
  }
  input.scene.set("effects", effects);
  model::BodyInput pad, punch, arm;
  pad.name = "pad", punch.name = "punch", arm.name = "arm";
  pad.material = Params::make_table(), pad.material.set("youngs_modulus", Params::make_number(1e5)),
  pad.material.set("poisson_ratio", Params::make_number(0.3));
  punch.type = arm.type = model::BodyType::stiff;
  pad.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}}, punch.nodes = {{0, 0, 1}}, arm.nodes = {{0, 0, 2}};
  pad.tets = {{{0, 1, 2, 3}}}, pad.triangles = {{{0, 1, 2}}};
  input.bodies = {pad, punch, arm};
  return input;
}
struct Punched {
  std::vector<double> gap{0.01}, force{10}, bodies{0, 1}, pressure{20, 20, 20, 0, 20, 0}, moved = std::vector<double>(18, 0.0), contact = moved,
                                                                                          support = moved;
  Punched() {
    for (int i = 0; i < 3; ++i) moved[3 * i + 2] = -0.1, contact[3 * i + 2] = -10. / 3;
    contact[14] = 10, support[11] = 10;
  }
};
double layer_under_punch(const Entries& holds, const std::map<std::string, double>& number = {}) {
  const Punched p;
  return audit::LayerError::worst(
      audit::LayerError(punched(holds)).travels({p.bodies, p.gap, p.force}, {p.moved, p.support, {}, p.contact, p.pressure}, number));
}
const Params kSlide = with(texts({{"name", "lift"}, {"type", "prismatic"}, {"body", "punch"}}), "axis", {0, 0, 1});
const Params kHinge = with(with(texts({{"name", "lift"}, {"type", "revolute"}, {"body", "punch"}}), "axis", {0, 1, 0}), "at", {-2, 0, 1});
Params motor(double kp, const char* mode = "pd") { return with(texts({{"joint", "lift"}, {"mode", mode}}), "kp", kp); }

// What a motor gives is way that no soft body's stiffness decides: 0.1 of it by 10 N, and as much by the pad.
TEST(LayerError, ForcesFollowStiffnessAsFarAsSoftBodiesTakeTheWay) {
  const auto follows = [](const Entries& holds) {
    const Punched p;
    const auto travels = audit::LayerError(punched(holds)).travels({p.bodies, p.gap, p.force}, {p.moved, p.support, {}, p.contact, p.pressure});
    return travels.empty() ? 0 : travels.front().stiffness();
  };
  EXPECT_NEAR(follows({{"joint", kSlide}, {"drive", motor(100)}}), 0.5, 1e-12);
  EXPECT_NEAR(follows({{"joint", kSlide}, {"drive", motor(1e9)}}), 1, 1e-6);
  EXPECT_EQ(follows({{"joint", kSlide}}), 0) << "nothing imposes a travel";
}

TEST(Certificate, TheLayerCountsUnderAStiffBodyThatIsHeld) {
  const Params weld = texts({{"type", "fixed"}, {"body", "punch"}, {"to", "arm"}}), kinematic = texts({{"joint", "lift"}, {"mode", "kinematic"}});
  EXPECT_NEAR(layer_under_punch({{"pin", texts({{"body", "punch"}})}}), 0.1, 1e-12);
  EXPECT_NEAR(layer_under_punch({{"joint", kSlide}, {"drive", kinematic}}), 0.1, 1e-12);
  EXPECT_NEAR(layer_under_punch({{"joint", weld}, {"pin", texts({{"body", "arm"}})}}), 0.1, 1e-12);
  EXPECT_TRUE(std::isnan(layer_under_punch({{"joint", weld}}))) << "the arm is free";
  EXPECT_TRUE(std::isnan(layer_under_punch({{"joint", kSlide}}))) << "nothing drives it";
  EXPECT_TRUE(std::isnan(layer_under_punch({{"joint", kHinge}})));
  EXPECT_TRUE(std::isnan(layer_under_punch({})));
}

// A motor is a spring in series with the contact of 10 N and 0.1 m: g / (d + F/kp), and F lever^2 / kp of a hinge 2 m beside it.
TEST(Certificate, TheLayerCountsUnderAMotorAsFarAsItIsStiff) {
  EXPECT_NEAR(layer_under_punch({{"joint", kSlide}, {"drive", motor(100)}}), 0.05, 1e-12);
  EXPECT_NEAR(layer_under_punch({{"joint", kSlide}, {"drive", motor(1e9)}}), 0.1, 1e-8);
  EXPECT_NEAR(layer_under_punch({{"joint", kSlide}, {"drive", motor(1e-3)}}), 0, 1e-6);
  EXPECT_NEAR(layer_under_punch({{"joint", kHinge}, {"drive", motor(400)}}), 0.05, 1e-12);
  const Params across = with(kSlide, "axis", {1, 0, 0}), along = with(kHinge, "at", {0, 0, 5});
  EXPECT_NEAR(layer_under_punch({{"joint", across}, {"drive", motor(1e-3)}}), 0.1, 1e-12) << "the force does not move it";
  EXPECT_NEAR(layer_under_punch({{"joint", along}}), 0.1, 1e-12) << "nor this";
  // On an arm that has a motor of its own, and on one that follows: 1 m of punch are 3 m of the arm.
  const Params on_arm = texts({{"name", "wrist"}, {"type", "prismatic"}, {"body", "punch"}, {"to", "arm"}});
  Params arm = kSlide;
  arm.set("body", Params::make_text("arm"));
  const Params second = with(texts({{"joint", "wrist"}, {"mode", "passive"}}), "stiffness", 50);
  EXPECT_NEAR(layer_under_punch({{"joint", arm}, {"joint", with(on_arm, "axis", {0, 0, 1})}, {"drive", motor(100)}, {"drive", second}}), 0.01 / 0.4,
              1e-12);
  Params follows = with(on_arm, "axis", {0, 0, 1}),
         turned = with(texts({{"name", "wrist"}, {"type", "prismatic"}, {"body", "arm"}, {"to", "punch"}}), "axis", {0, 0, -1});
  for (Params wrist : {follows, turned}) {
    wrist.set("mimic", with(texts({{"joint", "lift"}}), "ratio", 2));
    EXPECT_NEAR(layer_under_punch({{"joint", arm}, {"joint", wrist}, {"drive", motor(900)}}), 0.05, 1e-12);
  }
}

// A motor at its limit gives a force, and no travel; one that would not be there without the layer does not.
TEST(Certificate, TheLayerDoesNotCountUnderAMotorAtItsLimit) {
  const Params limited = with(motor(100), "effort", 10);
  EXPECT_TRUE(std::isnan(layer_under_punch({{"joint", kSlide}, {"drive", limited}}, {{"drive/lift_error", 0.12}})))
      << "11 N wanted, were there no gap";
  EXPECT_NEAR(layer_under_punch({{"joint", kSlide}, {"drive", limited}}, {{"drive/lift_error", 0.105}}), 0.05, 1e-12);
  EXPECT_TRUE(std::isnan(layer_under_punch({{"joint", kSlide}, {"drive", texts({{"joint", "lift"}, {"mode", "effort"}})}})));
  // It pushes the joint on a stop of 10 N, half a range of 0.02 mm before its end: phi = 1.193, -phi' = 6.386 there.
  const Params stopped = with(kSlide, "travel_limits", {-1, 1});
  EXPECT_NEAR(layer_under_punch({{"joint", stopped}, {"drive", texts({{"joint", "lift"}, {"mode", "effort"}})}},
                                {{"joint/lift_travel", -1 + 1e-5}, {"joint/lift_stop", 10}}),
              0.01 / (0.1 + 2e-5 * 1.19315 / 6.38629), 1e-7);
}

// The punch between the pad, pressed by 10 N and 0.1 m under a gap of 0.01 m, and another one on top of it, by `above` and 0.3 m under 0.03 m;
// `moment` of that about y, on the punch.
double layer_between_pads(const Entries& holds, double above, double moment = 0) {
  model::ModelInput input = punched(holds);
  Params effects = input.scene.at("effects"), pins = *effects.find("pin");
  pins.push(texts({{"body", "top"}}));
  effects.set("pin", pins);
  input.scene.set("effects", effects);
  model::BodyInput top = input.bodies[0];
  top.name = "top";
  for (Vec3& x : top.nodes) x = Vec3(x[0], x[1], 2 - x[2]);
  input.bodies[2] = top;
  Punched p;
  p.pressure.resize(5), p.moved.resize(15), p.contact.resize(15), p.support.resize(15);
  p.contact[14] = 10 - above;
  for (int i = 0; i < 4; ++i) {
    p.pressure.push_back(i < 3 ? 20 : 0);
    for (double v : {0., 0., i < 3 ? 0.3 : 0}) p.moved.push_back(v);
    for (double v : {0., 0., i < 3 ? above / 3 : 0}) p.contact.push_back(v);
    for (double v : {0., 0., i < 3 ? 0 : -above}) p.support.push_back(v);
  }
  // Force and moment about the origin are those on the first body of each pair.
  const audit::LayerError::Samples samples{{0, 1, 1, 2}, {0.01, 0.03}, {10, above}, {0, 1, 1, 2}, {0, 0, -10, 0, 0, -above}, {0, 0, 0, 0, moment, 0}};
  return audit::LayerError::worst(audit::LayerError(input).travels(samples, {p.moved, p.support, {}, p.contact, p.pressure}));
}

// A lever: the hinge bears what the arms of its two pads make of their forces, and its moments balance. 10 N below, 2 m from the hinge at x = -2;
// `above` at 6 m.
TEST(Certificate, TheLayerCountsOnBothSidesOfALever) {
  const auto layer = [](double above) { return layer_between_pads({{"joint", kHinge}}, above, 4 * above); };
  EXPECT_NEAR(layer(10. / 3), (10 * 0.01 + 0.1) / (10 * 0.1 + 1), 1e-12);
  EXPECT_EQ(layer(10), 0) << "another moment bears half of it";
}

// Between stiff bodies whose way is given nothing gives way but the layer; whether they touch at all is a matter of their places.
TEST(LayerError, DecidesTheForceBetweenStiffBodiesWhoseWayIsGiven) {
  const auto layer = [](const Entries& holds, double moved, double other_force = 10) {
    Punched p;
    p.moved[14] = moved;
    const audit::LayerError::Samples samples{{0, 1, 1, 2}, {0.01, 0.01}, {other_force, 10}};
    return audit::LayerError::worst(audit::LayerError(punched(holds)).travels(samples, {p.moved, p.support, {}, p.contact, p.pressure}));
  };
  const Params kinematic = texts({{"joint", "lift"}, {"mode", "kinematic"}}), pinned_arm = texts({{"body", "arm"}}),
               pinned_punch = texts({{"body", "punch"}});
  const Params across = with(kSlide, "axis", {1, 0, 0});
  EXPECT_EQ(layer({{"pin", pinned_arm}, {"joint", kSlide}, {"drive", kinematic}}, 0.1), 1);
  EXPECT_EQ(layer({{"pin", pinned_arm}, {"joint", across}}, 0.1), 1);
  EXPECT_EQ(layer({{"pin", pinned_arm}, {"pin", pinned_punch}}, 0.1), 1);
  EXPECT_NEAR(layer({{"pin", pinned_arm}, {"pin", pinned_punch}}, 0), 0.1, 1e-12) << "they stay where they are: that of the pad";
  EXPECT_NEAR(layer({{"pin", pinned_arm}, {"pin", pinned_punch}}, 0.1, 110), 0.1, 1e-12) << "a tenth of the force on the pad";
  EXPECT_NEAR(layer({{"pin", pinned_arm}, {"joint", kSlide}, {"drive", motor(1e-3)}}, 0.1), 0, 1e-5);
}

// The last of states under the same pressure counts, with what the files have of its pairs and motors.
TEST(Certificate, TheLayerIsThatOfTheLastStateOfMostPressure) {
  const auto layer = [](std::vector<double> errors, const std::vector<double>& scale) {
    Certificate c(punched({{"joint", kSlide}, {"drive", with(motor(100), "effort", 10)}}));
    c.state(state(0));
    for (std::size_t i = 0; i < errors.size(); ++i) {
      Punched p;
      for (double& v : p.pressure) v *= scale[i];
      Snapshot said = state(0);
      said.points("displacement", "m", 3, p.moved), said.points("support_force", "N", 3, p.support), said.points("contact_force", "N", 3, p.contact);
      said.points("contact_pressure", "Pa", 1, p.pressure);
      said.rows("mortar_contact", "gap", "m", 1, p.gap), said.rows("mortar_contact", "force", "N", 1, p.force);
      said.rows("mortar_contact", "bodies", "1", 2, p.bodies), said.rows("mortar_contact", "pair_bodies", "1", 2, p.bodies);
      // Twice the force on this pair; the punch bears as much again elsewhere.
      said.rows("mortar_contact", "pair_force", "N", 3, std::vector<double>{0, 0, -20}),
          said.rows("mortar_contact", "pair_moment", "N m", 3, std::vector<double>(3, 0.0));
      said.scalar("drive", "lift_error", "m", errors[i]);
      c.state(said);
      c.step(good());
    }
    return nlohmann::json::parse(c.json({"s", "abc", "cpu", Exit::done, ""}))["model"]["layer_over_indentation"];
  };
  EXPECT_NEAR(layer({0.1}, {1}), 0.01 / 0.3, 1e-12);
  EXPECT_TRUE(layer({0.1, 0.2}, {1, 1}).is_null()) << "at its limit by then";
  EXPECT_NEAR(layer({0.1, 0.2}, {1, 0.9}), 0.01 / 0.3, 1e-12);
}

// A free body of 2 m between the world and a held stamp, pressed together by 0.2 m with 10 N and turned by a right angle.
TEST(Certificate, TheLayerCountsOnBothSidesOfWhatIsSqueezed) {
  const auto layer = [](double weight, bool held, bool within = false) {
    model::ModelInput input = scene();
    Params effects = input.scene.at("effects"), pins = Params::make_list();
    if (held) pins.push(texts({{"body", "stamp"}}));
    effects.set("pin", pins);
    input.scene.set("effects", effects);
    input.bodies.clear();
    model::BodyInput block, stamp;
    block.name = "block", block.type = model::BodyType::soft, stamp.name = "stamp", stamp.type = model::BodyType::stiff;
    stamp.nodes = {{0, 0, 2}};
    std::vector<double> moved(3, 0.0), contact{0, -10, 0};
    const std::vector<double> pressure(9, 20), none(27, 0.0);
    for (double z : {-1., 1.})
      for (double y : {-1., 1.})
        for (double x : {-1., 1.}) {
          block.nodes.push_back({x, y, z});
          for (double v : {0., -z * 0.9 - y, y - z}) moved.push_back(v);  // to (x, -0.9 z, y)
          for (double v : {0., z > 0 ? 10. / 4 : -(10 + weight) / 4, 0.}) contact.push_back(v);
        }
    input.bodies = {stamp, block};
    const audit::LayerError::Samples samples{{0, 1, 1, 2},      {0.01, 0.03}, {10, 10 + weight}, {0, 1, 1, 2}, {0, -10, 0, 0, -10 - weight, 0},
                                             {0, 0, 0, 0, 0, 0}};
    const audit::LayerError::Samples from_one{{0, 1, 0, 1}, {0.01, 0.03}, {10, 10 + weight}, {0, 1}, {0, weight, 0}, {0, 0, 0}};
    return audit::LayerError::worst(audit::LayerError(input).travels(within ? from_one : samples, {moved, none, {}, contact, pressure}));
  };
  EXPECT_NEAR(layer(0, true), 0.04 / 0.2, 1e-12);
  EXPECT_NEAR(layer(10, true), 0, 1e-12) << "half of the force below is a load's";
  EXPECT_TRUE(std::isnan(layer(0, false))) << "the stamp is a load";
  EXPECT_NEAR(layer(0, true, true), 0.04 / 0.2, 1e-12) << "in a slot of one body";
  EXPECT_TRUE(std::isnan(layer(10, true, true))) << "it lies in a groove by its weight";
}

// A stiff block between two pads that are held, each pressed to a tenth of its way by a layer: by itself, on a slide along the force or a hinge
// beside it, both gaps are in the way of both; on one across it, or where a motor holds the slide, each pad has its own.
TEST(Certificate, TheLayerCountsOnBothSidesOfWhatHangsOnAPassiveJoint) {
  const auto layer = [](const Entries& holds, double above = 10) { return layer_between_pads(holds, above); };
  EXPECT_NEAR(layer({}), 0.04 / 0.4, 1e-12);
  EXPECT_NEAR(layer({{"joint", kSlide}}), 0.04 / 0.4, 1e-12);
  EXPECT_EQ(layer({{"joint", kSlide}}, 20), 0) << "half of the force above is a load's";
  EXPECT_NEAR(layer({{"joint", with(kSlide, "axis", {1, 0, 0})}}), 0.1, 1e-12);
  EXPECT_NEAR(layer({{"joint", kHinge}}), 0.04 / 0.4, 1e-12);
  EXPECT_NEAR(layer({{"joint", kSlide}, {"drive", motor(1e9)}}), 0.1, 1e-8);
}

// `linear` takes a body that only turns for one that is stressed, and its stress is as smooth as can be.
TEST(Certificate, BodiesOfTheLinearLawDoNotTurn) {
  const auto turned = [](double angle, double stretch, const char* law = "linear") {
    model::ModelInput input = scene();
    model::BodyInput block;
    block.name = "block", block.material = texts({{"model", law}});
    block.material = with(with(block.material, "youngs_modulus", 1e5), "poisson_ratio", 0.3);
    block.nodes = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 1}}, block.tets = {{{0, 1, 2, 3}}};
    input.bodies.push_back(block);
    Certificate c(input);
    c.state(state(0));
    Snapshot said = state(0);
    std::vector<double> moved;
    for (const Vec3& x : block.nodes) {
      const Vec3 s((1 + stretch) * x[0], x[1], x[2]);
      for (double v : {std::cos(angle) * s[0] - std::sin(angle) * s[1] - x[0] + 3, std::sin(angle) * s[0] + std::cos(angle) * s[1] - x[1], 0.})
        moved.push_back(v);
    }
    said.points("displacement", "m", 3, moved);
    said.scalar("elasticity", "energy", "J", 1), said.cells("cauchy_stress", "Pa", 6, std::vector<double>(6, 1e3));
    c.state(said);
    c.step(good());
    return nlohmann::json::parse(c.json({"s", "abc", "cpu", Exit::done, ""}));
  };
  EXPECT_NEAR(turned(1, 0)["model"]["linear_law_turned"], 1, 1e-12);
  EXPECT_EQ(turned(1, 0)["grade"], "C");
  EXPECT_NEAR(turned(0, 0.1)["model"]["linear_law_turned"], 0, 1e-12);
  EXPECT_EQ(turned(0, 0.1)["grade"], "A");
  // sym(R U) - U with U = diag(1 + e, 1): (cos - 1) (1 + e, 1) on the diagonal, e/2 sin beside it
  const double e = 0.05, c = std::cos(0.1) - 1, s = 0.5 * e * std::sin(0.1), both = c * c * ((1 + e) * (1 + e) + 1) + 2 * s * s;
  EXPECT_NEAR(turned(0.1, e)["model"]["linear_law_turned"], std::sqrt(both / (both + e * e)), 1e-12);
  EXPECT_TRUE(turned(1, 0, "corotated")["model"]["linear_law_turned"].is_null());
}

TEST(Certificate, BalanceOfAClosedSystemIsAShareOfWhatSupportsBear) {
  Certificate c(scene());
  Snapshot said = state(1e-6);  // on a largest force of 10 N
  said.points("support_force", "N", 3, std::vector<double>{0, 0, 500, 0, 0, -500});
  c.state(said);
  c.step(good());
  EXPECT_DOUBLE_EQ(nlohmann::json::parse(c.json({"s", "abc", "cpu", Exit::done, ""}))["invariants"]["force_balance_defect_relative"], 1e-9);
}

TEST(Certificate, JudgesTheWorkOfSupportsWhereItIsAsked) {
  for (const std::string asked : {"supports/work", "audit/support_work", "audit/total_energy"}) {
    model::ModelInput input = scene();
    Params quantity = Params::make_table(), list = Params::make_list();
    quantity.set("value", Params::make_text(asked));
    list.push(quantity);
    input.scene.set("quantities", list);
    Certificate c(input);
    c.state(state(0));
    c.step(good());
    Certificate::End end{"s", "abc", "cpu", Exit::done, ""};
    end.energy.work_lag = 0.3;
    EXPECT_EQ(c.grade(end).all.letter, asked == "audit/total_energy" ? "A" : "C") << asked;
  }
}

TEST(Certificate, TellsTheEnergyThatWasGained) {
  Certificate c(scene());
  c.state(state(0));
  c.step(good());
  audit::EnergyAudit::Result energy;
  energy.support_work = 2, energy.largest_gain = 0.5, energy.scale = 10;
  auto known = nlohmann::json::parse(c.json({"s", "abc", "cpu", Exit::done, "", energy}))["invariants"];
  EXPECT_DOUBLE_EQ(known["support_work_J"], 2);
  EXPECT_DOUBLE_EQ(known["energy_gain_relative"], 0.05);
  energy.work_is_known = false, energy.largest_gain = NAN;
  auto unknown = nlohmann::json::parse(c.json({"s", "abc", "cpu", Exit::done, "", energy}))["invariants"];
  EXPECT_TRUE(unknown["support_work_J"].is_null());
  EXPECT_TRUE(unknown["energy_gain_relative"].is_null());
}

TEST(Certificate, RunsThatDidNotEndAreNeverGood) {
  EXPECT_EQ(certificate(0, Exit::solve)["grade"], "C");
  EXPECT_EQ(certificate(0, Exit::stopped)["grade"], "C");
  EXPECT_EQ(certificate(0, Exit::internal)["grade"], "F");
  Certificate none(scene());
  none.state(state(0));
  EXPECT_EQ(nlohmann::json::parse(none.json({}))["grade"], "F");
}

TEST(Certificate, InvalidStatesFail) {
  EXPECT_EQ(certificate(0, Exit::done, 0.0)["reason"], "surfaces touch or intersect");
  EXPECT_EQ(certificate(0, Exit::done, 5e-4, -0.1)["reason"], "an element is inverted (det F <= 0)");
  const auto nan = certificate(0, Exit::done, 5e-4, 0.9, NAN);
  EXPECT_EQ(nan["grade"], "F");
  EXPECT_EQ(nan["invariants"]["not_finite_values"], 1);  // and not the stress of stiff bodies
}

TEST(Certificate, TellsTheFirstReason) {
  const auto both = certificate(1, Exit::solve);
  EXPECT_EQ(both["grade"], "C");
  EXPECT_EQ(both["reason"], "a step did not converge");
  EXPECT_EQ(certificate(0, Exit::done, 0.0, -0.1)["reason"], "an element is inverted (det F <= 0)");
}

TEST(Certificate, TellsSolverAndModelFigures) {
  solver::StepReport halved = good();
  halved.substeps = 4, halved.newton = 9, halved.time = 0.1;
  const auto j = certificate(0, Exit::done, 5e-4, 0.9, 1, halved);
  EXPECT_EQ(j["grade"], "A");  // halving is no error
  EXPECT_EQ(j["solver"]["halved_steps"], 1);
  EXPECT_EQ(j["solver"]["newton_iterations_max"], 9);
  EXPECT_DOUBLE_EQ(j["model"]["contact"]["mortar_contact"]["gap_over_d_hat_min"], 0.5);  // of samples with force
  EXPECT_DOUBLE_EQ(j["model"]["contact"]["mortar_contact"]["gap_over_d_hat_max"], 0.9);
  EXPECT_DOUBLE_EQ(j["model"]["friction_creep_bound_m"], 1e-5);
}

TEST(Certificate, HasTheKeysOfItsSchema) {
  const auto j = certificate(0);
  std::ifstream file(test_place::kSourceFolder + "/schemas/certificate.schema.json");
  const auto schema = nlohmann::json::parse(file);
  const std::function<void(const nlohmann::json&, const nlohmann::json&, const std::string&)> compare = [&](const auto& value, const auto& s,
                                                                                                            const std::string& at) {
    if (!s.contains("properties")) return;
    for (const auto& key : s["required"]) EXPECT_TRUE(value.contains(key)) << at << "." << key;
    for (const auto& [key, v] : value.items()) {
      if (!s["properties"].contains(key)) {
        ADD_FAILURE() << at << "." << key << " is not in the schema";
        continue;
      }
      compare(v, s["properties"][key], at + "." + key);
    }
  };
  compare(j, schema, "");
  ASSERT_FALSE(j["checks"].empty());
  for (const auto& check : j["checks"]) compare(check, schema["properties"]["checks"]["items"], "checks");
}
