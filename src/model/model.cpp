#include "model/model.h"

#include <algorithm>

#include "geometry/collide/broadphase.h"
#include "geometry/topology.h"
#include "model/build.h"

namespace mortise::model {

Model::Model(ModelInput in) : input(std::move(in)) { build(*this); }
Model::~Model() = default;

void Model::points_of(View<const Vec3> from, Buffer<Vec3>& y) const {
  y.resize(points);
  const PointMapView map = point_map();
  const View<Vec3> out = y.view();
  device::parallel_for("model.points", points, [=] MORTISE_HD(Index i) {
    Vec3 sum = Vec3::Zero();
    for (Index k = map.offset[i]; k < map.offset[i + 1]; ++k) sum += map.weight[k] * from[map.block[k]];
    out[i] = sum;
  });
}

geometry::Broadphase& Model::broadphase() {
  if (!broadphase_) broadphase_ = std::make_unique<geometry::Broadphase>(surface);
  return *broadphase_;
}

void Model::watch(const std::vector<std::uint8_t>& pairs) {
  std::vector<std::uint8_t> allowed = surface.pair_allowed.download();
  for (std::size_t i = 0; i < allowed.size(); ++i)
    if (pairs[i]) allowed[i] = 1;
  surface.pair_allowed.upload(allowed);
  if (broadphase_) broadphase_->forget();
}

bool Model::has_contact(std::string_view effect) const { return std::find(contacts_.begin(), contacts_.end(), effect) != contacts_.end(); }

std::vector<Index> Model::bodies_named(std::string_view name) const {
  std::vector<Index> out;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (bodies[b].name == name) out.push_back(static_cast<Index>(b));
  for (std::size_t p = 0; p < half_spaces.size(); ++p)
    if (half_spaces[p].name == name) out.push_back(static_cast<Index>(bodies.size() + p));
  return out;
}

}  // namespace mortise::model
