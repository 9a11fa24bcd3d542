#pragma once
// Columns of numbers from anybody's HDF5 file: a dataset of one dimension, demo_0/hip, or a column of one of two, by its number from 0, actions[3],
// or by its name in the dataset's attribute `columns`, actions[hip]. Units are attributes `unit` or `units`, one text, or one for every column.
#include <string>

#include "base/column.h"

namespace mortise::output {

// Throws Error(Exit::file) where the file is none that can be read, Error(Exit::scene) where it has no such column, or that has what is no number.
Column read_column(const std::string& path, const std::string& name);

}  // namespace mortise::output
