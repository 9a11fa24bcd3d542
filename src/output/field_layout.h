#pragma once
// What the parts of FieldFile share about the layout of the file (schemas/fields.md).
#include <hdf5.h>

#include <string>

#include "base/error.h"

namespace mortise::output {

// VTKHDF lets constant arrays keep their one copy at offset 0 in every frame; this is the only field of that kind.
inline constexpr const char* body_field = "body_id";
inline constexpr hsize_t index_chunk = 512;  // rows of the arrays with one number per frame

// Arrays of VTKHDF/Steps in the order of FieldFile::step_index_; the offsets of the constant fields follow.
enum StepIndex { values, number_of_parts, part_offsets, point_offsets, cell_offsets, connectivity_offsets };
inline constexpr const char* step_index_names[] = {"Values", "NumberOfParts", "PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"};

[[noreturn]] inline void misuse(const std::string& what) { throw Error(Exit::internal, "field file: " + what); }

}  // namespace mortise::output
