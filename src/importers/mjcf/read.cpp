#include "importers/mjcf/read.h"

#include <algorithm>

#include "importers/mjcf/actuators.h"
#include "importers/mjcf/assets.h"
#include "importers/mjcf/include.h"
#include "importers/mjcf/keyframe.h"
#include "importers/mjcf/words.h"

namespace mortise::importers::mjcf {
namespace {

// Of the link between two joints of one body [kg, kg m^2]: a bearing of a few millimetres. MuJoCo has none there.
constexpr double kBearingMass = 1e-3, kBearingInertia = 1e-7;

// Something in a body, with the frames around it counted in.
struct Inside {
  Element element;
  Pose at;
  std::string around;  // class of what names none
};

class Reader {
 public:
  Reader(const Element& root, Notes& notes) : root_(root), notes_(notes), assets_(compiler_, defaults_, notes) {}

  Robot robot() {
    root_.expect({"model"}, words::sections, words::dropped_sections, notes_);
    robot_.path = root_.source().path(), robot_.name = root_.text("model", "robot");
    for (const Element& e : root_.children("compiler")) compiler_.read(e, notes_);
    for (const Element& e : root_.children("default")) defaults_.read(e);
    for (const Element& e : defaults_.written())
      if (const auto known = words::of_defaults.find(e.name()); known != words::of_defaults.end())
        e.expect(known->second.first, {}, known->second.second, notes_);
    for (const Element& e : root_.children("asset")) assets_.read(e);
    const std::vector<Element> worlds = root_.children("worldbody");
    if (worlds.empty()) root_.fail("there is no <worldbody>");
    robot_.links.emplace_back();
    robot_.links[0].name = "world", robot_.links[0].where = worlds[0].where();
    for (const Element& w : worlds) content(w, 0, inside(w, Pose{}, "main"));
    if (robot_.links.size() == 1) worlds[0].fail("there is no <body> in the world");
    read_actuators(root_, defaults_, robot_, notes_);
    read_equality(root_, robot_, notes_);
    read_contact(root_, robot_, notes_);
    read_keyframe(root_, robot_, notes_);
    for (Joint& j : robot_.joints) j.fix_where_it_cannot_move(notes_);
    robot_.make_tree();
    return std::move(robot_);
  }

 private:
  // Everything in a body in its order; a <frame> is only a place.
  std::vector<Inside> inside(const Element& body, const Pose& at, const std::string& around) {
    std::vector<Inside> out;
    for (const Element& e : body.children()) {
      if (e.name() != "frame") {
        out.push_back({e, at, around});
        continue;
      }
      e.expect(words::with_pose({"name", "childclass"}), words::in_body, words::dropped_in_body, notes_);
      const std::vector<Inside> deeper = inside(e, at * compiler_.pose(e), e.text("childclass", around));
      out.insert(out.end(), deeper.begin(), deeper.end());
    }
    return out;
  }

  void content(const Element& body, std::size_t link, const std::vector<Inside>& all) {
    for (const Inside& i : all)
      if (i.element.name() == "inertial")
        inertial(i, robot_.links[link]);
      else if (i.element.name() == "geom")
        geom(i, robot_.links[link]);
    for (const Inside& i : all)
      if (i.element.name() == "body") this->body(i, link);
    body.expect(words::with_pose({"name", "childclass"}), words::in_body, words::dropped_in_body, notes_);
  }

  void inertial(const Inside& i, Link& link) {
    const Element& e = i.element;
    e.expect(words::with_pose({"mass", "diaginertia", "fullinertia", "class"}), {}, {}, notes_);
    Inertial in;
    in.where = e.where();
    const Pose at = i.at * compiler_.pose(e);
    in.centre = at.t, in.mass = e.number("mass");
    if (in.mass < 0) e.fail("the mass is negative");
    if (e.has("fullinertia")) {
      const std::vector<double> m = e.numbers("fullinertia", 6);
      in.tensor << m[0], m[3], m[4], m[3], m[1], m[5], m[4], m[5], m[2];
    } else if (e.has("diaginertia")) {
      in.tensor = e.vector("diaginertia").asDiagonal();
    }
    in.tensor = at.R * in.tensor * at.R.transpose();
    if (link.inertial) e.fail("a second <inertial>");
    link.inertial = in;
  }

