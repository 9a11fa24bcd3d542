#include "cli/terminal.h"

#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <regex>

#include "base/printable.h"

namespace mortise::cli {
namespace {

Colour choice = Colour::automatic;

bool coloured() {
  if (choice != Colour::automatic) return choice == Colour::always;
  const char* none = std::getenv("NO_COLOR");  // no-color.org: set and not empty
  const char* term = std::getenv("TERM");
  return isatty(STDERR_FILENO) && !(none && *none) && !(term && std::strcmp(term, "dumb") == 0);
}

void write_stderr(std::string text) {
  text = printable(text, true);
  if (coloured()) {
    // Lines of the scene are quoted behind "|"; only the words before a message are coloured.
    text = std::regex_replace(text, std::regex("(^|\n)([^|\n]*?)error:"), "$1$2\033[1;31merror:\033[0m");
    text = std::regex_replace(text, std::regex("(^|\n)([^|\n]*?)note:"), "$1$2\033[1;36mnote:\033[0m");
    text = std::regex_replace(text, std::regex("(\n *\\| *)(\\^~*)"), "$1\033[1;32m$2\033[0m");
  }
  std::cerr << text << std::endl;
}

}  // namespace

void set_colour(Colour c) { choice = c; }

void print_error(const Error& e) { e.located() ? write_stderr(e.what()) : print_error(std::string(e.what())); }
void print_error(const std::string& message) { write_stderr("error: " + message); }

void print_wait(const std::string& what) {
  if (isatty(STDERR_FILENO)) std::cerr << printable(what, true) << " ..." << std::endl;
}

void end_on_broken_pipe() { std::signal(SIGPIPE, SIG_DFL); }

void finish_output() {
  std::cout.flush();
  if (!std::cout) throw Error(Exit::file, "cannot write to the standard output");
}

}  // namespace mortise::cli
