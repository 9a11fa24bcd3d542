#include "base/version.h"

#include "commit.h"

namespace mortise {

const char* version() { return MORTISE_VERSION; }
const char* git_sha1() { return MORTISE_COMMIT; }
const char* build_type() { return MORTISE_BUILD_TYPE; }

}  // namespace mortise
