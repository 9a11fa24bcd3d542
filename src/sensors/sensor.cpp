#include "sensors/sensor.h"

#include <algorithm>
#include <numeric>

#include "base/error.h"
#include "model/bonded.h"
#include "model/select.h"

namespace mortise::sensors {
namespace {

// The nodes that pins hold in all directions or that are bonded to a stiff body; all nodes where there are too few of them.
std::vector<Index> base_of(const model::ModelInput& input, const model::BodyInput& body, bool supports) {
  std::vector<Index> nodes;
  const Params& effects = input.scene.at("effects");
  const Params *pins = effects.find("pin"), *bonds = effects.find("bond");
  if (supports && bonds)
    for (const Params& bond : bonds->items())
      for (const model::BodyInput& stiff : input.bodies) {
        if (bond.text("body") != body.name || bond.text("to") != stiff.name || stiff.env != body.env) continue;
        const std::vector<Index> held = model::bonded(bond, body, stiff);
        nodes.insert(nodes.end(), held.begin(), held.end());
      }
  if (supports && pins)
    for (const Params& pin : pins->items()) {
      if (pin.text("body") != body.name || pin.text("axes").size() < 3) continue;
      const std::vector<Index> held = model::select(body.nodes, pin.at("where"));
      nodes.insert(nodes.end(), held.begin(), held.end());
    }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  std::vector<Vec3> places;
  for (Index i : nodes) places.push_back(body.nodes[i]);
  if (geometry::fixes_a_frame(places)) return nodes;
  nodes.resize(body.nodes.size());
  std::iota(nodes.begin(), nodes.end(), 0);
  return nodes;
}

Vec3 at(const std::vector<double>& v, std::size_t i) { return {v[3 * i], v[3 * i + 1], v[3 * i + 2]}; }

}  // namespace

Sensor::Sensor(std::string name, const Params& p, const model::ModelInput& input, const model::BodyInput& body, Index first_point)
    : name_(std::move(name)),
      body_(body.name),
      spec_(grid_of(p)),
      grid_(body, spec_),
      first_(first_point),
      rest_(body.nodes),
      base_(base_of(input, body, p.text("moves_with") == "supports")) {
  if (!(grid_.whole_area() > 0))
    throw Error(Exit::scene, p.where(),
                "sensor '" + name_ + "': no surface of '" + body_ + "' faces the grid (position, normal, width, height, depth)");
}

Reading Sensor::read(const std::vector<double>& points, const std::vector<double>& contact, const std::vector<double>& friction) const {
  Reading out;
  std::vector<Vec3> from, to, y(rest_.size()), force(rest_.size(), Vec3::Zero()), moved(rest_.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    y[i] = at(points, first_ + i);
    for (const std::vector<double>* f : {&contact, &friction})
      if (!f->empty()) force[i] += at(*f, first_ + i);
  }
  for (Index i : base_) from.push_back(rest_[i]), to.push_back(y[i]);
  out.frame = geometry::nearest_motion(from, to).moved(spec_.frame);
  for (std::size_t i = 0; i < y.size(); ++i) {
    moved[i] = local(out.frame, y[i]) - local(spec_.frame, rest_[i]);
    out.wrench_force += force[i];
    out.wrench_moment += (y[i] - out.frame.origin).cross(force[i]);
  }
  out.wrench_force = out.frame.axes.transpose() * out.wrench_force;
  out.wrench_moment = out.frame.axes.transpose() * out.wrench_moment;

  out.area = grid_.area(y);
  const std::vector<Vec3> taxel = grid_.distribute(force), shift = grid_.mean(moved);
  for (int i = 0; i < spec_.taxels(); ++i) {
    const Vec3 f = out.frame.axes.transpose() * taxel[i];
    const double per_area = out.area[i] > 0 ? 1 / out.area[i] : 0;
    out.pressure.push_back(-f[2] * per_area);
    out.shear.insert(out.shear.end(), {f[0] * per_area, f[1] * per_area});
    out.force.insert(out.force.end(), f.data(), f.data() + 3);
    out.displacement.insert(out.displacement.end(), shift[i].data(), shift[i].data() + 3);
  }
  return out;
}

}  // namespace mortise::sensors
