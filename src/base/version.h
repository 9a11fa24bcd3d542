#pragma once

namespace mortise {

const char* version();   // "0.1.0"
const char* git_sha1();  // of the sources at build time, "-dirty" behind it where files differ; empty outside a git checkout
const char* build_type();

}  // namespace mortise