  void geom(const Inside& i, Link& link) {
    i.element.expect(words::with_pose(words::geom), {}, words::dropped_geom, notes_);
    const Element g = defaults_.complete(i.element, i.around);
    std::optional<Shape> s = assets_.shape(g, i.at);
    if (!s) return;
    if (&link == &robot_.links[0]) s->mass.reset(), s->density.reset();  // the world weighs nothing
    (s->contype == 0 && s->conaffinity == 0 ? link.visuals : link.collisions).push_back(*s);
  }

  void body(const Inside& i, std::size_t parent) {
    const Element& e = i.element;
    const std::string around = e.text("childclass", i.around);
    Link link;
    link.where = e.where();
    link.name = e.has("name") ? e.text("name") : parent == 0 ? robot_.name : robot_.links[parent].name + "_part";
    const auto taken = [&](const std::string& name) {
      return std::any_of(robot_.links.begin(), robot_.links.end(), [&](const Link& l) { return l.name == name; });
    };
    if (e.has("name") && taken(link.name)) e.fail("a second body '" + link.name + "'");
    for (int k = 2; taken(link.name); ++k) link.name = (parent == 0 ? robot_.name : robot_.links[parent].name + "_part") + "_" + std::to_string(k);
    link.weighed = compiler_.inertia == Compiler::Inertia::shapes;
    const std::vector<Inside> all = inside(e, Pose{}, around);
    const std::string name = link.name;
    const std::size_t hangs = joints(e, name, parent, i.at * compiler_.pose(e), all);
    robot_.links.push_back(std::move(link));
    robot_.joints[hangs].child = robot_.links.size() - 1;
    content(e, robot_.links.size() - 1, all);
  }

  // The joints of a body, each but the last with a link of its own, which is only a bearing. The number of the last, whose child comes next.
  std::size_t joints(const Element& body, const std::string& name, std::size_t parent, const Pose& at, const std::vector<Inside>& all) {
    std::vector<Joint> found;
    for (const Inside& i : all)
      if (i.element.name() == "joint" || i.element.name() == "freejoint") found.push_back(joint(i, name));
    for (std::size_t k = 0; found.size() > 1 && k < found.size(); ++k)
      if (found[k].type == Joint::Type::floating) throw Error(Exit::scene, found[k].where, "a body that moves freely can have no other joint");
    if (parent == 0 && goes_anywhere(found)) {
      notes_.add(found[0].where, "a body that six joints let go anywhere in the world is taken as free; --base fixed holds it");
      for (const Joint& j : found) robot_.freed.push_back(j.name);
      found.resize(1);
      found[0].type = Joint::Type::floating, found[0].limits.reset();
    }
    if (found.empty()) {
      Joint& j = found.emplace_back();
      j.name = name + "_fixed", j.where = body.where();
    }
    if (found[0].type == Joint::Type::floating && parent != 0)
      throw Error(Exit::scene, found[0].where, "only a body of the world can move freely; this one is in another");
    found[0].origin = at, found[0].parent = parent;
    for (std::size_t k = 0; k < found.size(); ++k) {
      unique(found[k]);
      robot_.joints.push_back(found[k]);
      if (k + 1 == found.size()) break;
      notes_.add(body.where(), "a body with several joints: bearings of 1 g lie between them");
      Link bearing;
      bearing.name = name + "_" + found[k].name, bearing.where = found[k].where, bearing.bearing = true;
      bearing.inertial = Inertial{kBearingMass, found[k].at, kBearingInertia * Mat3::Identity(), found[k].where};
      robot_.links.push_back(std::move(bearing));
      robot_.joints.back().child = found[k + 1].parent = robot_.links.size() - 1;
    }
    return robot_.joints.size() - 1;
  }

