#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "output/h5.h"
#include "output/mesh.h"
#include "output/step_row.h"

namespace mortise::output {

// Values of one field in one frame.
struct FieldValues {
  int components = 0;  // 0: there is no such field
  std::string unit;
  std::vector<double> values;  // row-major, `components` per point, cell or row
};

// Reads a field file, finished or still growing (then as of the last finished frame). Throws Error(Exit::file).
class FieldReader {
 public:
  explicit FieldReader(const std::string& path);

  std::int64_t frames() const { return static_cast<std::int64_t>(times_.size()); }
  double time(std::int64_t frame) const { return times_.at(frame); }
  const std::vector<double>& times() const { return times_; }
  const OutputMesh& mesh() const { return mesh_; }  // points at rest
  std::vector<Vec3> points(std::int64_t frame) const;

  // Fields by name; components == 0 where the file has none of that name. NaN in frames that did not report it.
  FieldValues point_field(const std::string& name, std::int64_t frame) const;
  FieldValues cell_field(const std::string& name, std::int64_t frame) const;
  FieldValues rows(const std::string& group, const std::string& name, std::int64_t frame) const;
  FieldValues scalar(const std::string& group, const std::string& name, std::int64_t frame) const;
  std::vector<std::string> point_fields() const;
  std::vector<std::string> cell_fields() const;
  std::vector<std::string> scalars() const;  // as "group/name", sorted
  std::vector<StepRow> steps() const;

  const std::string& scene_text() const { return scene_text_; }

 private:
  void check_frame(std::int64_t frame) const;
  FieldValues field(const std::string& folder, const std::string& name, std::int64_t frame, hsize_t count) const;
  std::vector<std::string> names(const std::string& folder) const;

  h5::File file_;
  OutputMesh mesh_;
  std::vector<double> times_;
  std::string scene_text_;
};

}  // namespace mortise::output
