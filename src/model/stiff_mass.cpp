#include "model/stiff_mass.h"

#include <Eigen/Eigenvalues>

#include "geometry/placement.h"
#include "geometry/topology.h"

namespace mortise::model {
namespace {

// Below this share of its trace the second moment counts as none along an axis: the mass matrix could not be factored safely.
constexpr double kThinnest = 1e-6;

Mat3 stated_second_moment(const BodyInput& body, const Params& inertia, const Mat3& R) {
  const Vec3 m = inertia.vec3("moments"), p = inertia.vec3("products");
  Mat3 I;
  I << m[0], p[0], p[1], p[0], m[1], p[2], p[1], p[2], m[2];
  const Mat3 S = geometry::second_moment_of(I);
  if (!(Eigen::SelfAdjointEigenSolver<Mat3>(S, Eigen::EigenvaluesOnly).eigenvalues()[0] > kThinnest * S.trace())) {
    const Vec3 principal = Eigen::SelfAdjointEigenSolver<Mat3>(I, Eigen::EigenvaluesOnly).eigenvalues();
    char moments[120];
    std::snprintf(moments, sizeof moments, "%.4g, %.4g and %.4g kg m^2", principal[0], principal[1], principal[2]);
    throw Error(
        Exit::scene, inertia.where(),
        "body '" + body.name + "': no body has the principal moments of inertia " + moments + "; each must be below the sum of the other two");
  }
  return R * S * R.transpose();
}

}  // namespace

StiffMass stiff_mass(const BodyInput& body) {
  const geometry::MassProperties shape = geometry::mass_properties({body.nodes, body.triangles});
  if (!(shape.volume > 0))
    throw Error(Exit::scene, body.params.where(), "body '" + body.name + "': its surface encloses no positive volume (are the triangles outward?)");
  const Params *mass = body.params.find("mass"), *inertia = body.params.find("inertia");
  StiffMass out{0, shape.volume, shape.centroid};
  const double density = mass ? mass->as_number() / shape.volume : body.material.number("density");
  out.mass = mass ? mass->as_number() : density * shape.volume;
  if (!inertia) {
    out.second_moment = density * shape.second_moment;
    return out;
  }
  const geometry::Placement place(body.params);
  if (const Params* centre = inertia->find("centre")) out.centre = place(centre->as_vec3());
  out.second_moment = stated_second_moment(body, *inertia, place.R);
  return out;
}

}  // namespace mortise::model
