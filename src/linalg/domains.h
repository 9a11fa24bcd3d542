#pragma once
// How the rows of a matrix are gathered into domains, and domains into ever coarser levels, for the multilevel Schwarz
// preconditioner (schwarz.h). Host work, done once for a numbering of rows.
//
// The items of level 0 are the rows. On every level the items of an environment are split in two along the longest side of
// their bounding box, and again, until each part fits into a domain of kSlots blocks (a k-d tree; Morton order would do, but
// tears domains apart where the curve jumps). The items of one body in a domain form one item of the next level, its rigid motion: two
// blocks, translation and rotation. An environment ends on the level where it has a single domain.
#include <vector>

#include "base/types.h"

namespace mortise::linalg {

inline constexpr Index kSlots = 16;  // blocks of a domain

// What the rows are.
struct RowPlaces {
  std::vector<Vec3> place;    // where a row's degree of freedom sits at rest [m]; the axes of an affine body at its centre
  std::vector<Index> body;    // rows of different bodies share a coarse item only where that is needed to get coarser
  std::vector<double> moves;  // what a translation adds: 1 for nodes and positions of affine bodies, 0 for axes
};

struct DomainLevel {
  std::vector<Index> slot;          // of every item: domain * kSlots + place in it; domains are counted through all levels
  std::vector<Index> parent;        // the item of the next level it belongs to, or -1 where the environment ends
  std::vector<Index> member_start;  // of every item of the next level, and the end: its items in `member`
  std::vector<Index> member;
  Index items() const { return static_cast<Index>(slot.size()); }
};

struct Domains {
  std::vector<DomainLevel> levels;
  std::vector<Index> blocks;  // of every domain, at most kSlots
  Index fine = 0;             // domains of level 0; they come first
};

Domains make_domains(const RowPlaces& rows, const std::vector<Index>& env_rows);

}  // namespace mortise::linalg
