#pragma once
#include <hdf5.h>

#include <string>

#include "output/paged_file.h"

namespace mortise::output::h5 {

// What lies between HDF5 and a PagedFile. HDF5 1.10 changes metadata in place and crashes when a write fails under its chunk writer;
// behind this driver a file changes only by PagedFile::commit(), and a failed write is told to us instead of to HDF5.
struct Backing {
  Backing(const std::string& path, PagedFile::Access access) : file(path, access) {}
  PagedFile file;
  std::string failure;  // message of the first read or write that failed
};

// Makes `access` (a file access property list) use `backing`, which has to outlive the HDF5 file.
herr_t use_backing(hid_t access, Backing& backing);

}  // namespace mortise::output::h5
