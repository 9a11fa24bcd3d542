#include "importers/robot/robot.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "geometry/io/read.h"

namespace mortise::importers {
namespace {

std::string without_location(const Error& e) {
  const std::string text = e.what();
  const std::size_t at = text.find(": error: ");
  return at == std::string::npos ? text : text.substr(at + 9);
}

}  // namespace

Pose Joint::motion(double coordinate) const {
  const double way = coordinate - zero;
  Pose out;
  if (type == Type::prismatic) out.t = way * axis;
  if (type == Type::revolute) {
    out.R = Eigen::AngleAxisd(way, axis).toRotationMatrix();
    out.t = at - out.R * at;
  }
  return out;
}

void Joint::fix_where_it_cannot_move(Notes& notes) {
  if (!moves() || !limits || limits->first != limits->second) return;
  notes.add(where, "a joint whose limits leave no way is taken as fixed");
  origin = origin * motion(limits->first);
  type = Type::fixed, limits.reset(), mimic.reset();
}

void Robot::make_tree() {
  const std::size_t n = links.size();
  joint_of.assign(n, -1);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Joint& j = joints[i];
    std::ptrdiff_t& mine = joint_of[j.child];
    if (mine >= 0)
      throw Error(Exit::scene, j.where, "link '" + links[j.child].name + "' has a second parent; the first is joint '" + joints[mine].name + "'");
    mine = static_cast<std::ptrdiff_t>(i);
  }
  std::vector<std::size_t> roots;
  for (std::size_t i = 0; i < n; ++i)
    if (joint_of[i] < 0) roots.push_back(i);
  if (roots.size() > 1)
    throw Error(Exit::scene, links[roots[1]].where,
                "link '" + links[roots[1]].name + "' hangs on no other, and neither does '" + links[roots[0]].name + "': a robot is one tree");
  order = roots;
  for (std::size_t k = 0; k < order.size(); ++k)
    for (const Joint& j : joints)
      if (j.parent == order[k]) order.push_back(j.child);
  if (order.size() < n) {  // also where there is no root
    const auto lost = std::find_if(links.begin(), links.end(), [&](const Link& l) {
      return std::find(order.begin(), order.end(), static_cast<std::size_t>(&l - links.data())) == order.end();
    });
    throw Error(Exit::scene, lost->where, "link '" + lost->name + "' hangs on itself: the joints go in a circle");
  }
  root = roots[0];
  for (Joint& j : joints) {
    if (!j.mimic) continue;
    const auto leader = std::find_if(joints.begin(), joints.end(), [&](const Joint& o) { return o.name == j.mimic->joint; });
    if (leader == joints.end() || leader->name == j.name)
      throw Error(Exit::scene, j.where, "joint '" + j.name + "' mimics '" + j.mimic->joint + "', which is no other joint");
    j.mimic->leader = static_cast<std::size_t>(leader - joints.begin());
  }
  for (const Joint& j : joints) {
    const Joint* at = &j;
    for (std::size_t round = 0; at->mimic && round < joints.size(); ++round) at = &joints[at->mimic->leader];
    if (at->mimic) throw Error(Exit::scene, j.where, "joint '" + j.name + "' mimics '" + j.mimic->joint + "', which follows it: they go in a circle");
  }
}

void Robot::read_surface(Shape& s) {
  std::shared_ptr<const geometry::TriMesh>& mesh = surfaces_[s.file];
  try {
    if (!mesh) mesh = std::make_shared<const geometry::TriMesh>(geometry::read_surface(s.file));
  } catch (const Error& e) {
    throw Error(e.code(), s.where, "mesh '" + s.file + "' cannot be read: " + without_location(e));
  }
  s.surface = mesh;
}

}  // namespace mortise::importers
