#include "importers/urdf/read.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

namespace mortise::importers::urdf {
namespace {

// Turns about the fixed axes x, y and z, in this order.
Mat3 of_rpy(const Vec3& rpy) {
  const auto turn = [](double angle, int axis) { return Eigen::AngleAxisd(angle, Vec3::Unit(axis)); };
  return (turn(rpy[2], 2) * turn(rpy[1], 1) * turn(rpy[0], 0)).toRotationMatrix();
}

class Reader {
 public:
  explicit Reader(Notes& notes) : notes_(notes) {}

  Robot robot(const Element& root) {
    robot_.path = root.source().path();
    for (const Element& e : root.children())
      if (e.name().rfind("xacro:", 0) == 0) e.fail("<" + e.name() + ">: this is a xacro file; expand it first: xacro FILE > robot.urdf");
    root.expect({"name", "version"}, {"link", "joint", "material"},
                {"transmission", "gazebo", "sensor", "ros2_control", "mujoco", "plugin", "actuator"}, notes_);
    robot_.name = root.has("name") ? root.text("name") : "robot";
    for (const Element& m : root.children("material")) material(m, true);
    for (const Element& l : root.children("link")) link(l);
    for (const Element& j : root.children("joint")) joint(j);
    if (robot_.links.empty()) root.fail("the robot has no <link>");
    robot_.make_tree();
    return std::move(robot_);
  }

 private:
  Pose origin(const Element& of) {
    const auto o = of.child("origin");
    if (!o) return {};
    o->expect({"xyz", "rpy"}, {}, {}, notes_);
    return {of_rpy(o->vector("rpy", Vec3::Zero())), o->vector("xyz", Vec3::Zero())};
  }

  // Colour of a <material>, which may be defined elsewhere by name.
  std::optional<Vec3> material(const Element& m, bool defines) {
    m.expect({"name"}, {"color", "texture"}, {}, notes_);
    const std::string name = m.has("name") ? m.text("name") : "";
    if (const auto t = m.child("texture"); t && t->has("filename") && !name.empty()) textures_.emplace(name, t->text("filename"));
    if (const auto c = m.child("color")) {
      c->expect({"rgba", "rgb"}, {}, {}, notes_);
      const std::vector<double> v = c->numbers(c->has("rgb") ? "rgb" : "rgba");
      if (v.size() < 3) c->fail("a colour is made of three numbers and an opacity");
      const Vec3 colour = Vec3(v[0], v[1], v[2]).cwiseMax(0).cwiseMin(1);
      if (defines || !name.empty()) colours_.emplace(name, colour);
      return colour;
    }
    const auto it = colours_.find(name);
    return it == colours_.end() ? std::nullopt : std::optional(it->second);
  }

  Shape shape(const Element& e) {
    Shape out;
    out.where = e.where();
    out.at = origin(e);
    const auto geometry = e.child("geometry");
    if (!geometry) e.fail("<" + e.name() + "> has no <geometry>");
    geometry->expect({}, {"box", "cylinder", "sphere", "capsule", "mesh"}, {"plane", "heightmap", "polyline"}, notes_);
    const auto positive = [](const Element& g, const char* key) {
      const double x = g.number(key);
      if (!(x > 0)) g.fail("attribute '" + std::string(key) + "' of <" + g.name() + "> must be above zero");
      return x;
    };
    if (const auto box = geometry->child("box")) {
      box->expect({"size"}, {}, {}, notes_);
      out.kind = Shape::Kind::box, out.size = box->vector("size");
      if (!(out.size.minCoeff() > 0)) box->fail("attribute 'size' of <box> must be above zero");
    } else if (const auto sphere = geometry->child("sphere")) {
      sphere->expect({"radius"}, {}, {}, notes_);
      out.kind = Shape::Kind::sphere, out.radius = positive(*sphere, "radius");
    } else if (const auto mesh = geometry->child("mesh")) {
      mesh->expect({"filename", "scale"}, {}, {}, notes_);
      out.kind = Shape::Kind::mesh, out.file = mesh->text("filename"), out.where = mesh->where();
      if (mesh->has("scale")) {
        const std::vector<double> s = mesh->numbers("scale");
        if (s.size() != 3 && s.size() != 1) mesh->fail("attribute 'scale' of <mesh> must be three numbers");
        out.scale = s.size() == 1 ? Vec3::Constant(s[0]) : Vec3(s[0], s[1], s[2]);
        if (out.scale.prod() == 0) mesh->fail("attribute 'scale' of <mesh> is zero");
      }
    } else {
      const bool round = geometry->child("cylinder").has_value();
      const auto g = geometry->child(round ? "cylinder" : "capsule");
      if (!g) geometry->fail("<geometry> holds none of box, cylinder, sphere, capsule, mesh");
      g->expect({"radius", "length"}, {}, {}, notes_);
      out.kind = round ? Shape::Kind::cylinder : Shape::Kind::capsule, out.radius = positive(*g, "radius"), out.length = positive(*g, "length");
    }
    return out;
  }

