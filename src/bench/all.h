#pragma once
#include "bench/benchmark.h"

namespace mortise::bench {

void barrier(const Bench&);
void patch(const Bench&);
void hertz(const Bench&);
void spheres(const Bench&);
void pin(const Bench&);
void tower(const Bench&);
void slide(const Bench&);
void interface(const Bench&);
void sharp(const Bench&);
void partition(const Bench&);
void ring(const Bench&);
void indent(const Bench&);
void line(const Bench&);
void locking(const Bench&);

}  // namespace mortise::bench
