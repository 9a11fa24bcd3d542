#include "cli/commands.h"

int main(int argc, char** argv) { return mortise::cli::program({argv + 1, argv + argc}); }
