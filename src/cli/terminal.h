#pragma once
// Results go to stdout, everything else to stderr, in colour only where a person looks at it.
#include <string>

#include "base/error.h"

namespace mortise::cli {

enum class Colour { automatic, always, never };
void set_colour(Colour);

// "error: ..." or, where the message carries its place, the message as it is; one line feed behind it.
void print_error(const Error&);
void print_error(const std::string& message);

// Where a person waits for it: one line.
void print_wait(const std::string& what);

// A reader that went away (`mortise schema | head`) ends the program quietly, by SIGPIPE: 141 in a shell.
void end_on_broken_pipe();
// Writes out what is buffered for stdout; throws Error(Exit::file) when it cannot be written (disk full).
void finish_output();

}  // namespace mortise::cli
