#pragma once
// Clusters of linear tetrahedra over which a change of volume is averaged: stars of vertices, that is all tetrahedra around one.
#include <vector>

#include "model/input.h"

namespace mortise::model {

// The cluster of every tetrahedron, from 0. A vertex whose whole star is free makes one, those inside the body first, in the
// order of their numbers: in mirrored boxes (geometry/primitives.h) blocks of eight cells. What is left joins its smallest
// neighbour across a face.
std::vector<Index> star_clusters(const BodyInput& body);

// Clusters of several bodies, numbered by block ids; on the host (Clusters in model/model.h).
struct ClusterLists {
  std::vector<Index> of_tet, first_tet{0}, tet, slot, first_node{0}, node, owner, env;
  std::vector<double> lambda, volume;
  // Appends the clusters of linear tetrahedra [first, end) of one body; `volumes` are theirs [m^3].
  void add(const std::vector<Index>& cluster, const std::vector<Tet>& tets, Index first, const double* volumes, double lame_lambda, Index env);
};

}  // namespace mortise::model
