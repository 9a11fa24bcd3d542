// What is drawn for environments, and the scenes that they are.
#include "scene/environments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace mortise::scene {
namespace {

using testing::HasSubstr;
using testing::Not;

const ParamTable kNothing{"elasticity", "", {}};
const ParamTable kInertia{"inertia", "", {}};
const std::vector<EffectTable> kEffects{{.name = "elasticity", .help = "", .table = &kNothing},
                                        {.name = "inertia", .help = "", .table = &kInertia, .inertia = true}};

std::string text(const std::string& environments) {
  return "mortise: 1\ntime: {step: 1 ms, steps: 2}\nmaterials: {gel: {youngs_modulus: 0.4 MPa, poisson_ratio: 0.25, density: 1000}}\n"
         "bodies: {pad: {type: soft, shape: {sphere: {radius: 10 mm, edge_length: 5 mm}}, material: gel, rotation: {axis: [0, 0, 1], angle: 10 "
         "deg}}}\n"
         "effects: {elasticity: {}, inertia: {}}\nenvironments: " +
         environments + "\n";
}
Scene scene_of(const std::string& environments) { return read_scene_text(text(environments), "s.yaml", {}, kEffects); }

std::vector<double> values(const std::string& vary, long count, long seed = 3) {
  const Scene s = scene_of("{count: " + std::to_string(count) + ", seed: " + std::to_string(seed) + ", vary: " + vary + "}");
  std::vector<double> out;
  for (long e = 0; e < count; ++e) out.push_back(draw(s.root, e, 0).at(0).value);
  return out;
}

// Largest distance between the empirical and the wanted distribution function; n values of it exceed 1.95/sqrt(n) once in a thousand (Kolmogorov).
template <class F>
double distance(std::vector<double> v, F wanted) {
  std::sort(v.begin(), v.end());
  double most = 0;
  for (std::size_t i = 0; i < v.size(); ++i)
    for (const double step : {0.0, 1.0})
      most = std::max(most, std::abs(wanted(v[i]) - (static_cast<double>(i) + step) / static_cast<double>(v.size())));
  return most;
}

TEST(Environments, ValuesAreDistributedAsAsked) {
  constexpr long n = 4000;
  const double most = 1.95 / std::sqrt(static_cast<double>(n));
  EXPECT_LT(distance(values("{path: materials.gel.youngs_modulus, scale: {log_uniform: [0.5, 2]}}", n),
                     [](double v) { return std::log(v / 0.2e6) / std::log(4.0); }),
            most);
  EXPECT_LT(distance(values("{path: materials.gel.poisson_ratio, add: {uniform: [-0.25, 0.2]}}", n), [](double v) { return v / 0.45; }), most);
  EXPECT_LT(distance(values("{path: bodies.pad.position.2, add: {normal: [1 mm, 2 mm]}}", n),
                     [](double v) { return 0.5 * std::erfc(-(v - 1e-3) / 2e-3 / std::sqrt(2.0)); }),
            most);
  std::vector<double> choice = values("{path: bodies.pad.rotation.angle, abs: {choice: [0, 90 deg, 180 deg]}}", n);
  for (double wanted : {0.0, std::acos(0.0), std::acos(-1.0)})
    EXPECT_NEAR(static_cast<double>(std::count_if(choice.begin(), choice.end(), [&](double v) { return std::abs(v - wanted) < 1e-12; })), n / 3.0,
                4 * std::sqrt(n * 2 / 9.0));
}

TEST(Environments, ADrawHangsOnSeedEnvironmentEpisodeAndPathAlone) {
  const std::string modulus = "{path: materials.gel.youngs_modulus, scale: {uniform: [0.5, 2]}}",
                    density = "{path: materials.gel.density, scale: {uniform: [0.5, 2]}}";
  const Scene few = scene_of("{count: 2, seed: 7, vary: [" + modulus + "]}"),
              many = scene_of("{count: 500, seed: 7, vary: [" + density + ", " + modulus + "]}"),
              other = scene_of("{count: 2, seed: 8, vary: [" + modulus + "]}");
  for (long e = 0; e < 2; ++e) {
    EXPECT_EQ(draw(few.root, e, 0)[0].value, draw(many.root, e, 0)[1].value);
    EXPECT_NE(draw(few.root, e, 0)[0].value, draw(other.root, e, 0)[0].value);
    EXPECT_NE(draw(many.root, e, 0)[0].draw, draw(many.root, e, 0)[1].draw);
  }
  std::set<double> all;
  for (long e = 0; e < 500; ++e)
    for (long episode = 0; episode < 20; ++episode) all.insert(draw(many.root, e, episode)[0].draw);
  EXPECT_EQ(all.size(), 10000u);
}

// Draws of different paths, and of neighbouring environments, are not correlated: r has a deviation of 1/sqrt(n).
TEST(Environments, DrawsAreIndependent) {
  constexpr long n = 4000;
  const Scene s = scene_of(
      "{count: 4000, vary: [{path: materials.gel.youngs_modulus, scale: {uniform: [0.5, 2]}}, {path: materials.gel.density, scale: {uniform: [0.5, "
      "2]}}]}");
  double paths = 0, neighbours = 0, episodes = 0;
  const auto at = [&](long e, long episode, int k) { return (draw(s.root, e, episode)[k].draw - 1.25) / std::sqrt(1.5 * 1.5 / 12); };
  for (long e = 0; e < n; ++e)
    paths += at(e, 0, 0) * at(e, 0, 1) / n, neighbours += at(e, 0, 0) * at(e + 1, 0, 0) / n, episodes += at(e, 0, 0) * at(e, 1, 0) / n;
  for (double r : {paths, neighbours, episodes}) EXPECT_LT(std::abs(r), 4 / std::sqrt(static_cast<double>(n)));
}

TEST(Environments, AnEnvironmentIsAScene) {
  const Scene all = scene_of(
      "{count: 3, seed: 7, vary: [{path: materials.gel.youngs_modulus, scale: {uniform: [0.5, 2]}}, {path: bodies.pad.position.1, add: {normal: [0, "
      "1 mm]}}]}");
  const Scene one = environment_of(all, {}, kEffects, 2);
  EXPECT_FALSE(one.root.has("environments"));
  EXPECT_EQ(one.root.at("materials").at("gel").number("youngs_modulus"), draw(all.root, 2, 0)[0].value);
  EXPECT_EQ(one.root.at("bodies").at("pad").vec3("position")[1], draw(all.root, 2, 0)[1].value);
  EXPECT_EQ(one.root.at("materials").at("gel").number("density"), 1000);
  // Written and read again it is the same scene, and so is what overrides make of it.
  EXPECT_EQ(identity(read_scene_text(to_yaml(one.root), "again.yaml", {}, kEffects).root), identity(one.root));
  EXPECT_NE(identity(environment_of(all, {}, kEffects, 1).root), identity(one.root));
  EXPECT_EQ(environment_of(all, {"time.steps=9"}, kEffects, 2).root.at("time").integer("steps"), 9);
  EXPECT_THROW(one_environment(all, {}, kEffects, 3), Error);
  EXPECT_THROW(one_environment(one, {}, kEffects, 0), Error);
}

TEST(Environments, WithoutVaryAllAreTheScene) {
  const Scene all = scene_of("{count: 3}"), plain = read_scene_text(to_yaml(environment_of(all, {}, kEffects, 0).root), "p.yaml", {}, kEffects);
  EXPECT_TRUE(draw(all.root, 0, 0).empty());
  EXPECT_EQ(identity(environment_of(all, {}, kEffects, 2).root), identity(plain.root));
  EXPECT_EQ(environment_count(plain.root), 0);
}

// What is drawn can make a scene invalid that was valid: the message says whose it is.
TEST(Environments, AnInvalidEnvironmentIsNamed) {
  const Scene all = scene_of("{count: 2, vary: {path: materials.gel.poisson_ratio, abs: {choice: [0.25]}}}");
  try {
    environment_of(all, {"materials.gel.density=-1"}, kEffects, 1);
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("materials.gel.density"));
  }
}

}  // namespace
}  // namespace mortise::scene
