#pragma once
// Trajectories that lie in files: columns of numbers with their units, from text (base/csv.h) or HDF5. What a scene names of an HDF5 file, and every
// track of poses, becomes keys of the resolved scene, so that a result can be read without the file; drives read text themselves.
#include <functional>
#include <string>
#include <vector>

#include "base/column.h"
#include "base/params.h"
#include "scene/diagnostics.h"

namespace mortise::scene {

// Reads a column of an HDF5 file by what the scene calls it. This folder knows no HDF5: the program says once, at its start, who reads it. Throws
// Error(Exit::file) where the file cannot be read, Error(Exit::scene) where it has no such column.
using ColumnReader = std::function<Column(const std::string& path, const std::string& name)>;
void set_column_reader(ColumnReader reader);

bool is_hdf5(const std::string& path);  // by its ending: .h5, .hdf5

// Puts keys in the place of the files of drives and of motions of pins. Errors go to `errors`.
void expand_trajectories(Params& root, Diagnostics& errors);

}  // namespace mortise::scene
