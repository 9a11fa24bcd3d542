#pragma once
// Many runs of one scene: a table of parameters, one row per run, one folder per row. Rows know nothing of each other, so any of them may run
// anywhere, in any order and again; a cluster's scheduler is the engine that shares them out (tools/slurm).
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"

namespace mortise::sweep {

struct Row {
  std::vector<std::pair<std::string, std::string>> values;  // path and value of --set
  std::vector<std::string> overrides(const std::vector<std::string>& of_all) const;
};

struct Sweep {
  std::string name;
  std::string scene;                    // path
  std::vector<std::string> set;         // --set of all rows
  std::vector<std::string> quantities;  // "group/name" of scalars at the end, for the merged table
  std::vector<Row> rows;
  SourceLoc quantities_at{}, rows_at{};  // where the file says them
};

// Reads the file; formats are in schemas/sweep.md. Throws SceneErrors with all that is wrong in it, Error(Exit::file).
Sweep read_sweep(const std::string& path);

// Reads the scene of every row, and makes that of the first to see whether its quantities are reported; throws the first error, with the row's
// number and values.
void check_rows(const Sweep& sweep);

// sweep.json in the folder of a sweep: what its rows are. Written by the first who comes; another sweep in the same folder is Error(Exit::usage).
void claim_folder(const Sweep& sweep, const std::string& folder);
Sweep sweep_in(const std::string& folder);  // throws Error(Exit::file) where there is none

std::string row_folder(const std::string& folder, std::size_t row);  // "folder/0007"

// "3", "0,2,5-9": as --array of sbatch takes it.
std::string ranges(const std::vector<std::size_t>& rows);

}  // namespace mortise::sweep
