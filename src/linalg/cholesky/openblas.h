#pragma once
// OpenBLAS in this process: one thread, and kernels that fit the processor.

namespace mortise::linalg {

// Before its first use; again it costs nothing. For a process that will be copied: its copies then need no threads of OpenBLAS.
void ready_openblas();

}  // namespace mortise::linalg
