#include "linalg/per_environment.h"

namespace mortise::linalg {

PerEnvironment::PerEnvironment(const std::vector<Index>& env_rows, const std::function<std::unique_ptr<Preconditioner>(Index, Index)>& make)
    : parts_(env_rows.size() - 1), whose_(env_rows.size() - 1, 1), bad_(env_rows.back()) {
  for (std::size_t e = 0; e < parts_.size(); ++e) {
    parts_[e].first = env_rows[e], parts_[e].rows = env_rows[e + 1] - env_rows[e];
    parts_[e].own = make(env_rows[e], env_rows[e + 1]);
  }
  bad_.zero();
}

void PerEnvironment::build(const BlockMatrix& A, View<const Vec3> position) {
  for (std::size_t e = 0; e < parts_.size(); ++e) {
    Part& p = parts_[e];
    if (!whose_[e] || p.rows == 0) continue;
    p.own->build(p.matrix.of(A, p.first, p.first + p.rows), {position.p + p.first, p.rows});
    p.built = true;
    device::copy(bad_.view().p + p.first, p.own->bad_rows().p, static_cast<std::size_t>(p.rows) * sizeof(Index));
  }
}

void PerEnvironment::apply(View<const Vec3> r, View<Vec3> z) const {
  for (const Part& p : parts_)
    if (p.built) p.own->apply({r.p + p.first, p.rows}, {z.p + p.first, p.rows});
}

std::vector<const void*> PerEnvironment::memory() const {
  std::vector<const void*> out;
  for (const Part& p : parts_) {
    out.push_back(p.built ? &p : nullptr);
    if (!p.built) continue;
    const std::vector<const void*> own = p.own->memory();
    out.insert(out.end(), own.begin(), own.end());
  }
  return out;
}

}  // namespace mortise::linalg
