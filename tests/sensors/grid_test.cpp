// Taxel grids: nothing is lost between taxels, uniform pressure is uniform, and a sensor does not notice rigid motion.
#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <random>

#include "geometry/midsides.h"
#include "geometry/topology.h"
#include "scene_builder.h"
#include "sensors/sensor.h"

using namespace mortise;
using namespace mortise::sensors;
using namespace mortise::testing;

namespace {

constexpr double kTop = 0.01;  // height of the upper face [m]

// A pad of 40 x 30 x 20 mm whose nodes within the faces are shaken, so that no line of a grid meets a line of the mesh.
geometry::TetMesh pad_mesh() {
  geometry::TetMesh mesh = geometry::box(Vec3(0.04, 0.03, 0.02), {5, 4, 2});
  std::mt19937 random(7);
  std::uniform_real_distribution<double> shake(-1.2e-3, 1.2e-3);
  for (Vec3& x : mesh.points) {
    const double dx = shake(random), dy = shake(random);
    if (std::abs(std::abs(x[0]) - 0.02) > 1e-9) x[0] += dx;
    if (std::abs(std::abs(x[1]) - 0.015) > 1e-9) x[1] += dy;
  }
  return mesh;
}

model::BodyInput pad(bool quadratic) {
  geometry::TetMesh mesh = pad_mesh();
  return soft_body("pad", quadratic ? geometry::with_midsides(mesh) : mesh, material("linear", 1e5, 0.3, 1000));
}

GridSpec grid(int rows, int columns, double width, double height, double turn = 0) {
  GridSpec s;
  s.rows = rows, s.columns = columns, s.width = width, s.height = height;
  s.frame.origin = Vec3(0, 0, kTop);
  s.frame.axes = Eigen::AngleAxisd(turn, Vec3::UnitZ()).toRotationMatrix();
  return s;
}

bool on_top(const Vec3& x) { return x[2] > kTop - 1e-9; }

// Consistent nodal forces of the traction t on the upper face.
std::vector<Vec3> load(const model::BodyInput& body, const Vec3& t) {
  std::vector<Vec3> f(body.nodes.size(), Vec3::Zero());
  const auto add = [&](const Index* corner, const Index* to) {
    const Vec3 &a = body.nodes[corner[0]], &b = body.nodes[corner[1]], &c = body.nodes[corner[2]];
    if (!on_top(a) || !on_top(b) || !on_top(c)) return;
    for (int k = 0; k < 3; ++k) f[to[k]] += (b - a).cross(c - a).norm() / 6 * t;
  };
  for (const geometry::Face& face : body.faces) add(face.v, face.v + 3);
  if (body.faces.empty())
    for (const Triangle& tri : body.triangles) add(tri.v, tri.v);
  return f;
}

Vec3 sum(const std::vector<Vec3>& v) { return std::accumulate(v.begin(), v.end(), Vec3(0, 0, 0)); }

Params sensor_params(int rows, int columns, double width, double height) {
  Params p = Params::make_table();
  p.set("position", vec(Vec3(0, 0, kTop)));
  p.set("normal", vec(Vec3(0, 0, 2)));
  p.set("up", vec(Vec3(0.3, 1, 0.7)));
  p.set("rows", Params::make_integer(rows));
  p.set("columns", Params::make_integer(columns));
  p.set("width", Params::make_number(width));
  p.set("height", Params::make_number(height));
  p.set("moves_with", Params::make_text("supports"));
  return p;
}

model::ModelInput scene_of(const model::BodyInput& body) {
  model::ModelInput input;
  input.scene = Params::make_table();
  input.scene.set("effects", Params::make_table());
  input.bodies = {body};
  return input;
}

std::vector<double> flat(const std::vector<Vec3>& v) {
  std::vector<double> out;
  for (const Vec3& x : v) out.insert(out.end(), x.data(), x.data() + 3);
  return out;
}

}  // namespace

TEST(TaxelGrid, SharesOutEveryForceOnTheSurfaceItCovers) {
  for (bool quadratic : {false, true}) {
    const model::BodyInput body = pad(quadratic);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> force(-1, 1);
    std::vector<Vec3> f(body.nodes.size(), Vec3::Zero());
    for (std::size_t i = 0; i < f.size(); ++i)
      if (on_top(body.nodes[i])) f[i] = Vec3(force(random), force(random), force(random));
    for (const GridSpec& s : {grid(7, 9, 0.04, 0.03), grid(3, 2, 0.06, 0.05, 0.4)}) {
      const TaxelGrid taxels(body, s);
      EXPECT_LT((sum(taxels.distribute(f)) - sum(f)).norm(), 1e-13);
      const std::vector<double>& area = taxels.rest_area();
      EXPECT_NEAR(std::accumulate(area.begin(), area.end(), 0.0), 0.04 * 0.03, 1e-16);
    }
  }
}

