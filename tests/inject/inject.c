// Preloaded into the program: lets one of the calls that change files below a folder go wrong.
//   INJECT_UNDER=/abs/folder   which files; a folder
//   INJECT_AT=N                the N-th such call; 0: none
//   INJECT=kill                SIGKILL before it
//          half                SIGKILL when half of it is written (calls that do not write: when it is done)
//          short               it writes half and says so, as a write may
//          ENOSPC, EIO         it fails
//          full                it and all that follow fail with ENOSPC
//   INJECT_COUNT=FILE          the number of calls, written at the end
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

static long count, at;
static const char *under = "", *what = "";
static pid_t self;

__attribute__((constructor)) static void start(void) {
  if (getenv("INJECT_AT")) at = atol(getenv("INJECT_AT"));
  if (getenv("INJECT_UNDER")) under = getenv("INJECT_UNDER");
  if (getenv("INJECT")) what = getenv("INJECT");
  self = getpid();
}

__attribute__((destructor)) static void end(void) {
  const char* file = getenv("INJECT_COUNT");
  FILE* out = file && getpid() == self ? fopen(file, "w") : NULL;
  if (out) fprintf(out, "%ld\n", count), fclose(out);
}

enum { PASS, KILL, HALF, SHORT, FAIL };

static int next(const char* path) {
  const size_t n = strlen(under);
  if (n == 0 || getpid() != self || strncmp(path, under, n) != 0 || (path[n] != '/' && path[n] != 0)) return PASS;
  ++count;
  if (at == 0 || count < at) return PASS;
  if (!strcmp(what, "full")) return errno = ENOSPC, FAIL;
  if (count > at) return PASS;
  if (!strcmp(what, "kill")) return KILL;
  if (!strcmp(what, "half")) return HALF;
  if (!strcmp(what, "short")) return SHORT;
  return errno = !strcmp(what, "EIO") ? EIO : ENOSPC, FAIL;
}

static int next_of(int fd) {
  char link[64], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t n = readlink(link, path, sizeof path - 1);
  if (n < 0) return PASS;
  path[n] = 0;
  return next(path);
}

static int next_at(int folder, const char* path) {
  char full[8192];
  if (*path == '/') return next(path);
  if (folder == AT_FDCWD) {
    if (!getcwd(full, 4096)) return PASS;
    strcat(full, "/");
    strncat(full, path, 4000);
    return next(full);
  }
  return PASS;
}

_Noreturn static void die(void) {
  kill(getpid(), SIGKILL);
  for (;;) pause();
}

#define REAL(type, name, ...) ((type)dlsym(RTLD_NEXT, name))(__VA_ARGS__)

// `now`: the whole call; `part`: with half of the bytes.
#define CHANGE(decision, now, part) \
  switch (decision) {               \
    case KILL:                      \
      die();                        \
    case HALF:                      \
      part;                         \
      die();                        \
    case SHORT:                     \
      return part;                  \
    case FAIL:                      \
      return -1;                    \
    default:                        \
      return now;                   \
  }

typedef ssize_t (*write_t)(int, const void*, size_t);
typedef ssize_t (*pwrite_t)(int, const void*, size_t, off_t);
ssize_t write(int fd, const void* b,
              size_t n){CHANGE(next_of(fd), REAL(write_t, "write", fd, b, n), REAL(write_t, "write", fd, b, (n + 1) / 2))} ssize_t
    pwrite(int fd, const void* b, size_t n,
           off_t o){CHANGE(next_of(fd), REAL(pwrite_t, "pwrite", fd, b, n, o), REAL(pwrite_t, "pwrite", fd, b, (n + 1) / 2, o))} ssize_t
    pwrite64(int fd, const void* b, size_t n, off_t o) {
  CHANGE(next_of(fd), REAL(pwrite_t, "pwrite64", fd, b, n, o), REAL(pwrite_t, "pwrite64", fd, b, (n + 1) / 2, o))
}

typedef int (*fd_t)(int);
int fsync(int fd) { CHANGE(next_of(fd), REAL(fd_t, "fsync", fd), REAL(fd_t, "fsync", fd)) }
int fdatasync(int fd) { CHANGE(next_of(fd), REAL(fd_t, "fdatasync", fd), REAL(fd_t, "fdatasync", fd)) }
typedef int (*truncate_t)(int, off_t);
int ftruncate(int fd, off_t n) { CHANGE(next_of(fd), REAL(truncate_t, "ftruncate", fd, n), REAL(truncate_t, "ftruncate", fd, n)) }
int ftruncate64(int fd, off_t n) { CHANGE(next_of(fd), REAL(truncate_t, "ftruncate64", fd, n), REAL(truncate_t, "ftruncate64", fd, n)) }
typedef int (*rename_t)(const char*, const char*);
int rename(const char* a, const char* b) { CHANGE(next_at(AT_FDCWD, b), REAL(rename_t, "rename", a, b), REAL(rename_t, "rename", a, b)) }
typedef int (*unlink_t)(const char*);
// Removing what is not there changes nothing.
int unlink(const char* a) { CHANGE(access(a, F_OK) == 0 ? next_at(AT_FDCWD, a) : PASS, REAL(unlink_t, "unlink", a), REAL(unlink_t, "unlink", a)) }

// Opening for writing.
typedef int (*open_t)(const char*, int, ...);
#define OPEN(name)                                                                                                   \
  int name(const char* path, int flags, ...) {                                                                       \
    va_list more;                                                                                                    \
    va_start(more, flags);                                                                                           \
    const mode_t mode = (flags & O_CREAT) ? va_arg(more, mode_t) : 0;                                                \
    va_end(more);                                                                                                    \
    CHANGE((flags & O_ACCMODE) != O_RDONLY ? next_at(AT_FDCWD, path) : PASS, REAL(open_t, #name, path, flags, mode), \
           REAL(open_t, #name, path, flags, mode))                                                                   \
  }
OPEN(open)
OPEN(open64)
