// Numbers out of histories and fields.
#include "study/measure.h"

#include <gtest/gtest.h>

#include <cmath>

#include "../output/helpers.h"
#include "output/field_file.h"

using namespace mortise;
using namespace mortise::study;

namespace {

double of(const char* when, const History& h) {
  Quantity q;
  q.when = when;
  return reduced(h, q);
}

double at(double t, const History& h) {
  Quantity q;
  q.at = t;
  return reduced(h, q);
}

// A unit cube of six tetrahedra; with `curved` each with middles, on straight edges.
output::OutputMesh cube(bool curved) {
  output::OutputMesh m;
  for (int i = 0; i < 8; ++i) m.points.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  const int tets[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  const int edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  m.offsets = {0};
  std::map<std::pair<int, int>, std::int64_t> middle;
  for (const auto& t : tets) {
    for (int v : t) m.connectivity.push_back(v);
    for (const auto& e : edges) {
      if (!curved) break;
      const auto key = std::minmax(t[e[0]], t[e[1]]);
      const auto [found, fresh] = middle.try_emplace({key.first, key.second}, static_cast<std::int64_t>(m.points.size()));
      if (fresh) m.points.push_back(0.5 * (m.points[key.first] + m.points[key.second]));
      m.connectivity.push_back(found->second);
    }
    m.offsets.push_back(static_cast<std::int64_t>(m.connectivity.size()));
    m.types.push_back(curved ? output::quadratic_tetrahedron : output::tetrahedron);
  }
  m.body_of_cell.assign(6, 0), m.body_of_point.assign(m.points.size(), 0), m.body_names = {"cube"};
  return m;
}

double over(const output::OutputMesh& m, const std::vector<Vec3>& points, const std::function<double(const Vec3&)>& field, const char* how,
            double percent = NAN, std::optional<Vec3> point = {}) {
  Quantity q;
  q.body = "cube", q.over = how, q.percent = percent, q.point = point;
  output::FieldValues v{1, "", {}};
  for (const Vec3& x : m.points) v.values.push_back(field(x));
  return over_body(m, points, v, q);
}

}  // namespace

TEST(Measure, HistoriesBecomeNumbers) {
  const History h{{0, 1, 3}, {2, -4, 6}};
  EXPECT_EQ(of("end", h), 6);
  EXPECT_EQ(of("start", h), 2);
  EXPECT_EQ(of("largest", h), 6);
  EXPECT_EQ(of("smallest", h), -4);
  EXPECT_EQ(of("range", h), 10);
  EXPECT_EQ(of("sum", h), 4);
  EXPECT_DOUBLE_EQ(of("mean", h), (-1.0 + 2.0) / 3);  // over time
  EXPECT_DOUBLE_EQ(at(2, h), 1);
  EXPECT_DOUBLE_EQ(at(1 + 1e-12, h), -4);
  EXPECT_TRUE(std::isnan(at(4, h)));
  EXPECT_TRUE(std::isnan(of("end", {})));
}

TEST(Measure, SurfacesAreThoseOfTheBody) {
  for (bool curved : {false, true}) {
    const output::OutputMesh m = cube(curved);
    std::vector<Vec3> twice;
    for (const Vec3& x : m.points) twice.push_back(2 * x);
    const auto one = [](const Vec3&) { return 1.0; };
    EXPECT_NEAR(over(m, m.points, one, "area"), 6, 1e-12);
    EXPECT_NEAR(over(m, twice, one, "area"), 24, 1e-12);  // as it is now
    EXPECT_NEAR(over(m, twice, one, "integral"), 24, 1e-12);
    EXPECT_NEAR(over(m, m.points, one, "mean"), 1, 1e-12);
    const auto x = [](const Vec3& p) { return p[0]; };
    EXPECT_NEAR(over(m, m.points, x, "integral"), 3, 1e-12);  // 4 sides of 1/2, and the one at x = 1
    EXPECT_EQ(over(m, m.points, x, "max"), 1);
    EXPECT_EQ(over(m, m.points, x, "min"), 0);
    EXPECT_EQ(over(m, m.points, x, "percentile", 100), 1);
  }
}

// A percentile of what is loaded: half of the area has one, half two.
TEST(Measure, PercentilesGoByArea) {
  const output::OutputMesh m = cube(false);
  const auto field = [](const Vec3& p) { return p[2] > 0.5 ? 0.0 : p[0] > 0.5 ? 2.0 : 1.0; };
  EXPECT_EQ(over(m, m.points, field, "percentile", 30), 1);
  EXPECT_EQ(over(m, m.points, field, "percentile", 99), 2);
}

// Inside of elements linear fields come out exactly, of quadratic elements quadratic ones too.
TEST(Measure, PlacesAreInterpolated) {
  const Vec3 at(0.2, 0.55, 0.7);
  for (bool curved : {false, true}) {
    const output::OutputMesh m = cube(curved);
    EXPECT_NEAR(over(
                    m, m.points, [](const Vec3& p) { return 3 * p[0] - p[1] + 2 * p[2]; }, "", NAN, at),
                1.45, 1e-12);
    if (curved) {
      EXPECT_NEAR(over(
                      m, m.points, [](const Vec3& p) { return p[0] * p[0] + p[1] * p[2]; }, "", NAN, at),
                  0.04 + 0.385, 1e-12);
    }
    EXPECT_NEAR(over(
                    m, m.points, [](const Vec3& p) { return p[0]; }, "", NAN, Vec3(1.01, 0.5, 0.5)),
                1.01, 1e-12);  // a little outside
    EXPECT_THROW(over(
                     m, m.points, [](const Vec3& p) { return p[0]; }, "", NAN, Vec3(3, 0.5, 0.5)),
                 Error);
  }
}

// A cube of 1 m stands on 1 m^2 under 1 kPa: its lower nodes belong to its sides too, which are not pressed.
TEST(Measure, ContactPressureIsOverTheAreaThatMakesItOfForce) {
  const output::Folder dir;
  const output::OutputMesh m = cube(false);
  std::vector<double> positions, pressure, area;
  for (const Vec3& x : m.points) {
    positions.insert(positions.end(), x.data(), x.data() + 3);
    pressure.push_back(x[2] > 0.5 ? 0 : 1000);
    area.push_back(x[2] > 0.5 ? 0 : 0.25);
  }
  auto file = output::FieldFile::open(dir / "fields.vtkhdf", m, output::small_info(), {});
  file->begin_frame(0, positions);
  file->points("contact_pressure", "Pa", 1, pressure);
  file->points("contact_area", "m^2", 1, area);
  file->end_frame();
  file->close();
  const output::FieldReader run(dir / "fields.vtkhdf");
  Quantity q;
  q.value = "contact_pressure", q.body = "cube", q.percent = 50;
  for (const auto& [over, expected] :
       std::vector<std::pair<std::string, double>>{{"integral", 1000}, {"area", 1}, {"percentile", 1000}, {"mean", 1000. / 6}, {"max", 1000}}) {
    q.over = over;
    EXPECT_NEAR(measure(run, q), expected, 1e-4 * expected) << over;
  }
}
