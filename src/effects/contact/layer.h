#pragma once
// The contact layer that a scene does not set: so thin that nobody sees it, and as stiff as the bodies.
//
// Between bodies that are pressed together by a given travel the layer's thickness is taken for indentation, so it should be thin against the
// mesh: a hundredth of its edges moves the force on a pad by less than 1 % and costs Newton's method no more iterations than a tenth does
// (mortar_contact/README.md). Thinner than the facets of a round body are deep, though, it presses at their corners alone, and iterations
// multiply. Such a layer is far stiffer than the mesh under it at any pressure, so its stiffness need not be fitted to one: with
// kappa = E* it is 0.72 d_hat thick at p = 0.3 E*, more than bodies bear, and still open at ten times that.
#include "base/param_table.h"
#include "effects/contact/tuning.h"
#include "model/input.h"

namespace mortise::effects::contact {

// 1/E* = (1 - nu^2)/E of a soft body [1/Pa].
inline double compliance(double youngs_modulus, double poisson_ratio) { return (1 - poisson_ratio * poisson_ratio) / youngs_modulus; }

// `d_hat` of the contact effect with these parameters, or what fits the bodies that it names, all without names [m]. The edge is that of the
// finest mesh, of soft bodies if there are any; of a mesh counts the edge that only a tenth of its surface's edges fall short of, of a stiff body
// no more than a tenth of its least extent. Bodies that begin nearer to each other than the layer is thick have a thinner one (start_gap.h), which
// does not push them apart. Facets are w theta/sqrt(12) deep, with w the edge between two triangles and theta < 30 degrees their
// angle; of a body counts the depth that a tenth exceed.
double support_radius(const Params& effect, const model::ModelInput& input, Index env = 0);
// The same of every environment; `effect`: its block in the scene of the first.
std::vector<double> support_radii(const Params& effect, const model::ModelInput& input, Index envs);

// Its place in the effect's table of parameters.
Param support_radius_param(const std::string& what);

// `stiffness` of the effect, or the largest E* of these bodies, tuning::kRigid where none is soft [Pa].
double stiffness(const Params& effect, const model::ModelInput& input, Index env = 0);

}  // namespace mortise::effects::contact
