#pragma once
// Test problems: random stencils with their dense sum, and a linear elastic cube.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>
#include <type_traits>
#include <vector>

#include "linalg/assembly.h"

namespace mortise::linalg::test {

using Dense = Eigen::MatrixXd;
using DenseVector = Eigen::VectorXd;

inline Dense dense(const BlockMatrix& A) {
  const auto row = A.row.download(), col = A.col.download();
  const auto value = A.value.download();
  Dense out = Dense::Zero(3 * A.rows, 3 * A.rows);
  for (std::size_t k = 0; k < value.size(); ++k) {
    out.block<3, 3>(3 * row[k], 3 * col[k]) = value[k];
    if (row[k] != col[k]) out.block<3, 3>(3 * col[k], 3 * row[k]) = value[k].transpose();
  }
  return out;
}

inline DenseVector dense(const std::vector<Vec3>& v) {
  return Eigen::Map<const DenseVector>(v.empty() ? nullptr : v[0].data(), 3 * static_cast<Index>(v.size()));
}

inline std::vector<Vec3> random_vector(Index n, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Vec3> v(n);
  for (Vec3& x : v) x = Vec3(u(rng), u(rng), u(rng));
  return v;
}

template <class T>
void write(device::View<T> to, const std::vector<T>& from) {
  ASSERT_EQ(to.n, static_cast<Index>(from.size()));
  if (to.n) device::copy_in(to.p, from.data(), from.size() * sizeof(T));
}
template <class T>
std::vector<std::remove_const_t<T>> read(device::View<T> from) {
  std::vector<std::remove_const_t<T>> out(from.n);
  if (from.n) device::copy_out(out.data(), from.p, out.size() * sizeof(T));
  return out;
}

// Writes block ids to every stencil of a set and random values to all pieces.
inline void fill_random(StencilSet& set, Index blocks, bool unused_slots, std::mt19937& rng) {
  std::uniform_real_distribution<double> u(-1, 1);
  const StencilView s = set.view();
  std::vector<Index> block(s.block.n);
  for (Index& b : block) b = unused_slots && rng() % 5 == 0 ? -1 : static_cast<Index>(rng() % blocks);
  std::vector<Vec3> grad(s.grad.n);
  for (Vec3& g : grad) g = Vec3(u(rng), u(rng), u(rng));
  std::vector<Mat3> hess(s.hess.n);
  for (Mat3& h : hess)
    for (int i = 0; i < 9; ++i) h.data()[i] = u(rng);
  // The pieces H(a,a) are symmetric, as those of any Hessian.
  const auto offset = read(s.offset), hess_offset = read(s.hess_offset);
  for (Index i = 0; i < s.n; ++i) {
    const Index nb = offset[i + 1] - offset[i];
    for (Index a = 0; a < nb; ++a) {
      Mat3& h = hess[hess_offset[i] + pair_place(a, a, nb)];
      h = (h + h.transpose()).eval();
    }
  }
  write(s.block, block), write(s.grad, grad), write(s.hess, hess);
  set.pattern_changed();
}

// Sum over the stencils of S^T [grad, H] S, S picking the rows of the stencil's blocks; the definition of assembly.
inline void add_dense(StencilSet& set, const std::vector<Index>& row_of_block, DenseVector& g, Dense& A) {
  const StencilView s = set.view();
  const auto offset = read(s.offset), hess_offset = read(s.hess_offset), block = read(s.block);
  const auto grad = read(s.grad);
  const auto hess = read(s.hess);
  for (Index i = 0; i < s.n; ++i) {
    const Index nb = offset[i + 1] - offset[i];
    Dense local(3 * nb, 3 * nb);
    Dense pick = Dense::Zero(3 * nb, A.cols());
    for (Index a = 0; a < nb; ++a) {
      const Index id = block[offset[i] + a];
      if (id >= 0) g.segment<3>(3 * id) += grad[offset[i] + a];
      if (id >= 0 && row_of_block[id] >= 0) pick.block<3, 3>(3 * a, 3 * row_of_block[id]).setIdentity();
      for (Index b = a; b < nb; ++b) {
        const Mat3 h = hess[hess_offset[i] + pair_place(a, b, nb)];
        local.block<3, 3>(3 * a, 3 * b) = h;
        local.block<3, 3>(3 * b, 3 * a) = h.transpose();
      }
    }
    A += pick.transpose() * local * pick;
  }
}

// Linear elastic unit cube of cells^3 hexahedra cut into six tetrahedra each (constant strain), E = 1e6 Pa, nu = 0.3, plus
// `ground` N/m on every node. Node ids start at `first`. H(a,b) = V (lambda g_a g_b^T + mu g_b g_a^T + mu g_a.g_b I).
struct Cube {
  StencilSet elastic, ground;
  Index nodes = 0;

