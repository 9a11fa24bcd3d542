#pragma once
#include "engine/api.h"

namespace mortise::engine {

const Api& build_api();  // of the build this is compiled into

}  // namespace mortise::engine
