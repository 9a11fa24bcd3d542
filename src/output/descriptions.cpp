#include "output/descriptions.h"

namespace mortise::output {
namespace {

// '*' stands for any text: a body, an effect, an axis.
struct Entry {
  std::string_view group, name, text;
};

constexpr Entry kGroups[] = {
    {"balance", "", "forces of the accepted state, summed over all bodies: of every effect, of the supports, and what is left of their sum"},
    {"supports", "", "what holds pinned and driven bodies"},
    {"joint", "", "joints of stiff bodies"},
    {"drive", "", "motors of joints"},
    {"bond", "", "bonds of soft bodies to stiff ones"},
    {"mortar_tie", "", "soft bodies tied surface to surface"},
    {"audit", "", "energy of the frame's state, added up from what the effects report"},
    {"sensor_*", "", "a grid of taxels; taxel = row * columns + column, row 0 at the least y, column 0 at the least x of the sensor's frame"},
    {"*_contact", "", "samples of contact, and sums over bodies and pairs of bodies"},
    {"friction", "", "friction at the samples of contact, and sums over bodies"},
};

constexpr Entry kDatasets[] = {
    {"", "displacement", "position less position at rest"},
    {"", "velocity", "velocity"},
    {"", "contact_force", "force of contact on the node"},
    {"", "contact_pressure", "pressure of contact: normal force on the node over its area"},
    {"", "contact_area", "area of the node that this force is over"},
    {"", "friction_force", "force of friction on the node"},
    {"", "support_force", "force of pins and drives on the node"},
    {"", "tie_force", "force of bonds and ties on the node"},
    {"", "cauchy_stress", "Cauchy stress: xx yy zz xy yz zx"},
    {"", "von_mises", "von Mises stress"},
    {"balance", "largest", "largest force of one effect on one body"},
    {"balance", "written_defect",
     "largest difference, over bodies and effects, between the sum of the forces written as fields and the force in the solved equations"},
    {"balance", "support_*", "sum of the forces of all supports"},
    {"balance", "defect_*", "sum of all forces, supports included: zero but for the residual"},
    {"balance", "*_*", "sum of the forces of this effect on all bodies"},
    {"supports", "work", "work of moving supports in the step that ended here"},
    {"supports", "work_lag", "what this work may be too large by, as forces change within a step of backward Euler"},
    {"supports", "*_defect", "what supports and effects leave over on this body (statics: zero but for the residual)"},
    {"supports", "*_*", "force of the supports on this body"},
    {"joint", "tie_error", "farthest that a joint is off, of axes times the radius of the body"},
    {"joint", "tie_error_mm", "the same in mm"},
    {"joint", "mimic_error_*", "largest miss of a joint that mimics, in the unit that the name says"},
    {"joint", "*_mimic_error", "coordinate of a joint that mimics, less what it should be"},
    {"joint", "*_coupling", "torque or force on its first body by which the joint follows another"},
    {"joint", "*_beside", "how far a slide is beside its axis"},
    {"joint", "*_guide_*", "force of a slide's guide on its first body, across the axis"},
    {"joint", "*_angle", "angle of the hinge, turns counted"},
    {"joint", "*_travel", "way of the slide"},
    {"joint", "*_rate", "rate of the joint over the last step"},
    {"joint", "*_stop", "torque or force of the joint's stops on its first body"},
    {"joint", "*_force_*", "force of the joint on its first body"},
    {"joint", "*_moment_*", "moment of the joint on its first body, about its place"},
    {"joint", "*_place_*", "where the joint is"},
    {"mortar_tie", "tie_error", "farthest that a tied node is off"},
    {"mortar_tie", "*_force_*", "force of the tie on its first body"},
    {"mortar_tie", "*_moment_*", "moment of the tie on its first body, about its place"},
    {"mortar_tie", "*_place_*", "middle of the tied nodes now"},
    {"bond", "tie_error", "farthest that a bonded node is off"},
    {"bond", "*_force_*", "force of the bond on the soft body"},
    {"bond", "*_moment_*", "moment of the bond on the soft body, about its place"},
    {"bond", "*_place_*", "middle of the bonded nodes at rest, as it moves with the stiff body"},
    {"drive", "tracking_error_*", "largest error of a motor that aims at a position, in the unit that the name says"},
    {"drive", "*_target", "what the motor aims at"},
    {"drive", "*_error", "coordinate of the joint less the target"},
    {"drive", "*_torque", "torque of the motor on the joint's first body"},
    {"drive", "*_force", "force of the motor on the joint's first body"},
    {"drive", "*_power", "torque or force times rate"},
    {"drive", "*_drag", "torque or force of the bearing on the joint's first body"},
    {"audit", "total_energy", "kinetic and stored energy of all effects"},
    {"audit", "support_work", "work of moving supports since the start"},
    {"audit", "largest_energy_gain", "largest gain of energy in a step beyond the work of supports, of all steps so far"},
    {"sensor_*", "pressure", "normal force on the taxel over its area, positive into the body"},
    {"sensor_*", "shear", "tangential force on the taxel over its area, along x and y of the sensor's frame"},
    {"sensor_*", "force", "force of contact and friction on the taxel, in the sensor's frame"},
    {"sensor_*", "displacement", "motion of the taxel's material against the sensor's frame since the start, in that frame"},
    {"sensor_*", "area", "area of the taxel's surface now; 0 where the grid reaches beyond the body"},
    {"sensor_*", "wrench_force_*", "sum of contact and friction on the whole body, in the sensor's frame"},
    {"sensor_*", "wrench_moment_*", "moment of contact and friction on the whole body about the frame's origin, in the sensor's frame"},
    {"sensor_*", "origin_*", "origin of the sensor's frame now, in world coordinates"},
    {"sensor_*", "axis_*", "axis of the sensor's frame now: axis_<which>_<component in world coordinates>"},
    {"*_contact", "*position", "where the sample is"},
    {"*_contact", "*normal", "unit normal; it points at the second body, or at the first where the other is an obstacle"},
    {"*_contact", "pair_bodies", "numbers of the two bodies: lines of body_names from 0, half-spaces behind them"},
    {"*_contact", "pair_force", "contact force on the first body of the pair"},
    {"*_contact", "pair_moment", "moment of these forces about the world's origin"},
    {"*_contact", "*bodies", "numbers of the first (slave) and second (master) body: lines of body_names from 0, half-spaces behind them"},
    {"*_contact", "force_share_*", "share of the contact force that samples of this kind carry"},
    {"*_contact", "force_*", "contact force on this body"},
    {"*_contact", "*force", "normal force of the sample"},
    {"*_contact", "*area", "area that the sample stands for; 0 where the method has none"},
    {"*_contact", "*gap", "gap at the sample"},
    {"*_contact", "*pressure", "pressure at the sample"},
    {"*_contact", "kind", "what the sample is made of: 0 faces, 1 edges, 2 points"},
    {"*_contact", "pressure_sum_defect",
     "largest difference, over pairs of bodies, between the forces of the samples and those on the nodes, as a share"},
    {"*_contact", "min_distance", "smallest distance between surfaces that can touch"},
    {"*_contact", "active_pairs", "pairs in contact"},
    {"*_contact", "clip_partition_defect", "largest difference between a covered face and the sum of its pieces, as a share of the face"},
    {"*_contact", "stiffness_*", "contact stiffness of this pair of bodies"},
    {"*_contact", "k_*", "relative stiffness k = kappa b'' h / E* of this pair (README of mortar_contact)"},
    {"*", "energy", "energy of this effect"},
    {"friction", "force", "force of friction on the first body at the sample"},
    {"friction", "slip", "slip of the first body against the second at the sample in this step"},
    {"friction", "traction", "force of friction over the sample's area"},
    {"friction", "normal_force", "normal force that the law works with"},
    {"friction", "sticks", "1 where the sample sticks: its force is below the friction coefficient times the normal one"},
    {"friction", "power", "power that friction takes away"},
    {"friction", "dissipation", "energy dissipated since the start"},
    {"friction", "force_*", "force of friction on this body"},
    {"pressure_load", "force_*", "sum of the load"},
    {"inertia", "kinetic_energy", "kinetic energy"},
    {"inertia", "momentum_*", "linear momentum"},
    {"inertia", "angular_momentum_*", "angular momentum about the world's origin"},
    {"elasticity", "point_stress", "Cauchy stress at the four points of every quadratic tetrahedron: xx yy zz xy yz zx"},
    {"elasticity", "det_F_min", "smallest determinant of the deformation gradient"},
    {"affine_body", "rigidity_defect", "largest |A^T A - I| of a stiff body, about twice its strain"},
    {"affine_body", "stiffness_largest", "largest stiffness that keeps a stiff body rigid"},
};

bool matches(std::string_view pattern, std::string_view text) {
  if (pattern.empty()) return text.empty();
  if (pattern[0] != '*') return !text.empty() && pattern[0] == text[0] && matches(pattern.substr(1), text.substr(1));
  for (std::size_t skip = 0; skip <= text.size(); ++skip)
    if (matches(pattern.substr(1), text.substr(skip))) return true;
  return false;
}

}  // namespace

std::string_view description(std::string_view group) {
  for (const Entry& e : kGroups)
    if (matches(e.group, group)) return e.text;
  return "";
}

std::string_view description(std::string_view group, std::string_view name) {
  for (const Entry& e : kDatasets)
    if (matches(e.group, group) && matches(e.name, name)) return e.text;
  return "";
}

}  // namespace mortise::output
