#include "base/cage.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <vector>

namespace mortise {
namespace {

#if defined(__x86_64__)
constexpr unsigned kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr unsigned kArchitecture = AUDIT_ARCH_AARCH64;
#else
constexpr unsigned kArchitecture = 0;
#endif

// The lower half of a call's argument; all that we ask about fits into it.
constexpr unsigned argument(int i) { return offsetof(seccomp_data, args) + 8 * static_cast<unsigned>(i); }

class Filter {
 public:
  Filter() {
    load(offsetof(seccomp_data, arch));
    code_.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0));
    code_.push_back(denied());
    load(offsetof(seccomp_data, nr));
  }
  void allow(unsigned call) { when_equal(call, {allowed()}); }
  // Where argument i is one of `values`.
  void allow(unsigned call, int i, std::vector<unsigned> values) {
    std::vector<sock_filter> body{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, argument(i))};
    for (unsigned v : values) body.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, v, 0, 1)), body.push_back(allowed());
    body.push_back(denied());
    when_equal(call, body);
  }
  // Where argument i has none of `bits`.
  void allow_without(unsigned call, int i, unsigned bits) {
    when_equal(call, {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, argument(i)), BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, bits, 1, 0), allowed(), denied()});
  }
  void install() {
    code_.push_back(denied());
    sock_fprog program{static_cast<unsigned short>(code_.size()), code_.data()};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0) prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
  }

 private:
  static sock_filter allowed() { return BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW); }
  static sock_filter denied() { return BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM); }
  void load(unsigned offset) { code_.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offset)); }
  void when_equal(unsigned value, const std::vector<sock_filter>& body) {
    code_.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, static_cast<unsigned char>(body.size())));
    code_.insert(code_.end(), body.begin(), body.end());
  }
  std::vector<sock_filter> code_;
};

// Calls of the C library while it computes, allocates, asks about files and reads them.
constexpr unsigned kHarmless[] = {
    SYS_read,          SYS_pread64,      SYS_readv,        SYS_lseek,
    SYS_close,         SYS_fstat,        SYS_newfstatat,   SYS_statx,
    SYS_readlinkat,    SYS_faccessat,    SYS_getcwd,       SYS_getdents64,
    SYS_mmap,          SYS_munmap,       SYS_mremap,       SYS_mprotect,
    SYS_madvise,       SYS_brk,          SYS_futex,        SYS_getrandom,
    SYS_clock_gettime, SYS_gettimeofday, SYS_times,        SYS_getrusage,
    SYS_getpid,        SYS_gettid,       SYS_sched_yield,  SYS_sched_getaffinity,
    SYS_uname,         SYS_sysinfo,      SYS_rt_sigaction, SYS_rt_sigprocmask,
    SYS_rt_sigreturn,  SYS_exit,         SYS_exit_group,
#if defined(__x86_64__)
    SYS_stat,          SYS_lstat,        SYS_access,       SYS_readlink,
    SYS_time,
#endif
};

}  // namespace

void lock_into_cage(int file) {
  if (kArchitecture == 0) return;
  Filter filter;
  for (unsigned call : kHarmless) filter.allow(call);
  constexpr unsigned kChanging = O_ACCMODE | O_CREAT | O_TRUNC;
  filter.allow_without(SYS_openat, 2, kChanging);
#if defined(__x86_64__)
  filter.allow_without(SYS_open, 1, kChanging);
#endif
  const std::vector<unsigned> ours{static_cast<unsigned>(file), STDOUT_FILENO, STDERR_FILENO};
  filter.allow(SYS_write, 0, ours);
  filter.allow(SYS_writev, 0, ours);
  filter.allow(SYS_tgkill, 0, {static_cast<unsigned>(getpid())});
  filter.install();
}

}  // namespace mortise