  Joint joint(const Inside& i, const std::string& body) {
    Joint j;
    const bool free = i.element.name() == "freejoint";
    i.element.expect(free ? std::vector<std::string>{"name", "group", "align"} : words::joint, {},
                     free ? std::vector<std::string>{} : words::dropped_joint, notes_);
    const Element e = free ? i.element : defaults_.complete(i.element, i.around);
    const std::string type = free ? "free" : e.text("type", "hinge");
    if (type != "hinge" && type != "slide" && type != "ball" && type != "free")
      e.fail(with_hint("a <joint> of type '" + type + "'", type, {"hinge", "slide", "ball", "free"}));
    j.type = type == "hinge"   ? Joint::Type::revolute
             : type == "slide" ? Joint::Type::prismatic
             : type == "ball"  ? Joint::Type::spherical
                               : Joint::Type::floating;
    j.name = e.has_own("name") ? e.text("name") : body + "_joint", j.where = e.where();
    if (free) return j;
    j.at = i.at(e.vector("pos", Vec3::Zero()));
    j.axis = i.at.R * e.vector("axis", Vec3::UnitZ());
    if (!(j.axis.norm() > 0)) e.fail("the axis of joint '" + j.name + "' is zero");
    j.axis.normalize();
    const double unit = j.type == Joint::Type::revolute ? compiler_.angle : 1;
    if (j.moves()) j.zero = unit * e.number("ref", 0.0);
    if (e.has("range") && limited(e)) {
      const std::vector<double> r = e.numbers("range", 2);
      if (r[0] > r[1]) e.fail("joint '" + j.name + "': the first number of 'range' is above the second");
      if (j.moves())
        j.limits = {unit * r[0], unit * r[1]};
      else
        notes_.add(e.where(), "a ball joint has no limits here");
    }
    j.damping = std::max(0.0, e.number("damping", 0.0)), j.friction = std::max(0.0, e.number("frictionloss", 0.0));
    j.stiffness = std::max(0.0, e.has("stiffness") ? e.numbers("stiffness").at(0) : 0.0), j.rest = unit * e.number("springref", 0.0);
    j.armature = std::max(0.0, e.number("armature", 0.0));
    for (const char* what : {"damping", "frictionloss", "stiffness", "armature"})
      if (!j.moves() && e.has(what) && e.numbers(what).at(0) != 0)
        notes_.add(e.where(), std::string("attribute '") + what + "' of a joint of type '" + type + "' is not imported");
    if (e.has("actuatorfrcrange")) j.effort = std::max(0.0, e.numbers("actuatorfrcrange", 2)[1]);
    return j;
  }

  bool limited(const Element& e) {
    const std::string said = e.text("limited", "auto");
    if (said != "true" && said != "false" && said != "auto") e.fail("attribute 'limited' of <joint> is '" + said + "'; must be true, false or auto");
    const std::vector<double> r = e.numbers("range");
    return said == "true" || (said == "auto" && compiler_.auto_limits && std::any_of(r.begin(), r.end(), [](double x) { return x != 0; }));
  }

  // Three slides and three hinges, or three slides and a ball, whose axes are independent.
  static bool goes_anywhere(const std::vector<Joint>& joints) {
    Mat3 slides = Mat3::Zero(), hinges = Mat3::Zero();
    int n = 0, m = 0, balls = 0;
    for (const Joint& j : joints) {
      if (j.type == Joint::Type::prismatic && n < 3) slides.col(n) = j.axis;
      if (j.type == Joint::Type::revolute && m < 3) hinges.col(m) = j.axis;
      n += j.type == Joint::Type::prismatic, m += j.type == Joint::Type::revolute, balls += j.type == Joint::Type::spherical;
    }
    constexpr double kIndependent = 1e-3;
    return n == 3 && std::abs(slides.determinant()) > kIndependent &&
           ((balls == 1 && m == 0) || (m == 3 && balls == 0 && std::abs(hinges.determinant()) > kIndependent));
  }

  // Files may leave names out, and one name is enough for each.
  void unique(Joint& j) {
    const std::string base = j.name;
    const auto taken = [&] { return std::any_of(robot_.joints.begin(), robot_.joints.end(), [&](const Joint& o) { return o.name == j.name; }); };
    for (int k = 2; taken(); ++k) j.name = base + "_" + std::to_string(k);
  }

  Element root_;
  Notes& notes_;
  Compiler compiler_;
  Defaults defaults_;
  Assets assets_;
  Robot robot_;
};

}  // namespace

Robot read(Document& document, Notes& notes) {
  expand_includes(document);
  return Reader(document.root(), notes).robot();
}

}  // namespace mortise::importers::mjcf
