#include "scene/tables.h"

#include "scene/checks.h"
#include "scene/environments.h"
#include "scene/quantities.h"
#include "scene/robot.h"
#include "scene/sensors.h"

namespace mortise::scene {
namespace {

using Kind = Param::Kind;
using namespace param;

Param length(std::string key, std::string help) { return positive(required(of(Kind::number, std::move(key), Unit::length, {}, std::move(help)))); }
Param vector(std::string key, Unit unit, std::optional<std::string> fallback, std::string help) {
  return of(Kind::vec3, std::move(key), unit, std::move(fallback), std::move(help));
}
Param integer(std::string key, std::optional<std::string> fallback, double min, double max, std::string help) {
  return range(of(Kind::integer, std::move(key), Unit::none, std::move(fallback), std::move(help)), min, max);
}
Param flag(std::string key, std::string fallback, std::string help) {
  return of(Kind::flag, std::move(key), Unit::none, std::move(fallback), std::move(help));
}
Param text(std::string key, std::optional<std::string> fallback, std::string help) {
  return of(Kind::text, std::move(key), Unit::none, std::move(fallback), std::move(help));
}
Param always(Param p) {  // a block that is filled with its defaults when the scene leaves it out
  p.optional = false, p.fallback = "{}";
  return p;
}
Param any_of(std::string key, std::vector<std::string> choices, std::string help) {
  Param p = of(Kind::names, std::move(key), Unit::none, {}, std::move(help));
  p.choices = std::move(choices);
  return p;
}
Param map(std::string key, const ParamTable* sub, std::string help) {
  Param p = of(Kind::map, std::move(key), Unit::none, {}, std::move(help));
  p.sub = sub;
  return p;
}
Param below(Param p, double max) {
  p.max = max, p.max_open = true;
  return p;
}

const ParamTable& time_table() {
  static const ParamTable t{
      "time",
      "Steps of the simulation.",
      {choice("mode", {"dynamic", "static"}, "dynamic", "dynamic marches through time; static finds equilibrium under growing loads."),
       positive(optional(of(Kind::number, "step", Unit::time, {}, "Time step; required when dynamic, not allowed when static."))),
       integer("steps", {}, 1, 1e9, "Number of steps; static: load steps that divide pseudo-time 0..1 evenly."),
       integer("frame_every", "1", 1, 1e9, "A frame is written every so many steps.")}};
  return t;
}

const ParamTable& material_table() {
  static const ParamTable t{
      "material",
      "What a body is made of.",
      {choice("model", {"linear", "corotated", "neo_hookean"}, "neo_hookean", "Elastic law of soft bodies."),
       positive(optional(of(Kind::number, "youngs_modulus", Unit::pressure, {}, "Young's modulus; required for soft bodies"))),
       below(range(optional(of(Kind::number, "poisson_ratio", Unit::none, {}, "Poisson's ratio; required for soft bodies")), 0, 0.5), 0.5),
       choice("volumetric", {"auto", "full", "averaged"}, "auto",
              "How a soft body resists changes of volume: at every point, or on average over the elements around a vertex (order 2: over an "
              "element, of what is beyond Poisson's ratio 0.25), which does not lock near "
              "Poisson's ratio 0.5. auto averages above 0.4."),
       positive(required(of(Kind::number, "density", Unit::density, {}, "Mass per volume at rest.")))}};
  return t;
}

const ParamTable& rotation_table() {
  static const ParamTable t{"rotation",
                            "Rotation about an axis through the body's origin, before `position` is added.",
                            {vector("axis", Unit::none, {}, "Direction of the axis, of any length but zero."),
                             required(of(Kind::number, "angle", Unit::angle, {}, "Angle, right-handed about the axis."))}};
  return t;
}

const ParamTable& box_table() {
  static const ParamTable t{"box",
                            "Box centred at the origin.",
                            {positive(vector("size", Unit::length, {}, "Lengths of the sides along x, y, z.")),
                             length("edge_length",
                                    "Target length of mesh edges; every side gets the nearest even number of cells, below 1.5 edges a single one "
                                    "(four of a stiff box that is not pinned).")}};
  return t;
}
const ParamTable& sphere_table() {
  static const ParamTable t{
      "sphere", "Sphere centred at the origin.", {length("radius", "Radius."), length("edge_length", "Target length of mesh edges.")}};
  return t;
}
const ParamTable& cylinder_table() {
  static const ParamTable t{
      "cylinder",
      "Cylinder centred at the origin, axis z.",
      {length("radius", "Radius."), length("height", "Length along z."), length("edge_length", "Target length of mesh edges.")}};
  return t;
}
const ParamTable& capsule_table() {
  static const ParamTable t{
      "capsule",
      "Capsule centred at the origin, axis z.",
      {length("radius", "Radius of the caps and of the middle part."), length("height", "Length of the cylindrical middle part, without the caps."),
       length("edge_length", "Target length of mesh edges.")}};
  return t;
}
const ParamTable& mesh_table() {
  static const ParamTable t{
      "mesh",
      "Mesh from a file; a surface of a soft body is filled with tetrahedra.",
      {required(of(Kind::path, "file", Unit::none, {}, "Mesh file: .obj, .stl, .ply, .glb, .dae or .msh.")),
       positive(number("scale", Unit::none, "1", 0, "Factor from the file's length unit to metres.")),
       number("weld", Unit::length, "0 m", 0, "Vertices nearer than this are merged."),
       positive(optional(of(Kind::number, "edge_length", Unit::length, {}, "Target length of tetrahedron edges."))),
       positive(optional(of(Kind::number, "surface_edge_length", Unit::length, {}, "Target length of surface edges; absent keeps the surface.")))}};
  return t;
}
std::vector<Param> plain_shapes() {
  return {table("box", &box_table(), "Box."), table("sphere", &sphere_table(), "Sphere."), table("cylinder", &cylinder_table(), "Cylinder."),
          table("capsule", &capsule_table(), "Capsule."), table("mesh", &mesh_table(), "Mesh from a file.")};
}
const ParamTable& part_table() {
  static const ParamTable plain = [] {
    ParamTable s{"shape of a part", "Rest shape: exactly one of these.", plain_shapes()};
    s.one_of = true;
    return s;
  }();
  static const ParamTable t{"part",
                            "One of the shapes that make up a stiff body.",
                            {required(table("shape", &plain, "Its shape.")),
                             vector("position", Unit::length, "[0, 0, 0]", "Where the part's origin is placed in the body's shape."),
                             table("rotation", &rotation_table(), "Rotation of the part about its origin.")}};
  return t;
}
const ParamTable& shape_table() {
  static const ParamTable t = [] {
    ParamTable s{"shape", "Rest shape: exactly one of these.", plain_shapes()};
    Param parts = table("parts", &part_table(), "Several shapes that move as one stiff body; they may overlap (and then weigh twice there).");
    parts.kind = Kind::tables;
    s.params.push_back(std::move(parts));
    s.one_of = true;
    return s;
  }();
  return t;
}

const ParamTable& visual_table() {
  static const ParamTable t{"visual",
                            "How pictures show the body; without a mesh its simulation surface is drawn.",
                            {optional(of(Kind::path, "mesh", Unit::none, {}, "Mesh file that is drawn and moves with the body.")),
                             positive(optional(of(Kind::number, "scale", Unit::none, {},
                                                  "Factor from the mesh file's length unit to metres; without it that of the body's shape."))),
                             vector("position", Unit::length, "[0, 0, 0]", "Where the mesh's origin is placed in the body's shape."),
                             table("rotation", &rotation_table(), "Rotation of the mesh about its origin."),
                             range(vector("color", Unit::none, "[0.7, 0.7, 0.7]", "Base colour: red, green, blue."), 0, 1),
                             optional(of(Kind::path, "texture", Unit::none, {}, "Image file mapped by the mesh's texture coordinates.")),
                             range(number("roughness", Unit::none, "0.6", 0, "0 is a mirror, 1 is matt"), 0, 1),
                             range(number("metallic", Unit::none, "0", 0, "0 is a dielectric, 1 is a metal"), 0, 1)}};
  return t;
}

Param body_type() {
  return required(choice("type", {"soft", "stiff", "half_space"}, "",
                         "soft deforms, stiff is an affine body of few degrees of freedom, half_space is a fixed plane."));
}
std::vector<Param> solid_params() {
  return {body_type(),
          required(table("shape", &shape_table(), "Rest shape.")),
          text("material", {}, "Name of a material."),
          vector("position", Unit::length, "[0, 0, 0]", "Where the shape's origin is placed."),
          table("rotation", &rotation_table(), "Rotation of the shape about its origin."),
          vector("velocity", Unit::velocity, "[0, 0, 0]", "Velocity at the start."),
          vector("angular_velocity", Unit::angular_velocity, "[0, 0, 0]", "Angular velocity about the centre of mass at the start."),
          always(table("visual", &visual_table(), "Appearance in pictures."))};
}
const ParamTable& soft_table() {
  static const ParamTable t = [] {
    ParamTable s{"soft body", "Deformable body of tetrahedra.", solid_params()};
    s.params.push_back(integer("order", "1", 1, 2, "Order of the tetrahedra: 2 has a node in the middle of every edge."));
    s.params.push_back(flag("curved", "false", "Order 2 of a sphere, cylinder or capsule: edges follow the round surface."));
    s.params.push_back(flag("self_contact", "true", "Whether the body can touch itself; false: it passes through itself."));
    return s;
  }();
  return t;
}
const ParamTable& inertia_table() {
  static const ParamTable t{
      "inertia",
      "How the mass of a stiff body is spread, in the axes of its shape.",
      {optional(of(Kind::vec3, "centre", Unit::length, {}, "Centre of mass in the body's shape; without it that of the shape filled evenly.")),
       positive(vector("moments", Unit::none, {}, "Ixx, Iyy, Izz of the tensor of inertia about the centre of mass [kg m^2].")),
       vector("products", Unit::none, "[0, 0, 0]", "Ixy, Ixz, Iyz of that tensor [kg m^2].")}};
  return t;
}
const ParamTable& stiff_table() {
  static const ParamTable t = [] {
    ParamTable s{"stiff body", "Body that moves by an affine map, nearly rigid.", solid_params()};
    for (Param& p : s.params)
      if (p.key == "material")
        p.optional = true, p.help = "Name of a material, whose density fills the shape; a body that states its mass needs none.";
    s.params.push_back(positive(optional(of(Kind::number, "mass", Unit::mass, {}, "Mass, whatever the material's density."))));
    s.params.push_back(table("inertia", &inertia_table(), "How the mass is spread; without it evenly over the shape. Needs `mass`."));
    return s;
  }();
  return t;
}
const ParamTable& half_space_table() {
  static const ParamTable t{"half space",
                            "Everything behind a plane is solid and does not move.",
                            {body_type(), vector("point", Unit::length, "[0, 0, 0]", "A point of the plane."),
                             vector("normal", Unit::none, "[0, 0, 1]", "Direction out of the solid, of any length but zero."),
                             always(table("visual", &visual_table(), "Appearance in pictures."))}};
  return t;
}
const ParamTable& body_table() {
  static const ParamTable t{"body", "One body; its keys depend on `type`.", {body_type()}};
  return t;
}

const ParamTable& pair_table() {
  static const ParamTable t{
      "pair",
      "What holds between two bodies, whatever effects say.",
      {required(of(Kind::names, "bodies", Unit::none, {}, "The two bodies, half-spaces included; of more than two, every pair among them.")),
       required(of(Kind::flag, "collide", Unit::none, {}, "false: they pass through each other, and no force acts between them."))}};
  return t;
}

const ParamTable& solver_table() {
  static const ParamTable t{
      "solver",
      "When a step counts as solved, and how its linear systems are solved.",
      {number("force_tolerance", Unit::force, "0 N", 0, "Residual forces on a body that are no larger than this are as good as none."),
       below(number("relative_tolerance", Unit::none, "1e-6", 0,
                    "A step has converged when the residual forces on every body are at most this share of the forces on its own free nodes, and the "
                    "next Newton step is short."),
             1),
       number("step_tolerance", Unit::length, "0 m", 0, "And, when above zero, the last Newton step moved nothing further than this."),
       integer("iterations", "100", 1, 100000, "Most Newton iterations of one step."),
       choice("linear", {"auto", "direct", "reuse", "cg"}, "auto",
              "Linear solver: a Cholesky factor in every iteration, one that is reused while it pays, or conjugate gradients."),
       choice("preconditioner", {"auto", "jacobi", "mas"}, "auto",
              "For conjugate gradients: the diagonal blocks, or multilevel additive Schwarz, dearer but better on large bodies."),
       choice("cg_forcing", {"eisenstat_walker", "fixed"}, "eisenstat_walker",
              "Conjugate gradients stop where Newton's progress makes more digits pointless, or always at cg_tolerance."),
       below(positive(number("cg_tolerance", Unit::none, "1e-8", 0, "Smallest relative residual that conjugate gradients aim at.")), 1),
       integer("cg_iterations", "10000", 1, 10000000, "Most iterations of one linear solve by conjugate gradients."),
       integer("halvings", "6", 0, 30, "How often a failed step is tried again with half its length."),
       flag("trace", "false", "Write what every Newton iteration did to newton.csv.")}};
  return t;
}

const ParamTable& checkpoint_table() {
  static const ParamTable t = [] {
    ParamTable s{
        "checkpoint_every",
        "How often the state is saved, from which --resume continues: exactly one of these.",
        {integer("steps", {}, 1, 1e9, "After every so many steps."),
         positive(of(Kind::number, "seconds", Unit::time, {}, "After the first step that ends this long after the last time, by the clock."))}};
    s.one_of = true;
    for (Param& p : s.params) p.optional = true;
    return s;
  }();
  return t;
}

const ParamTable& output_table() {
  static const ParamTable t{
      "output",
      "What a run writes.",
      {optional(of(Kind::names, "fields", Unit::none, {}, "Names of the fields to keep; absent keeps all.")),
       choice("precision", {"single", "double"}, "single", "Floating-point format of the fields."),
       flag("pictures", "true", "Whether pictures are drawn: by the cameras of `render`, and of sensors."),
       table("checkpoint_every", &checkpoint_table(),
             "How often the state is saved; absent saves it with frames, as long as that takes at most a twentieth of the time. The "
             "start and the last step always save it.")}};
  return t;
}

const ParamTable& traction_table() {
  static const ParamTable t{"traction",
                            "Arrows of what acts on the surfaces that the camera sees, per area.",
                            {of(Kind::names, "of", Unit::none, "[contact_force, friction_force]",
                                "Fields of forces on points, which are added up; those that no effect reports are left out."),
                             positive(optional(of(Kind::number, "length", Unit::length, {},
                                                  "Of the longest arrow; absent: an eighth of the height that the picture shows at look_at."))),
                             positive(optional(of(Kind::number, "longest", Unit::pressure, {},
                                                  "What the longest arrow stands for; absent: the largest traction so far.")))}};
  return t;
}

const ParamTable& camera_table() {
  static const ParamTable t{
      "camera",
      "Pictures of every frame, each set with a file of where the camera was and how it projects.",
      {vector("position", Unit::length, {}, "Where the camera stands."), vector("look_at", Unit::length, {}, "Point in the middle of the picture."),
       vector("up", Unit::none, "[0, 0, 1]",
              "Direction that is up in the picture; [0, 1, 0] where the camera looks along z and nothing else is said."),
       choice("model", {"pinhole", "fisheye"}, "pinhole",
              "Projection; fisheye: the angle from the axis is proportional to the distance from the middle."),
       positive(
           range(number("fov", Unit::angle, "35 deg", 0, "Field of view: of the height (pinhole, below 180 deg), of the image circle (fisheye)."), 0,
                 6.2831853071796)),
       optional(any_of("outputs", {"color", "depth", "depth_float", "segmentation"},
                       "What is written: color pictures, depth images (16-bit PNG), depth in metres (32-bit floats of NumPy), images of which body "
                       "is seen (indexed PNG); absent: color.")),
       positive(optional(of(Kind::number, "depth_unit", Unit::length, {}, "What one count of a depth image stands for; absent: 1 mm."))),
       table("traction", &traction_table(), "Arrows of what acts on the surfaces that the camera sees, per area."),
       optional(of(Kind::text, "rides_on", Unit::none, {},
                   "Name of a body that the camera moves with, as rigidly as that does; position, look_at and up are those of the start.")),
       optional(of(Kind::names, "hide", Unit::none, {}, "Names of bodies that this camera does not see.")),
       range(optional(of(Kind::vec3, "background", Unit::none, {}, "Background colour of this camera; absent takes that of `render`.")), 0, 1),
       optional(of(Kind::flag, "annotate", Unit::none, {},
                   "false: no time, colour bar and length of arrows on color pictures, as for data sets; absent: with them.")),
       optional(of(Kind::text, "colour_by", Unit::none, {}, "Field that colours the bodies.")),
       optional(of(Kind::numbers, "range", Unit::any, {}, "Values at the two ends of the colour scale; absent takes the run's extremes.")),
       optional(of(Kind::text, "unit", Unit::none, {},
                   "Unit of the numbers at the colour scale, one of what the field measures; absent takes that of SI."))}};
  return t;
}
const ParamTable& render_table() {
  static const Param cameras = optional(map("cameras", &camera_table(), "Cameras by name; a scene with sensors may go without."));
  static const ParamTable t{
      "render",
      "Pictures of the run.",
      {integer("width", "1280", 16, 8192, "Width of the pictures in pixels."),
       integer("height", "720", 16, 8192, "Height of the pictures in pixels."),
       range(vector("background", Unit::none, "[1, 1, 1]", "Background colour: red, green, blue."), 0, 1),
       integer("every", "1", 1, 1e9, "Pictures, those of sensors too, are drawn of every so many frames, from frame 0 on."), cameras}};
  return t;
}

}  // namespace

const Variants* variants_of(const ParamTable& t) {
  static const Variants body{&body_table(), "type", {{"soft", &soft_table()}, {"stiff", &stiff_table()}, {"half_space", &half_space_table()}}};
  if (&t == &check_table()) return &check_variants();
  return &t == body.table ? &body : nullptr;
}

SceneTables::SceneTables(std::span<const EffectTable> effects) {
  effects_.name = "effects";
  effects_.help = "The physics of the scene: what is not named here does not exist.";
  for (const EffectTable& e : effects) {
    Param p = table(e.name, e.table, e.help);
    if (e.table->is_list) p.kind = Kind::tables;
    effects_.params.push_back(std::move(p));
  }
  Param checks = table("checks", &check_table(), "What a run has to fulfil; the verdicts are in certificate.json.");
  checks.kind = Kind::tables;
  Param quantities =
      table("quantities", &quantity_table(), "Numbers that the scene is about: certificate.json says how wrong they are, as far as it can.");
  quantities.kind = Kind::tables;
  Param pairs = table("pairs", &pair_table(), "Pairs of bodies that differ from the others.");
  pairs.kind = Kind::tables;
  Param sensors = map("sensors", &sensor_table(), "Grids of taxels by name.");
  sensors.optional = true;
  root_.name = "scene";
  root_.help = "A mortise scene.";
  root_.params = {integer("mortise", {}, kFormatVersion, kFormatVersion, "Version of the scene format."),
                  text("name", "scene", "Short name of the scene: a-z, 0-9, _ and -."),
                  text("description", "\"\"", "One line on what happens."),
                  required(table("time", &time_table(), "Steps of the simulation.")),
                  table("robot", &robot_table(), "A robot's file, which stands for bodies, joints, motors, contact and cameras."),
                  map("materials", &material_table(), "Materials by name."),
                  map("bodies", &body_table(), "Bodies by name."),
                  pairs,
                  required(table("effects", &effects_, "The physics: what is not named here does not exist.")),
                  always(table("solver", &solver_table(), "Accuracy and effort of the solver.")),
                  always(table("output", &output_table(), "What a run writes.")),
                  checks,
                  quantities,
                  sensors,
                  table("environments", &environments_table(), "Many copies of the scene, with numbers drawn at random."),
                  table("render", &render_table(), "Pictures of the run.")};
  for (Param& p : root_.params)
    if (p.key == "materials") p.fallback = "{}";
}

}  // namespace mortise::scene
