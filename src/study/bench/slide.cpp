#include "study/bench/all.h"
namespace mortise::study::bench {
void slide(const Bench&) {}
}
