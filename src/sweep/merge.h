#pragma once
#include <string>
#include <vector>

#include "sweep/run_rows.h"

namespace mortise::sweep {

struct Merged {
  std::vector<Status> rows;
  std::string table;                 // path of the CSV file
  std::vector<std::string> unknown;  // of the sweep's quantities those that rows which have ended do not have, each with what it may have meant
  std::vector<std::size_t> with(Status::Is is) const;
};

// Gathers what the rows left: FOLDER/table.csv (one line per row: values, status, grade, cost, and the sweep's quantities in the last frame) and
// FOLDER/fields.h5, whose groups /0007 are links to the rows' field files. Throws Error(Exit::file).
Merged merge(const std::string& folder);

}  // namespace mortise::sweep
