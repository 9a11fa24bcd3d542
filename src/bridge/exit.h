#pragma once
#include "base/error.h"

namespace mortise::bridge {

// A partner ended, was silent or said what cannot be taken; --resume goes on. One of the program's exit codes, like those in base/error.h.
inline constexpr Exit kPartnerFailed = static_cast<Exit>(8);

}  // namespace mortise::bridge
