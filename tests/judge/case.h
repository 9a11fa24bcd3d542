#pragma once
// What is to be judged: the bodies of a field file, and what its scene asks of them.
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "judge/file.h"
#include "judge/stiff.h"
#include "judge/vector.h"

namespace judge {

struct Body {
  std::string name;
  std::vector<std::array<long, 4>> tets;
  std::vector<std::array<long, 6>> midsides;   // of quadratic tetrahedra, else empty: on edges (0,1) (1,2) (2,0) (0,3) (1,3) (2,3)
  std::vector<std::array<long, 3>> triangles;  // of the surface; a quadratic face counts as four plane quarters, as in contact
  std::vector<long> points;
  double density = 0, youngs_modulus = 0, poisson_ratio = 0;
  std::string law;
  bool mean_volume = false;  // lambda acts on averages
  bool soft = false, self_contact = false, pinned = false;
  std::optional<Spread> spread;  // its mass is spread as the scene says, not evenly
  bool stays = false;       // pins hold a part of it, for good, and never turn it: its masses are lumped on nodes, where it is of linear tetrahedra
  bool prescribed = false;  // all of it goes where the scene says, always
  std::string motion;       // of a prescribed body, "" if it stays
  bool quadratic() const { return !midsides.empty(); }
};
struct Plane {
  std::string name;
  Vector point, normal;
};

// A joint, bond or mortar tie: what its force does to which bodies.
struct Tie {
  std::string figures;                                // where its force on the first body is, up to the axis
  std::vector<std::pair<std::string, double>> share;  // by body
};

// A motor, drag and stop of a slide: forces along an axis that turns with the carrier.
struct Slide {
  std::string name, body, to;                         // "": the world
  Vector axis{};                                      // at rest
  bool given = false;                                 // its travel is: what moves it is in the joint's force
  std::vector<std::pair<std::string, double>> leads;  // figures of joints that follow it by a force, and which share of it acts on this one
};

struct Case {
  std::vector<Body> bodies;
  std::vector<Tie> ties;
  std::vector<Slide> slides;
  std::vector<Plane> planes;
  std::set<std::pair<std::string, std::string>> watched, pass;  // both orders
  std::vector<Vector> rest;
  Vector gravity{};
  bool contact = false, inertia = false, bdf2 = false, friction = false, loads = false, double_precision = false;
  double step = 0;
  double tolerance = 0;  // share of the forces on a body to which a step is solved
  long frame_every = 1, frames = 0;

  // Is the pair to be kept apart? Of two prescribed bodies always, unless they move as one; b null: a half-space.
  bool apart(const Body& a, const Body* b, const std::string& other) const;
};

void read_mesh(const File& file, Case& c);
void read_scene(const File& file, Case& c);

// What was found.
struct Verdict {
  long intersections = 0, below = 0, not_finite = 0, inverted = 0, first_frame = -1;
  double min_det_f = NAN, kinetic_error = 0, momentum_error = 0, elastic_error = 0, gravity_error = 0;
  double force_error = 0;  // sum of the forces on a body over what it may be
  long forces = 0;         // bodies of which the forces of a frame could be added up
  std::string what;        // the first thing found
  void found(long frame, const std::string& text) {
    if (first_frame < 0) first_frame = frame, what = text;
  }
};

}  // namespace judge
