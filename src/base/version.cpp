#include "base/version.h"

namespace mortise {

const char* version() { return MORTISE_VERSION; }
const char* git_sha1() { return MORTISE_GIT_SHA1; }
const char* build_type() { return MORTISE_BUILD_TYPE; }

}  // namespace mortise
