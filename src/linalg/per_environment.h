#pragma once
// A preconditioner of every environment by itself: what it is and when it is built anew does not depend on the neighbours.
#include <functional>
#include <memory>
#include <vector>

#include "linalg/preconditioner.h"
#include "linalg/submatrix.h"

namespace mortise::linalg {

class PerEnvironment : public Preconditioner {
 public:
  // make(first, last): for the rows of an environment, counted from its first.
  PerEnvironment(const std::vector<Index>& env_rows, const std::function<std::unique_ptr<Preconditioner>(Index, Index)>& make);

  void choose(const std::vector<std::uint8_t>& whose) override { whose_ = whose; }
  void build(const BlockMatrix& A, View<const Vec3> position) override;
  void apply(View<const Vec3> r, View<Vec3> z) const override;
  View<const Index> bad_rows() const override { return bad_.view(); }
  std::vector<const void*> memory() const override;

 private:
  struct Part {
    Index first = 0, rows = 0;
    std::unique_ptr<Preconditioner> own;
    SubMatrix matrix;
    bool built = false;
  };
  std::vector<Part> parts_;
  std::vector<std::uint8_t> whose_;
  Buffer<Index> bad_;
};

}  // namespace mortise::linalg
