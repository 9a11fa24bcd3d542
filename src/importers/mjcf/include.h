#pragma once
#include "importers/element.h"

namespace mortise::importers::mjcf {

// Reads the files of all <include>, whose contents then stand in their place; names start at the folder of `document`. Throws Error(Exit::file) where
// one is not there, Error(Exit::scene) where it comes twice, as MuJoCo does.
void expand_includes(Document& document);

}  // namespace mortise::importers::mjcf