TEST(TaxelGrid, UniformPressureGivesEqualTaxels) {
  const Vec3 t(200, -300, -1000);  // [Pa]
  for (bool quadratic : {false, true}) {
    const model::BodyInput body = pad(quadratic);
    for (const GridSpec& s : {grid(6, 8, 0.04, 0.03), grid(5, 7, 0.018, 0.02, 0.5)}) {
      const std::vector<Vec3> f = TaxelGrid(body, s).distribute(load(body, t));
      const double cell = s.width * s.height / s.taxels();
      for (const Vec3& x : f) EXPECT_LT((x / cell - t).norm(), 1e-10);
    }
  }
}

// The surface on the far side, and what `depth` leaves out, has no taxels.
TEST(TaxelGrid, SeesTheSideItFaces) {
  const model::BodyInput body = pad(false);
  std::vector<Vec3> f(body.nodes.size(), Vec3::Zero());
  for (std::size_t i = 0; i < f.size(); ++i)
    if (body.nodes[i][2] < -kTop + 1e-9) f[i] = Vec3(0, 0, 1);
  EXPECT_EQ(sum(TaxelGrid(body, grid(4, 4, 0.04, 0.03)).distribute(f)).norm(), 0);
  GridSpec far = grid(4, 4, 0.04, 0.03);
  far.frame.origin[2] += 0.005, far.depth = 0.004;
  const TaxelGrid none(body, far);
  EXPECT_EQ(std::accumulate(none.rest_area().begin(), none.rest_area().end(), 0.0), 0);
}

TEST(TaxelGrid, AreaFollowsTheMaterial) {
  const model::BodyInput body = pad(false);
  std::vector<Vec3> y = body.nodes;
  for (Vec3& x : y) x[0] *= 1.5;
  const TaxelGrid taxels(body, grid(3, 4, 0.03, 0.02));
  const std::vector<double> now = taxels.area(y);
  for (int i = 0; i < 12; ++i) EXPECT_NEAR(now[i], 1.5 * 0.03 * 0.02 / 12, 1e-15);
}

// A field that is linear in space has its value in the middle of the taxel as mean.
TEST(TaxelGrid, MeanOfALinearField) {
  const model::BodyInput body = pad(false);
  std::vector<Vec3> u;
  for (const Vec3& x : body.nodes) u.push_back(Vec3(0.2 * x[1], -0.1 * x[0], 0.3 + x[0]));
  const GridSpec s = grid(4, 5, 0.03, 0.02);
  const std::vector<Vec3> mean = TaxelGrid(body, s).mean(u);
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 5; ++c) {
      const double x = 0.03 * ((c + 0.5) / 5 - 0.5), y = 0.02 * ((r + 0.5) / 4 - 0.5);
      EXPECT_LT((mean[5 * r + c] - Vec3(0.2 * y, -0.1 * x, 0.3 + x)).norm(), 1e-15);
    }
}

// Of a stiff plate of 40 mm: triangles under the grid become small against taxels, and the surface stays closed and where it was.
TEST(TaxelGrid, CutsTheTrianglesOfAStiffBody) {
  const geometry::TriMesh box = geometry::surface_of(geometry::box(Vec3(0.04, 0.04, 0.02), {1, 1, 1}));
  model::BodyInput plate;
  plate.type = model::BodyType::stiff, plate.nodes = box.points, plate.triangles = box.triangles;
  const std::size_t before = plate.triangles.size();
  const GridSpec spec = grid(4, 4, 0.02, 0.02);
  refine(plate, spec);
  EXPECT_GT(plate.triangles.size(), before + 8 * 16);
  std::map<std::pair<Index, Index>, int> open;
  double area = 0;
  for (const Triangle& t : plate.triangles) {
    const Vec3 a = plate.nodes[t.v[0]], b = plate.nodes[t.v[1]], c = plate.nodes[t.v[2]], middle = (a + b + c) / 3;
    area += (b - a).cross(c - a).norm() / 2;
    for (int k = 0; k < 3; ++k) ++open[{t.v[k], t.v[(k + 1) % 3]}], --open[{t.v[(k + 1) % 3], t.v[k]}];
    if (std::abs(middle[2] - kTop) > 1e-9 || std::max(std::abs(middle[0]), std::abs(middle[1])) > 0.01) continue;
    EXPECT_LE(std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()}), 0.4 * 0.005 * (1 + 1e-12));
  }
  for (const auto& [side, count] : open) EXPECT_EQ(count, 0) << side.first << ' ' << side.second;
  EXPECT_NEAR(area, 2 * 0.04 * 0.04 + 4 * 0.04 * 0.02, 1e-15);
  model::BodyInput away = plate;
  refine(away, spec);
  EXPECT_EQ(away.triangles.size(), plate.triangles.size());
}

