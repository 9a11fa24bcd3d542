#pragma once
// The parts of the judgement. x: the points of a frame.
#include "judge/case.h"

namespace judge {

// Triangles of surfaces that are to be kept apart and touch or cross, all bodies together, by CGAL's exact predicates; vertices on or below a
// half-space.
void judge_surfaces(const Case& c, const std::vector<Vector>& x, long frame, Verdict& v);

// Volume of every tetrahedron of corners over its volume at rest.
void judge_elements(const Case& c, const std::vector<Vector>& x, long frame, Verdict& v);

// Kinetic energy and momentum of a body from the saved velocities.
void motion(const Body& body, const std::vector<Vector>& rest, const std::vector<Vector>& velocity, double& kinetic, Vector& momentum);

// Stored energies of one state against what the run reported; a share of the largest of the run so far.
class StoredEnergies {
 public:
  StoredEnergies(const File& file, const Case& c);
  void judge(const std::vector<Vector>& x, long frame, Verdict& v);

 private:
  const Case& c_;
  std::vector<double> elastic_, gravity_;
  std::vector<std::vector<long>> groups_;  // of tetrahedra, per body
  double largest_ = 0, rounding_ = 0, offset_ = 0;
};

// Newton's second law of every body: contact, friction, weight and support add up to the change of momentum, from the saved fields alone.
void judge_forces(const File& file, const Case& c, Verdict& v);

// What differs between two field files, bit for bit; "" if nothing.
std::string difference(const File& a, const File& b);

std::vector<Vector> frame_of(const std::vector<double>& all, long frame, std::size_t n);

}  // namespace judge