  void link(const Element& e) {
    e.expect({"name"}, {"inertial", "visual", "collision"}, {"type", "self_collide", "kinematic", "contact", "sensor", "gravity"}, notes_);
    Link l;
    l.name = e.text("name"), l.where = e.where();
    for (const Link& other : robot_.links)
      if (other.name == l.name) e.fail("a second link '" + l.name + "'; the first is in line " + std::to_string(other.where.line));
    if (const auto i = e.child("inertial")) {
      i->expect({}, {"origin", "mass", "inertia"}, {}, notes_);
      Inertial in;
      in.where = i->where();
      const Pose at = origin(*i);
      in.centre = at.t;
      const auto mass = i->child("mass"), tensor = i->child("inertia");
      if (!mass) i->fail("<inertial> has no <mass>");
      mass->expect({"value"}, {}, {}, notes_);
      in.mass = mass->number("value");
      if (in.mass < 0) mass->fail("the mass is negative");
      if (tensor) {
        tensor->expect({"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}, {}, {}, notes_);
        const double xy = tensor->number("ixy", 0.0), xz = tensor->number("ixz", 0.0), yz = tensor->number("iyz", 0.0);
        Mat3 I;
        I << tensor->number("ixx"), xy, xz, xy, tensor->number("iyy"), yz, xz, yz, tensor->number("izz");
        in.tensor = at.R * I * at.R.transpose();
      }
      l.inertial = in;
    }
    for (const Element& v : e.children("visual")) {
      v.expect({"name"}, {"origin", "geometry", "material"}, {}, notes_);
      l.visuals.push_back(shape(v));
      const std::vector<Element> materials = v.children("material");  // exporters write one per part of the mesh
      if (materials.empty()) continue;
      l.visuals.back().colour = material(materials[0], false);
      if (const auto t = materials[0].child("texture"); t && t->has("filename"))
        l.visuals.back().texture = t->text("filename");
      else if (const auto it = textures_.find(materials[0].text("name", "")); it != textures_.end())
        l.visuals.back().texture = it->second;
    }
    for (const Element& c : e.children("collision")) {
      c.expect({"name"}, {"origin", "geometry"}, {"verbose", "contact_coefficients", "group", "material", "surface"}, notes_);
      l.collisions.push_back(shape(c));
    }
    robot_.links.push_back(std::move(l));
  }

  std::size_t link_named(const Element& joint, const char* which) {
    const auto e = joint.child(which);
    if (!e) joint.fail("joint '" + joint.text("name") + "' has no <" + which + ">");
    const std::string name = e->text("link");
    std::vector<std::string> names;
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      if (robot_.links[i].name == name) return i;
      names.push_back(robot_.links[i].name);
    }
    e->fail(with_hint("there is no link '" + name + "'", name, names));
  }

  void joint(const Element& e) {
    e.expect({"name", "type"}, {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic"},
             {"dont_collapse", "calibration", "safety_controller", "motor", "hardwareInterface"}, notes_);
    Joint j;
    j.name = e.text("name"), j.where = e.where();
    for (const Joint& other : robot_.joints)
      if (other.name == j.name) e.fail("a second joint '" + j.name + "'; the first is in line " + std::to_string(other.where.line));
    const std::string type = e.text("type");
    const bool turns = type == "revolute" || type == "continuous", slides = type == "prismatic";
    if (turns || slides)
      j.type = turns ? Joint::Type::revolute : Joint::Type::prismatic;
    else if (type == "floating")
      j.type = Joint::Type::floating;
    else if (type != "fixed")
      e.fail("joint '" + j.name + "' is '" + type + "'; only revolute, continuous, prismatic, fixed and floating joints are imported");
    j.parent = link_named(e, "parent"), j.child = link_named(e, "child");
    if (j.parent == j.child) e.fail("joint '" + j.name + "' joins a link to itself");
    j.origin = origin(e);
    if (j.moves()) {
      motion(e, type, j);
      j.fix_where_it_cannot_move(notes_);
    }
    robot_.joints.push_back(std::move(j));
  }

  static double not_negative(const Element& e, const char* key) {
    const double v = e.number(key, 0.0);
    if (v < 0) e.fail(std::string("'") + key + "' is less than 0");
    return v;
  }
  // More than a turn and no more than 360: joints that turn for ever have more.
  static bool in_degrees(const std::pair<double, double>& limits) {
    const double most = std::max(std::abs(limits.first), std::abs(limits.second));
    return most > 2 * M_PI * (1 + 1e-3) && most <= 360;
  }

  void motion(const Element& e, const std::string& type, Joint& j) {
    if (const auto a = e.child("axis")) {
      j.axis = a->vector("xyz");
      if (!(j.axis.norm() > 0)) a->fail("the axis of joint '" + j.name + "' is zero");
      j.axis.normalize();
    }
    const auto limit = e.child("limit");
    if (!limit && type != "continuous") e.fail("a " + type + " joint needs a <limit>");
    if (limit) {
      limit->expect({"lower", "upper", "effort", "velocity"}, {}, {"stiffness", "damping", "acceleration", "jerk"}, notes_);
      j.effort = not_negative(*limit, "effort"), j.velocity = not_negative(*limit, "velocity");
      for (const auto& [key, most] : {std::pair{"effort", j.effort}, std::pair{"velocity", j.velocity}})
        if (limit->has(key) && most == 0) notes_.add(limit->where(), std::string("a limit of '") + key + "' 0 is none: motors go without");
      if (type != "continuous") {
        j.limits = {limit->number("lower", 0.0), limit->number("upper", 0.0)};
        if (j.limits->first > j.limits->second) limit->fail("joint '" + j.name + "': 'lower' is above 'upper'");
        if (type == "revolute" && in_degrees(*j.limits)) notes_.add(limit->where(), "limits of more than a turn: angles of URDF are radians");
      }
    }
    if (const auto d = e.child("dynamics")) {
      d->expect({"damping", "friction", "spring_reference", "spring_stiffness", "armature"}, {}, {}, notes_);
      j.stiffness = not_negative(*d, "spring_stiffness"), j.rest = d->number("spring_reference", 0.0);
      j.armature = not_negative(*d, "armature"), j.damping = not_negative(*d, "damping"), j.friction = not_negative(*d, "friction");
    }
    if (const auto m = e.child("mimic")) {
      m->expect({"joint", "multiplier", "offset"}, {}, {}, notes_);
      j.mimic = Joint::Mimic{m->text("joint"), m->number("multiplier", 1.0), m->number("offset", 0.0)};
    }
  }

  Robot robot_;
  Notes& notes_;
  std::map<std::string, Vec3> colours_;
  std::map<std::string, std::string> textures_;
};

}  // namespace

Robot read(const Document& document, Notes& notes) { return Reader(notes).robot(document.root()); }

}  // namespace mortise::importers::urdf
