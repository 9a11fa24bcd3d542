#pragma once
// Taxels on the surface of a body. A grid of cells lies in the plane x, y of a frame; the part of the surface at rest above and below
// a cell that faces the frame's z is its taxel, a piece of material that moves with the body. Every triangle is cut along the lines of
// the grid, so the pieces of a triangle add up to it and nothing is counted twice.
//
// A force f_a [N] on a node acts as the traction f_a N_a / int N_a dA, N_a the linear shape functions of the surface. A taxel gets the
// integral of the traction over its piece,
//     F_i = sum_a S_ia f_a,      S_ia = int_i N_a dA / int N_a dA,
// so the taxels share out the force within the grid without loss, and a uniform pressure, f_a = p int N_a dA, gives F_i = p A_i
// whatever the mesh and wherever the grid's lines lie. Quadratic surfaces first hand half of each midside's force to the two corners of
// its edge, which keeps force and moment and turns the consistent load (0, A/3) of a uniform pressure into the linear one.
#include <limits>
#include <numeric>
#include <vector>

#include "geometry/rigid_motion.h"
#include "model/input.h"

namespace mortise::sensors {

using geometry::Frame;

struct GridSpec {
  int rows = 1, columns = 1;                               // along y, along x
  double width = 0, height = 0;                            // along x, along y [m]
  double depth = std::numeric_limits<double>::infinity();  // surface farther than this from the plane does not count [m]
  Frame frame;                                             // at rest; origin in the middle of the grid
  int taxels() const { return rows * columns; }
};

// An entry of the scene's `sensors`.
GridSpec grid_of(const Params& sensor);

class TaxelGrid {
 public:
  TaxelGrid(const model::BodyInput& body, const GridSpec& spec);

  // Taxel = row * columns + column; row 0 at the least y, column 0 at the least x. All arguments are of the body's nodes.
  std::vector<Vec3> distribute(const std::vector<Vec3>& node_force) const;  // [N] per taxel
  std::vector<Vec3> mean(const std::vector<Vec3>& node_value) const;        // over the taxel's area at rest; zero where it has none
  std::vector<double> area(const std::vector<Vec3>& node) const;            // [m^2], of the surface as it is now
  const std::vector<double>& rest_area() const { return rest_area_; }
  double whole_area() const { return std::accumulate(rest_area_.begin(), rest_area_.end(), 0.0); }  // of all taxels at rest [m^2]
  std::size_t bytes() const;

 private:
  struct Piece {  // of a triangle within a cell
    Index taxel, triangle;
    double part;  // of the triangle's area
  };
  struct Weight {
    Index taxel, node;
    double value;
  };
  void cut(const GridSpec& spec, Index triangle, const Vec3 corner[3], double area, std::vector<Weight>& integral);

  Index taxels_;
  std::vector<Triangle> triangles_;  // that face the grid, of corners
  std::vector<Piece> pieces_;
  std::vector<double> rest_area_;
  std::vector<Weight> fraction_, mean_;  // by taxel, then node
};

// Cuts the triangles of a stiff body under the grid, its surface as it stands in the scene, until they are small against taxels: a force on a node is
// spread over its triangles, and those of a stiff body may be as large as one likes. Its shape stays.
void refine(model::BodyInput& stiff, const GridSpec& spec);

// Does the grid lie on a surface of the body that faces the other way, so that it feels one that lies behind?
bool turned_around(const model::BodyInput& body, GridSpec spec);

}  // namespace mortise::sensors
