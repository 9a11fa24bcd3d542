#include "effects/mortar_contact/parameters.h"

#include <string>

#include "base/error.h"
#include "effects/contact/layer.h"

namespace mortise::effects::mortar {
namespace {

const ParamTable kPair{
    "contact pair of mortar_contact",
    "Which surface carries the samples and which one they see.",
    {param::of(Param::Kind::text, "slave", Unit::none, std::nullopt, "Body whose surface is integrated over: the finer, the softer, the sensor"),
     param::of(Param::Kind::text, "master", Unit::none, std::nullopt, "Body or half-space that presses on it")}};

Param pair_list() {
  Param p = param::required(param::table("pairs", &kPair, "Surfaces in contact"));
  p.kind = Param::Kind::tables;
  return p;
}

const ParamTable kTable{
    "effect mortar_contact",
    "Contact pressure as a field: a barrier integrated over the exact overlap of two surfaces (geometric mortar contact "
    "potential).",
    {pair_list(), contact::support_radius_param("Gap at which contact begins to act"),
     param::positive(
         param::automatic(param::number("stiffness", Unit::pressure, "1 MPa", 0,
                                        "Pressure scale kappa: the pressure is kappa phi(gap/d_hat); auto, or without it, the bodies' E* "
                                        "where d_hat is left open too, else chosen so that the layer is four times as stiff as the mesh"))),
     param::choice("weights", {"consistent", "tapered"}, "consistent",
                   "consistent: exact overlap, passes the patch test, with edge and point samples where surfaces are not "
                   "parallel; tapered: the published form"),
     param::positive(param::range(
         param::number("taper_width", Unit::none, "0.1", 0, "Width of the taper of tapered weights, in barycentric coordinates of the master"), 0,
         1.0 / 3)),
     param::choice("quadrature", {"1", "3", "6", "7", "exact"}, "3",
                   "Gauss points per piece of overlap; exact: along lines of equal gap, as many as the barrier asks for"),
     param::choice("gap", {"pointwise", "averaged"}, "pointwise",
                   "pointwise: every sample has its barrier; averaged: every slave node has one, over the mean gap around it, which "
                   "keeps pressures smooth however large the stiffness is"),
     param::choice("gradient", {"frozen", "exact"}, "frozen",
                   "frozen: forces along the slave normal (published form); exact: also the turning of the normal, forces along "
                   "the master normal"),
     param::range(param::number("guard", Unit::none, "0.2", 0,
                                "Share of d_hat within which a barrier between points, edges and triangles acts as well; 0: none"),
                  0, 1),
     param::range(param::number("rest_share", Unit::none, "0", 0,
                                "d_hat is reduced to this share of the gap at the start, triangle by triangle, so that nothing "
                                "presses at the start (1); 0: it is not"),
                  0, 1),
     param::of(Param::Kind::flag, "two_pass", Unit::none, "false", "Both surfaces of every pair are slaves, with half of the weight")}};

}  // namespace

const ParamTable& parameters() { return kTable; }

Settings settings_of(const Params& p, bool quadratic) {
  Settings out;
  out.taper = p.text("weights") == "tapered" ? p.number("taper_width") : 0;
  out.quadrature = p.text("quadrature") == "exact" ? kExact : std::stoi(p.text("quadrature"));
  out.exact = p.text("gradient") == "exact";
  out.averaged = p.text("gap") == "averaged";
  out.pass_weight = p.flag("two_pass") ? 0.5 : 1;
  if (out.averaged && (p.number("rest_share") > 0 || quadratic))
    throw Error(Exit::scene, p.at("gap").where(), "averaged gaps need linear tetrahedra and no rest_share");
  if (out.quadrature == 1 && quadratic)
    throw Error(Exit::scene, p.at("quadrature").where(), "one point per piece is not enough for the shape functions of quadratic faces: 3, 6 or 7");
  return out;
}

}  // namespace mortise::effects::mortar
