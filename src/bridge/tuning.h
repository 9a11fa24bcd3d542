#pragma once
#include <cstddef>

namespace mortise::bridge {

inline constexpr std::size_t kLongestLine = 1 << 20;  // [bytes] of a message: commands of ten thousand drives; a stream without line feeds ends here
inline constexpr double kTimeout = 60;                // [s] for an answer where --bridge-timeout says nothing: a policy may load itself first
inline constexpr int kSlice = 100;                    // [ms] after which a wait looks whether the run was asked to stop
inline constexpr double kFarewell = 2;                // [s] that a partner has to end by itself once it was told that all is over
inline constexpr int kExcerpt = 60;                   // characters of a message that cannot be read, in the error

}  // namespace mortise::bridge
