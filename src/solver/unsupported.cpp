#include "solver/unsupported.h"

#include <Eigen/Eigenvalues>

#include "base/disjoint_sets.h"
#include "model/radius.h"

namespace mortise::solver {
namespace {

constexpr double kFree = 1e-9;  // of the largest eigenvalue: far above rounding, far below what three points of one element make

// Free rigid motions of a soft body, 0 to 6.
int free_motions(const model::Model& model, const model::Body& body, const std::vector<Mat3>& projector, const std::vector<Vec3>& rest) {
  const double size = model::radius(body, rest);
  Eigen::Matrix<double, 6, 6> form = Eigen::Matrix<double, 6, 6>::Zero();
  for (Index b = body.block_begin; b < body.block_end; ++b) {
    if (!model.held[b]) continue;
    const Mat3 hold = model.held[b] == model::Model::kTied ? Mat3::Identity() : Mat3(Mat3::Identity() - projector[b]);
    const Vec3 x = (rest[body.point_begin + (b - body.block_begin)] - body.centre) / size;
    Eigen::Matrix<double, 3, 6> v;  // of t and w
    v.leftCols<3>() = hold;
    for (int k = 0; k < 3; ++k) v.col(3 + k) = hold * Vec3::Unit(k).cross(x);
    form += v.transpose() * v;
  }
  const Eigen::Matrix<double, 6, 1> eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(form, Eigen::EigenvaluesOnly).eigenvalues();
  int free = 0;
  for (double e : eigenvalues) free += e <= kFree * eigenvalues[5];
  return free;
}

// Of every body: does something hold it, or one that it is tied to?
std::vector<bool> carried(const model::Model& model) {
  const std::size_t world = model.bodies.size();
  DisjointSets groups(world + 1);
  for (const model::Tie& tie : model.ties.list())
    groups.join(static_cast<std::size_t>(tie.body), tie.to == model::Tie::kWorld ? world : static_cast<std::size_t>(tie.to));
  for (std::size_t i = 0; i < world; ++i) {
    const auto first = model.held.begin() + model.bodies[i].block_begin, last = model.held.begin() + model.bodies[i].block_end;
    if (std::any_of(first, last, [](auto held) { return held != 0 && held != model::Model::kTied; })) groups.join(i, world);
  }
  std::vector<bool> out(world);
  for (std::size_t i = 0; i < world; ++i) out[i] = groups.of(i) == groups.of(world);
  return out;
}

std::string listed(const std::string& names, const std::string& name) { return names + (names.empty() ? "'" : ", '") + name + "'"; }

}  // namespace

std::string unsupported(const model::Model& model, Index env) {
  const std::vector<Mat3> projector = model.projector.download();
  const std::vector<Vec3> rest = model.rest_points.download();
  const std::vector<bool> is_carried = carried(model);
  std::string loose, turning, hinged;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const model::Body& body = model.bodies[i];
    if (body.env != env) continue;
    const auto first = model.held.begin() + body.block_begin, last = model.held.begin() + body.block_end;
    if (std::all_of(first, last, [](auto held) { return held == 0; })) {
      if (!is_carried[i]) loose = listed(loose, body.name);
    } else if (body.type == model::BodyType::stiff && std::any_of(first, last, [](auto held) { return held == 0; }))
      hinged = listed(hinged, body.name);
    else if (body.type == model::BodyType::soft && free_motions(model, body, projector, rest) > 0)
      turning = listed(turning, body.name);
  }
  std::string text;
  if (!loose.empty())
    text +=
        "\n  nothing but contact can hold " + loose +
        " in this static scene, and it slides off whatever leans by more than friction bears: pin it, name more friction, or make the scene dynamic";
  if (!turning.empty())
    text += "\n  supports let " + turning +
            " move or turn as a whole (held at a point, along a line or in one direction), and nothing but contact keeps it from that: hold more of "
            "it, or make the scene dynamic";
  if (!hinged.empty())
    text += "\n  joints let " + hinged +
            " turn, and springs, contact and the weight of what hangs straight down do not keep it from that: let it start where it comes to rest, "
            "join it otherwise, or make the scene dynamic";
  return text;
}

}  // namespace mortise::solver
