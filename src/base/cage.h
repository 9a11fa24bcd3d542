#pragma once

namespace mortise {

// From here on this process may compute, read files, write to `file` and end; it can start no program, open nothing for writing, reach no
// network and signal nobody else (seccomp). For code that reads what may be made to break it. A kernel without seccomp: no cage.
void lock_into_cage(int file);

}  // namespace mortise