  explicit Cube(Index cells, double stiffness_of_ground, Index first = 0, double youngs_modulus = 1e6) {
    const double nu = 0.3, lambda = youngs_modulus * nu / ((1 + nu) * (1 - 2 * nu)), mu = youngs_modulus / (2 * (1 + nu));
    const Index side = cells + 1;
    nodes = side * side * side;
    const auto id = [&](Index x, Index y, Index z) { return (z * side + y) * side + x; };
    const auto at = [&](Index n) -> Vec3 { return Vec3(n % side, n / side % side, n / (side * side)) / cells; };
    static constexpr int kCorner[6][3] = {{1, 2, 4}, {1, 4, 2}, {2, 1, 4}, {2, 4, 1}, {4, 1, 2}, {4, 2, 1}};
    std::vector<Index> block;
    std::vector<Mat3> hess;
    for (Index z = 0; z < cells; ++z)
      for (Index y = 0; y < cells; ++y)
        for (Index x = 0; x < cells; ++x)
          for (const auto& path : kCorner) {
            Index v[4];
            for (int k = 0, bits = 0; k < 4; ++k) {
              v[k] = id(x + (bits & 1), y + (bits >> 1 & 1), z + (bits >> 2));
              if (k < 3) bits |= path[k];
            }
            Mat3 edges;
            for (int k = 0; k < 3; ++k) edges.col(k) = at(v[k + 1]) - at(v[0]);
            const Mat3 inverse = edges.inverse();
            const double volume = std::abs(edges.determinant()) / 6;
            Vec3 g[4];
            g[0] = -inverse.colwise().sum().transpose();
            for (int k = 0; k < 3; ++k) g[k + 1] = inverse.row(k).transpose();
            for (int a = 0; a < 4; ++a) {
              block.push_back(first + v[a]);
              for (int b = a; b < 4; ++b)
                hess.push_back(volume * (lambda * g[a] * g[b].transpose() + mu * g[b] * g[a].transpose() + mu * g[a].dot(g[b]) * Mat3::Identity()));
            }
          }
    elastic.resize_uniform(static_cast<Index>(block.size() / 4), 4);
    elastic.need_hessian();
    write(elastic.view().block, block), write(elastic.view().hess, hess);
    elastic.pattern_changed();
    ground.resize_uniform(nodes, 1);
    ground.need_hessian();
    std::vector<Index> each(nodes);
    for (Index n = 0; n < nodes; ++n) each[n] = first + n;
    write(ground.view().block, each);
    write(ground.view().hess, std::vector<Mat3>(nodes, stiffness_of_ground * Mat3::Identity()));
    ground.pattern_changed();
  }
};

inline Buffer<Index> all_rows(Index n) {
  std::vector<Index> rows(n);
  for (Index i = 0; i < n; ++i) rows[i] = i;
  return Buffer<Index>(rows);
}

// The cube's stiffness matrix, all nodes free.
inline void cube_matrix(Cube& cube, BlockMatrix& A) {
  Assembler assembler;
  assembler.set_rows(all_rows(cube.nodes), cube.nodes);
  StencilSet* sets[] = {&cube.elastic, &cube.ground};
  assembler.matrix(sets, A);
}

}  // namespace mortise::linalg::test
