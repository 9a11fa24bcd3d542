#pragma once
#include <sys/resource.h>
#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

namespace mortise {

std::string own_program();  // the path of this program

// Starts a program without a shell and without waiting for it; what it prints goes to the files `out` and `err`, which may be one. `in_child` runs
// in the new process before that. Throws Error(Exit::internal) where there can be no more processes.
pid_t start_program(const std::vector<std::string>& arguments, const std::string& out, const std::string& err,
                    const std::function<void()>& in_child = {});

int code_of(int status);  // of waitpid: exit code, or 128 + signal

double cpu_seconds(const rusage& used);  // of wait4: of a program and those that it has waited for [s]

}  // namespace mortise
