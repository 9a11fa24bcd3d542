// The only symbol the CUDA module shows.
#include "engine/build.h"

extern "C" __attribute__((visibility("default"))) const mortise::engine::Api* mortise_engine_api() { return &mortise::engine::build_api(); }
