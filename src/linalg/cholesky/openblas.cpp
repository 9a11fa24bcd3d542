#include "linalg/cholesky/openblas.h"

#include <algorithm>
#include <cstdlib>
#include <string>

extern "C" {
void openblas_set_num_threads(int);
int openblas_get_num_threads(void);
char* openblas_get_corename(void);
// Only of builds that choose among kernels when they start, as Debian's does.
[[gnu::weak]] void gotoblas_dynamic_quit(void);
[[gnu::weak]] void gotoblas_dynamic_init(void);
}

namespace mortise::linalg {
namespace {

constexpr char kChoice[] = "OPENBLAS_CORETYPE";  // what OpenBLAS asks for before it looks at the processor

// OpenBLAS knows processors by their numbers, and takes kernels of 2004 (SSE3) for one that is newer than itself: 0.3.21 on Xeons of 2023, where a
// factor then takes four times as long. What the processor can do says which kernels fit; empty where it can do no more than those.
std::string fitting() {
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512cd"))
    return "SkylakeX";
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? "Haswell" : "";
}

void choose_kernels() {
  static const std::string wide[] = {"Haswell", "Zen", "SkylakeX", "Cooperlake", "SapphireRapids"};
  if (!gotoblas_dynamic_quit || !gotoblas_dynamic_init || std::getenv(kChoice) || std::ranges::count(wide, openblas_get_corename())) return;
  const std::string kernels = fitting();
  if (kernels.empty()) return;
  setenv(kChoice, kernels.c_str(), 0);  // kept: processes that this one starts take them too
  gotoblas_dynamic_quit();
  gotoblas_dynamic_init();
}

}  // namespace

void ready_openblas() {
  static const bool chosen = (choose_kernels(), true);
  (void)chosen;
  // OpenBLAS is only told what it does not know: in a copy of a process being told starts all its threads again, which wait in a loop at first.
  if (openblas_get_num_threads() != 1) openblas_set_num_threads(1);
}

}  // namespace mortise::linalg
