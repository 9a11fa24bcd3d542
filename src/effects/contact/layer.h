#pragma once
// The contact layer that a scene does not set: so thin that nobody sees it, and as stiff as the bodies.
//
// Between bodies that are pressed together by a given travel the layer's thickness is taken for indentation, so it should be thin against the
// mesh: a hundredth of its edges moves the force on a pad by less than 1 % and costs Newton's method a fifth more iterations than a tenth does
// (mortar_contact/README.md). Such a layer is far stiffer than the mesh under it at any pressure, so its stiffness need not be fitted to one: with
// kappa = E* it is 0.72 d_hat thick at p = 0.3 E*, more than bodies bear, and still open at ten times that.
#include "base/param_table.h"
#include "model/input.h"

namespace mortise::effects::contact {

inline constexpr double kThickness = 0.01;  // d_hat over edge

// 1/E* = (1 - nu^2)/E of a soft body [1/Pa].
inline double compliance(double youngs_modulus, double poisson_ratio) { return (1 - poisson_ratio * poisson_ratio) / youngs_modulus; }

// `d_hat` of the contact effect with these parameters, or kThickness times the finest mesh of the bodies that it names, of all without names:
// of the soft ones if there are any. Of a mesh counts the edge that only a tenth of its surface's edges fall short of, of a stiff body no more
// than a tenth of its least extent [m].
double support_radius(const Params& effect, const model::ModelInput& input);

// Its place in the effect's table of parameters.
Param support_radius_param(const std::string& what);

// `stiffness` of the effect, or the largest E* of these bodies, kRigid where none is soft [Pa].
inline constexpr double kRigid = 1e6;
double stiffness(const Params& effect, const model::ModelInput& input);

}  // namespace mortise::effects::contact
