// Reading scenes with tables of our own, so that these tests do not change with the effects.
#include "scene/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "check_table.h"
#include "scene/differences.h"
#include "scene/quantity.h"
#include "scene/schema.h"
#include "scene/suggest.h"
#include "scene/tables.h"

namespace mortise::scene {
namespace {

using testing::HasSubstr;
using testing::Not;
using namespace param;
using Kind = Param::Kind;

const ParamTable kSpin{"spin", "", {of(Kind::numbers, "angle", Unit::angle, {}, "Angles.")}};
const ParamTable kMove{"move",
                       "",
                       {of(Kind::text, "body", Unit::none, {}, "Body."), of(Kind::numbers, "time", Unit::time, {}, "Times."),
                        optional(of(Kind::vec3s, "translation", Unit::length, {}, "Translations.")), table("spin", &kSpin, "Rotation.")}};
const ParamTable kMoves = [] {
  ParamTable t = kMove;
  t.is_list = true;
  return t;
}();
const ParamTable kEmpty{"inertia", "", {}};
const ParamTable kSides{"sides", "", {of(Kind::text, "slave", Unit::none, {}, "Body.")}};
const ParamTable kLoad{
    "load",
    "",
    {of(Kind::schedule, "pressure", Unit::pressure, "0", "Pressure."), optional(of(Kind::text, "follows", Unit::none, {}, "Effect.")),
     table("side", &kSides, "Bodies."), optional(of(Kind::pairs, "pairs", Unit::none, {}, "Pairs.")),
     range(number("mu", Unit::none, "0.5", 0, "Coefficient."), 0, 10), of(Kind::flag, "on", Unit::none, "true", "Switch.")}};
const std::vector<EffectTable> kEffects{{"inertia", "One.", &kEmpty, {}, {}, true},
                                        {"elasticity", "Two.", &kEmpty},
                                        {"affine_body", "Three.", &kEmpty},
                                        {"load", "Four.", &kLoad},
                                        {"move", "Five.", &kMoves}};

const std::string kBase = R"(mortise: 1
time: {step: 5 ms, steps: 3}
materials: {gel: {youngs_modulus: 0.4 MPa, poisson_ratio: 0.45, density: 1 g/cm^3}}
bodies:
  ball: {type: soft, shape: {sphere: {radius: 3 mm, edge_length: 1 mm}}, material: gel}
effects:
  inertia: {}
  elasticity:
)";

Params read(const std::string& text, const std::vector<std::string>& set = {}) { return read_scene_text(text, "s.yaml", set, kEffects).root; }

// The whole message; "" when the scene is fine.
std::string message(const std::string& text, const std::vector<std::string>& set = {}) {
  try {
    read(text, set);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(Scene, FillsDefaultsInSI) {
  const Params s = read(kBase + "  load: {pressure: {time: [0, 1 ms], value: [0, 2 kPa]}}\n");
  EXPECT_EQ(s.at("time").number("step"), 5e-3);
  EXPECT_EQ(s.at("time").integer("frame_every"), 1);
  const Params& gel = s.at("materials").at("gel");
  EXPECT_EQ(gel.number("youngs_modulus"), 4e5);
  EXPECT_EQ(gel.number("density"), 1000);
  EXPECT_EQ(gel.text("model"), "neo_hookean");
  const Params& ball = s.at("bodies").at("ball");
  EXPECT_EQ(ball.vec3("velocity"), Vec3::Zero());
  EXPECT_TRUE(ball.flag("self_contact"));
  EXPECT_FALSE(ball.has("rotation"));
  EXPECT_EQ(ball.at("shape").at("sphere").number("radius"), 3e-3);
  EXPECT_EQ(ball.at("shape").entries().size(), 1u);
  EXPECT_EQ(s.at("solver").integer("iterations"), 100);
  EXPECT_TRUE(s.at("effects").has("elasticity"));  // an empty block
  const Schedule pressure(s.at("effects").at("load").at("pressure"));
  EXPECT_DOUBLE_EQ(pressure(0.5e-3), 1000);
}

TEST(Scene, KeepsPlaces) {
  const Params s = read(kBase);
  EXPECT_EQ(s.at("bodies").at("ball").where().text(), "s.yaml:5:3");
  EXPECT_EQ(s.at("time").at("steps").where().text(), "s.yaml:2:27");
}

TEST(Scene, OneBlockIsAListOfOne) {
  const Params s = read(kBase + "  move: {body: ball, time: [0, 1], translation: [[0, 0, 0], [0, 0, 1 cm]]}\n");
  ASSERT_EQ(s.at("effects").at("move").items().size(), 1u);
  EXPECT_EQ(s.at("effects").at("move").items()[0].at("translation").items()[1].as_vec3(), Vec3(0, 0, 0.01));
}

TEST(Scene, ListsThatBelongToTimesHaveTheirLength) {
  EXPECT_THAT(message(kBase + "  move: {body: ball, time: [0, 1], translation: [[0, 0, 0]]}\n"), HasSubstr("translation has 1 entries"));
  EXPECT_THAT(message(kBase + "  move: {body: ball, time: [0, 1], spin: {angle: [0, 1, 2]}}\n"), HasSubstr("spin.angle has 3 entries"));
  EXPECT_THAT(message(kBase + "  move: {body: ball, time: [0, 0]}\n"), HasSubstr("s.yaml:9:32: error: effects.move.time must increase"));
}

TEST(Scene, ReportsAllErrorsInTheOrderOfTheFile) {
  try {
    read("mortise: 1\ntime: {step: 5 m, steps: 0}\nbodies: {b: {type: soft}}\neffects: {inertia: {}, elasticty: {}}\n");
    FAIL();
  } catch (const SceneErrors& e) {
    EXPECT_EQ(e.code(), Exit::scene);
    EXPECT_TRUE(e.located());
    std::vector<std::string> places;
    for (const Diagnostic& d : e.errors()) places.push_back(d.at.text());
    EXPECT_THAT(places, testing::ElementsAre("s.yaml:2:14", "s.yaml:2:26", "s.yaml:3:10", "s.yaml:3:10", "s.yaml:4:24"));
  }
}

TEST(Scene, UnknownKeysAreErrorsExceptPrivateOnes) {
  EXPECT_EQ(message(kBase + "x-note: {anything: [1, two]}\n"), "");
  EXPECT_THAT(message(kBase + "note: 1\n"), HasSubstr("s.yaml:9:1: error: unknown key 'note' in the scene"));
  EXPECT_THAT(message(kBase + "solvr: {}\n"), HasSubstr("did you mean 'solver'?"));
}

TEST(Scene, KeysOneLevelTooFarOutAreToldWhereTheyBelong) {
  const std::string text = "mortise: 1\ntime: {step: 1, steps: 1}\nmaterials: {m: {density: 1}}\neffects: {inertia: {}, affine_body: {}}\nbodies:\n";
  const std::string said = message(text + "  a: {type: stiff, box: {size: [1, 1, 1], edge_length: 1}, material: m}\n");
  EXPECT_THAT(said, HasSubstr("unknown key 'box' in bodies.a"));
  EXPECT_THAT(said, HasSubstr("it belongs in 'shape'"));
  EXPECT_THAT(said, testing::Not(HasSubstr("has no 'shape'")));
}

TEST(Scene, AliasesRepeatABlock) {
  const Params s = read(
      "mortise: 1\nx-r: &r {sphere: {radius: 1 m, edge_length: 0.5 m}}\ntime: {step: 1, steps: 1}\n"
      "materials: {m: {density: 1}}\nbodies:\n  a: {type: stiff, shape: *r, material: m}\n  b: {type: stiff, shape: *r, "
      "material: m}\n"
      "effects: {inertia: {}, affine_body: {}}\n");
  EXPECT_EQ(s.at("bodies").at("b").at("shape").at("sphere").number("radius"), 1);
}

TEST(Scene, MergeKeysFillInWhatIsNotWritten) {
  const std::string text =
      "mortise: 1\nx-r: &r {type: stiff, material: m, shape: {sphere: {radius: 1 m, edge_length: 0.5 m}}, position: [1, 0, 0]}\nx-s: &s {position: "
      "[2, 0, 0], velocity: [3, 0, 0]}\n"
      "time: {step: 1, steps: 1}\nmaterials: {m: {density: 1}}\nbodies:\n  a: {<<: *r}\n  b: {position: [5, 0, 0], <<: [*s, *r]}\n  c:\n    <<: *s\n "
      "   <<: *r\neffects: {inertia: {}, affine_body: {}}\n";
  const Params bodies = read(text).at("bodies");
  EXPECT_EQ(bodies.at("a").vec3("position"), Vec3(1, 0, 0));
  EXPECT_EQ(bodies.at("b").vec3("position"), Vec3(5, 0, 0));
  EXPECT_EQ(bodies.at("b").vec3("velocity"), Vec3(3, 0, 0));
  EXPECT_EQ(bodies.at("c").vec3("position"), Vec3(2, 0, 0));
  EXPECT_THAT(message("mortise: 1\nbodies: {a: {<<: 3}}\n"), HasSubstr("the merge key '<<' takes a block of keys"));
}

TEST(Scene, AliasBombIsRefused) {
  std::string text = "mortise: 1\nx-0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 9; ++i) {
    const std::string a = "*a" + std::to_string(i - 1);
    text += "x-" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + a;
    for (int k = 1; k < 10; ++k) text += ", " + a;
    text += "]\n";
  }
  EXPECT_THAT(message(text), HasSubstr("more than a million values"));
}

TEST(Scene, DeepNestingIsRefused) { EXPECT_THAT(message(std::string(100000, '[')), HasSubstr("s.yaml:1:")); }

TEST(Scene, StiffBodiesNeedAnEffectUnlessFullyPinned) {
  const std::string text =
      "mortise: 1\ntime: {mode: static, steps: 1}\nmaterials: {m: {density: 1}}\nbodies:\n"
      "  a: {type: stiff, shape: {sphere: {radius: 1 m, edge_length: 0.5 m}}, material: m}\neffects: {elasticity: {}}\n";
  EXPECT_THAT(message(text), HasSubstr("stiff body 'a' needs the effect 'affine_body'"));
  EXPECT_EQ(message(text, {"effects.affine_body={}"}), "");
}

TEST(Scene, FollowsCitesBothPlaces) {
  const std::string m = message(kBase + "  load: {follows: touch}\n");
  EXPECT_THAT(m, HasSubstr("s.yaml:9:19: error: effects.load.follows is 'touch', which this scene does not list"));
  EXPECT_THAT(m, HasSubstr("s.yaml:6:1: note: the effects: inertia, elasticity"));
  EXPECT_EQ(message(kBase + "  load: {follows: elasticity}\n"), "");
  EXPECT_THAT(message(kBase + "  load: {follows: load}\n"), HasSubstr("does not list"));
}

TEST(Scene, PairsNameBodies) {
  EXPECT_THAT(message(kBase + "  load: {side: {slave: bal}}\n"), HasSubstr("effects.load.side.slave: no body 'bal'"));
  EXPECT_EQ(message(kBase + "  load: {pairs: [[ball, ball]]}\n"), "");
  EXPECT_THAT(message(kBase + "  load: {pairs: [[ball, bal]]}\n"), HasSubstr("effects.load.pairs.0.1: no body 'bal'"));
  EXPECT_THAT(message(kBase + "  load: {pairs: [[ball]]}\n"), HasSubstr("effects.load.pairs.0 has 1 entries; must be [name, name]"));
}

TEST(Scene, PathsResolveAgainstTheScene) {
  namespace fs = std::filesystem;
  const fs::path dir = fs::temp_directory_path() / ("mortise_scene_" + std::to_string(getpid()));
  fs::create_directories(dir / "sub");
  std::ofstream(dir / "sub/a.obj") << "v 0 0 0\n";
  std::string text = kBase;
  text.replace(text.find("{sphere"), text.find("}}, mat") - text.find("{sphere") + 1, "{mesh: {file: sub/a.obj}");
  std::ofstream(dir / "s.yaml") << text;
  const Scene s = read_scene(dir / "s.yaml", {}, kEffects);
  EXPECT_EQ(s.root.at("bodies").at("ball").at("shape").at("mesh").text("file"), dir / "sub/a.obj");
  fs::remove(dir / "sub/a.obj");
  EXPECT_THROW(read_scene(dir / "s.yaml", {}, kEffects), SceneErrors);
  fs::remove_all(dir);
}

TEST(Scene, ResolvedTextReadsBack) {
  const Params s = read(kBase +
                        "  load: {pressure: {time: [0, 0.1], value: [0, 3 kPa]}, pairs: [[ball, ball]]}\n"
                        "  move: [{body: ball, time: [0], spin: {angle: [30 deg]}}]\ndescription: 'no: \"quotes\" # here'\n");
  const std::string text = to_yaml(s);
  EXPECT_EQ(to_yaml(read(text)), text);
  EXPECT_EQ(read(text).at("effects").at("move").items()[0].at("spin").numbers("angle")[0], std::numbers::pi / 6);
}

TEST(Overrides, ReachEveryKindOfPlace) {
  const std::string text = kBase + "  move: {body: ball, time: [0, 1], translation: [[0, 0, 0], [0, 0, 1]]}\n";
  const Params s = read(text, {"time.steps=9", "solver.iterations=5", "bodies.ball.velocity.2=-1 mm/s", "effects.move.0.translation.1.0=7",
                               "effects.load={mu: 2}", "bodies.ball.shape.sphere.radius=9 mm", "effects.load.mu=3"});
  EXPECT_EQ(s.at("time").integer("steps"), 9);
  EXPECT_EQ(s.at("solver").integer("iterations"), 5);
  EXPECT_EQ(s.at("bodies").at("ball").vec3("velocity"), Vec3(0, 0, -1e-3));
  EXPECT_EQ(s.at("effects").at("move").items()[0].at("translation").items()[1].as_vec3(), Vec3(7, 0, 1));
  EXPECT_EQ(s.at("effects").at("load").number("mu"), 3);
  EXPECT_EQ(s.at("bodies").at("ball").at("shape").at("sphere").number("radius"), 9e-3);
}

TEST(Overrides, ErrorsCiteTheFlagAndTheLineItReplaces) {
  const std::string m = message(kBase, {"time.steps=0"});
  EXPECT_THAT(m, HasSubstr("--set time.steps=0: error: time.steps is 0; must be in [1, "));
  EXPECT_THAT(m, HasSubstr("s.yaml:2:27: note: the value it replaces"));
  EXPECT_THAT(message(kBase, {"bodies.bal.velocity=[0, 0, 0]"}), HasSubstr("did you mean 'ball'?"));
  EXPECT_THAT(message(kBase, {"effects.load.mu=3"}), HasSubstr("the scene does not list the effect 'load'"));
  EXPECT_THROW(read(kBase, {"time"}), Error);
}

TEST(Scene, OneMistakeIsOneError) {
  EXPECT_THAT(message(kBase + "  gravitation: {}\n"), HasSubstr("unknown effect 'gravitation'"));
  std::string short_name = kBase;
  short_name.replace(short_name.find("material: gel"), 13, "material: gel, pos: [0, 0, 1]");
  EXPECT_THAT(message(short_name), HasSubstr("did you mean 'position'?"));
  std::string rigid = kBase;
  rigid.replace(rigid.find("type: soft"), 10, "type: rigid");
  EXPECT_THAT(message(rigid), HasSubstr("did you mean 'stiff'?"));
  EXPECT_THAT(message(kBase + "  move: {body: ball, time: [0]}\n", {"effects.move.-1.body=ball"}), testing::EndsWith("write effects.move.0"));
}

// It left friction in the scene, with its defaults.
TEST(Overrides, NullRemoves) {
  const std::string text = kBase + "  load: {mu: 2}\n  move: {body: ball, time: [0, 1], translation: [[0, 0, 0], [0, 0, 1]]}\n";
  EXPECT_FALSE(read(text, {"effects.load=null"}).at("effects").has("load"));
  EXPECT_EQ(read(text, {"effects.load.mu=null"}).at("effects").at("load").number("mu"), 0.5) << "its default";
  EXPECT_FALSE(read(kBase + "  load: {side: {slave: ball}}\n", {"effects.load.side=~"}).at("effects").at("load").has("side"));
  EXPECT_THAT(message(text, {"effects.load="}), HasSubstr("no value stands behind the '='"));
  EXPECT_THAT(message(text, {"effects.lode=null"}), HasSubstr("the scene has no 'lode' there"));
  EXPECT_THAT(message(text, {"bodies.ball.shape=null"}), HasSubstr("bodies.ball has no 'shape'"));
}

TEST(Overrides, AddBodiesAndMaterialsWhole) {
  const Params s = read(kBase, {"materials.tin={density: 7}", "bodies.second={type: half_space, point: [0, 0, -1]}", "bodies.second.point.0=4"});
  EXPECT_EQ(s.at("materials").at("tin").number("density"), 7);
  EXPECT_EQ(s.at("bodies").at("second").vec3("point"), Vec3(4, 0, -1));
  EXPECT_THAT(message(kBase, {"bodies.zzzzzzzz.velocity=[0, 0, 0]"}), HasSubstr("the scene does not have 'zzzzzzzz' under bodies"));
}

TEST(Quantity, PowersOfTenAreExact) {
  EXPECT_EQ(parse_quantity("0.3 mm", Unit::length).value, 3e-4);
  EXPECT_EQ(parse_quantity("0.7e-1mm", Unit::length).value, 0.7e-4);
  EXPECT_EQ(parse_quantity("+1.1 GPa", Unit::pressure).value, 1.1e9);
  EXPECT_EQ(parse_quantity("5 \u00b5m", Unit::length).value, 5e-6);
  EXPECT_EQ(parse_quantity("-.5", Unit::none).value, -0.5);
  EXPECT_DOUBLE_EQ(parse_quantity("180 deg", Unit::angle).value, std::numbers::pi);
  EXPECT_DOUBLE_EQ(parse_quantity("60 rpm", Unit::angular_velocity).value, 2 * std::numbers::pi);
  EXPECT_EQ(parse_quantity("20 kPa", Unit::any).value, 2e4);
  EXPECT_EQ(parse_quantity("1.5 Nm", Unit::torque).value, 1.5);
  EXPECT_EQ(parse_quantity("20 mN m", Unit::torque).value, 0.02);
  EXPECT_EQ(parse_quantity("4 N/mm", Unit::any).value, 4000);
  EXPECT_EQ(parse_quantity("5 Hz", Unit::frequency).value, 5);
}

TEST(Quantity, RefusesWhatIsNoFiniteNumberOfTheUnit) {
  for (const char* bad : {"", "m", "1 kPa", "1 m m", "1..2", "0x10", "010", "1e999", ".inf", "nan", "1,5", "1_000", "1 2", "--1", "1e", "5 Mm"})
    EXPECT_NE(parse_quantity(bad, Unit::length).error, "") << bad;
  EXPECT_NE(parse_quantity("1 m", Unit::none).error, "");
  EXPECT_EQ(parse_quantity("1e-999", Unit::none).value, 0);
}

TEST(Numbers, OnlyPlainScalarsAreNumbersAndFlags) {
  EXPECT_THAT(message(kBase + "  load: {mu: \"0.5\"}\n"), HasSubstr("write it without quotes"));
  EXPECT_THAT(message(kBase + "  load: {mu: true}\n"), HasSubstr("must be a number"));
  for (const char* bad : {"yes", "no", "on", "1", "\"true\"", "True"})
    EXPECT_THAT(message(kBase + "  load: {on: " + bad + "}\n"), HasSubstr("must be true or false")) << bad;
  EXPECT_THAT(message(kBase + "  load: {mu: 10.5}\n"), HasSubstr("must be in [0, 10]"));
}

TEST(Tables, HaveUniqueKeysAndValidDefaults) { check_table(SceneTables(kEffects).root(), "scene"); }

TEST(Suggest, FindsTypingErrorsOnly) {
  EXPECT_EQ(edit_distance("abcd", "abdc"), 1);
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(nearest("youngs_modulos", {"density", "youngs_modulus"}), "youngs_modulus");
  EXPECT_EQ(nearest("nu", {"mu"}), "mu");
  EXPECT_EQ(nearest("xy", {"mu"}), "");
  EXPECT_EQ(suggestion("foo", {"density", "model"}), "known here: density, model");
  EXPECT_EQ(suggestion("foo", {"aaaaa1", "aaaaa2", "aaaaa3", "aaaaa4", "aaaaa5", "aaaaa6", "aaaaa7", "aaaaa8", "aaaaa9"}), "");
}

TEST(Schema, FollowsTheTables) {
  const auto s = nlohmann::json::parse(schema(kEffects));
  const auto& load = s["else"]["properties"]["effects"]["properties"]["load"]["properties"];
  EXPECT_EQ(load["mu"]["maximum"], 10);
  EXPECT_EQ(load["mu"]["default"], 0.5);
  EXPECT_EQ(load["pressure"]["description"], "[Pa] Pressure.");
  EXPECT_EQ(s["else"]["required"], nlohmann::json::parse(R"(["mortise", "time", "bodies", "effects"])"));
  EXPECT_EQ(s["then"]["required"], nlohmann::json::parse(R"(["mortise"])")) << "what a robot brings need not be said";
}

// Bytes that continue a character which never began (found by the fuzzer).
TEST(Scene, BytesThatAreNoTextAreAnErrorNotACrash) {
  EXPECT_THROW(read_scene_text(std::string(200, '\x8c') + "\x1e"
                                                          "amm",
                               "bytes.yaml", {}, {}),
               Error);
  EXPECT_THROW(read_scene_text("mortise: 1\n" + std::string(300, '\x8c'), "bytes.yaml", {}, {}), Error);
}

TEST(Scene, TellsWhereTwoDiffer) {
  const auto text = [](const std::string& set) { return to_yaml(read(kBase + "  affine_body: {}\n", {set})); };
  const std::string here = text("time.steps=3");
  EXPECT_THAT(differences(here, here), testing::IsEmpty());
  EXPECT_THAT(differences(text("time.steps=4"), here), testing::ElementsAre("time.steps is 4 there and 3 here"));
  const std::string moved = text("effects.move=[{body: ball, time: [0, 1], translation: [[0, 0, 0], [0, 0, 1]]}]");
  EXPECT_THAT(differences(here, moved), testing::ElementsAre(HasSubstr("effects.move is missing there and [{body: ball, ")));
  EXPECT_THAT(differences(moved, text("effects.move=[{body: ball, time: [0, 2], translation: [[0, 0, 0], [0, 0, 1]]}]")),
              testing::ElementsAre("effects.move.0.time is [0, 1] there and [0, 2] here"));
}

}  // namespace
}  // namespace mortise::scene