TEST(Sensor, DoesNotNoticeRigidMotion) {
  const model::BodyInput body = pad(false);
  const model::ModelInput input = scene_of(body);
  const Sensor sensor("map", sensor_params(6, 5, 0.03, 0.02), input, body, 0);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Vec3> y = body.nodes, f(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += 3e-4 * Vec3(u(random), u(random), u(random)), f[i] = Vec3(u(random), u(random), u(random));
  const Reading before = sensor.read(flat(y), flat(f), {});
  const Mat3 R = Eigen::AngleAxisd(2.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = R * y[i] + Vec3(0.4, -0.2, 0.7), f[i] = R * f[i];
  const Reading after = sensor.read(flat(y), flat(f), {});
  const double scale = 1e5;  // size of the pressures [Pa]
  for (std::size_t i = 0; i < before.pressure.size(); ++i) EXPECT_NEAR(after.pressure[i], before.pressure[i], 1e-11 * scale);
  for (std::size_t i = 0; i < before.shear.size(); ++i) EXPECT_NEAR(after.shear[i], before.shear[i], 1e-11 * scale);
  for (std::size_t i = 0; i < before.displacement.size(); ++i) EXPECT_NEAR(after.displacement[i], before.displacement[i], 1e-15);
  EXPECT_LT((after.wrench_force - before.wrench_force).norm(), 1e-12);
  EXPECT_LT((after.wrench_moment - before.wrench_moment).norm(), 1e-13);
  EXPECT_GT(before.wrench_moment.norm(), 1e-3);
  EXPECT_LT((after.frame.axes - R * before.frame.axes).norm(), 1e-13);
}

// With a pinned bottom the frame stays with it, and a shear of the pad is a displacement of the taxels.
TEST(Sensor, FrameStaysWithTheSupports) {
  const model::BodyInput body = pad(false);
  model::ModelInput input = scene_of(body);
  Params pin = Params::make_table(), effects = Params::make_table();
  pin.set("body", Params::make_text("pad"));
  pin.set("axes", Params::make_text("xyz"));
  pin.set("where", where_side("z_min"));
  effects.set("pin", Params::make_list({pin}));
  input.scene.set("effects", effects);
  Params p = sensor_params(2, 2, 0.03, 0.02);
  p.set("up", vec(Vec3::UnitY()));
  std::vector<Vec3> y = body.nodes;
  for (Vec3& x : y) x += Vec3(1, 2, 3) + Vec3(0.1 * (x[2] + kTop), 0, 0);  // shear, and a shift of everything
  const Reading r = Sensor("map", p, input, body, 0).read(flat(y), {}, {});
  EXPECT_LT((r.frame.axes - Mat3::Identity()).norm(), 1e-12);
  EXPECT_LT((r.frame.origin - Vec3(1, 2, 3 + kTop)).norm(), 1e-12);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(r.displacement[3 * i], 0.1 * 2 * kTop, 1e-12);
    EXPECT_NEAR(r.displacement[3 * i + 1], 0, 1e-12);
    EXPECT_NEAR(r.displacement[3 * i + 2], 0, 1e-12);
  }
}

TEST(Sensor, WrenchOfForcesOnTheBody) {
  const model::BodyInput body = pad(false);
  Params p = sensor_params(2, 2, 0.03, 0.02);
  p.set("up", vec(Vec3::UnitY()));
  const Sensor sensor("map", p, scene_of(body), body, 0);
  std::vector<Vec3> f(body.nodes.size(), Vec3::Zero());
  f[5] = Vec3(1, -2, 3), f[9] = Vec3(0.5, 0, -1);
  const Reading r = sensor.read(flat(body.nodes), flat(f), flat(f));  // contact and friction add up
  EXPECT_LT((r.wrench_force - 2 * (f[5] + f[9])).norm(), 1e-13);
  const Vec3 origin(0, 0, kTop);
  const Vec3 moment = 2 * ((body.nodes[5] - origin).cross(f[5]) + (body.nodes[9] - origin).cross(f[9]));
  EXPECT_LT((r.wrench_moment - moment).norm(), 1e-14);
}

TEST(Sensor, BesideItsBodyIsAnError) {
  const model::BodyInput body = pad(false);
  Params p = sensor_params(2, 2, 0.01, 0.01);
  p.set("position", vec(Vec3(0.1, 0, kTop)));
  EXPECT_THROW(Sensor("map", p, scene_of(body), body, 0), Error);
}
