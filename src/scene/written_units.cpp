#include "scene/written_units.h"

#include "scene/checker.h"
#include "scene/field_units.h"
#include "scene/quantity.h"

namespace mortise::scene {
namespace {

void check_unit(const Node& number, Unit unit, const std::string& path, Diagnostics& errors) {
  if (number.kind != Node::Kind::scalar || !parse_quantity(number.text, Unit::any).error.empty()) return;  // told already
  if (const Quantity q = parse_quantity(number.text, unit); !q.error.empty()) errors.add(number.at, path + " " + q.error, q.hint);
}

struct OfDrive {
  const char* key;
  Unit hinge, slide;
};
constexpr OfDrive kOfDrive[] = {
    {"kp", Unit::angular_stiffness, Unit::stiffness},
    {"kd", Unit::angular_damping, Unit::damping},
    {"effort", Unit::torque, Unit::force},
    {"velocity", Unit::angular_velocity, Unit::velocity},
    {"damping", Unit::angular_damping, Unit::damping},
    {"friction", Unit::torque, Unit::force},
    {"stiffness", Unit::angular_stiffness, Unit::stiffness},
    {"rest", Unit::angle, Unit::length},
    {"armature", Unit::rotary_inertia, Unit::mass},
};

void check_drive(const Node& drive, const Params& joints, const std::string& path, Diagnostics& errors) {
  const Node* name = drive.find("joint");
  for (const Params& joint : joints.items()) {
    const Params *called = joint.find("name"), *type = joint.find("type");
    if (!name || !called || !type || called->as_text() != name->text) continue;
    const bool hinge = type->as_text() == "revolute";
    if (!hinge && type->as_text() != "prismatic") continue;
    for (const OfDrive& of : kOfDrive)
      if (const Node* number = drive.find(of.key)) check_unit(*number, hinge ? of.hinge : of.slide, dotted(path, of.key), errors);
  }
}

}  // namespace

void check_written_units(const Node& root, const Params& resolved, Diagnostics& errors) {
  const Node *effects = root.find("effects"), *drives = effects ? effects->find("drive") : nullptr;
  const Params *known = resolved.find("effects"), *joints = known ? known->find("joint") : nullptr;
  if (drives && joints && drives->kind == Node::Kind::map) check_drive(*drives, *joints, "effects.drive.0", errors);
  if (drives && joints)
    for (std::size_t i = 0; i < drives->items.size(); ++i) check_drive(drives->items[i], *joints, "effects.drive." + std::to_string(i), errors);

  const Node *render = root.find("render"), *cameras = render ? render->find("cameras") : nullptr;
  if (!cameras) return;
  for (const auto& [name, camera] : cameras->entries) {
    const Node *by = camera.find("colour_by"), *range = camera.find("range");
    if (!by || !range) continue;
    for (std::size_t i = 0; i < range->items.size(); ++i)
      check_unit(range->items[i], unit_of_field(by->text).unit, "render.cameras." + name + ".range." + std::to_string(i), errors);
  }
}

}  // namespace mortise::scene
