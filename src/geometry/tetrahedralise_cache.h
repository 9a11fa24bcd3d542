#pragma once
#include <optional>
#include <string>

#include "geometry/tetrahedralise.h"

namespace mortise::geometry {

// One file per result. Its name and its first bytes are the hash of the surface, the options and the version of the mesher;
// it ends with a hash of all before, so a file that was cut or altered is never used.
class TetCache {
 public:
  TetCache(const TriMesh& surface, const TetrahedraliseOptions& options);

  std::optional<TetMesh> load() const;               // nothing if there is no sound file
  void store(const TetMesh& mesh) const;             // written aside, then renamed; failure is not an error
  const std::string& file() const { return file_; }  // empty: no cache

 private:
  std::string key_, file_;
};

}  // namespace mortise::geometry
