#pragma once
// The order of a body's elements beside the size of its mesh: both leave the same error, which the sum of two knobs would count twice.
#include "study/study.h"

namespace mortise::study {

// The same study with such orders as methods, the highest first: every ladder is climbed with each of them, and references are those of the first.
Study orders_apart(Study study);

}  // namespace mortise::study
