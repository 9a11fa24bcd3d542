#include "report.h"

#include <cxxabi.h>
#include <pthread.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <map>

int ptx_checked = 0;
__attribute__((constructor(101))) static void choose() {
  ptx_checked = std::getenv("MORTISE_PTX_CHECK") != nullptr;
}  // before all other constructors

namespace ptx {
namespace {

struct Runs {
  long long launches = 0, threads = 0;
  Traffic traffic;
};
struct Ledger {
  std::map<std::string, long long> faults, calls;
  std::map<const Kernel*, Runs> runs;
  long long waits = 0;
  pid_t process = getpid();
  bool forked = false;
  Ledger();
  ~Ledger();
  void begin_fork();
};
Ledger& ledger() {
  static Ledger l;
  return l;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out + "\"";
}

template <class Map, class Text>
std::string object(const Map& map, Text text) {
  std::string out;
  for (const auto& [key, value] : map) out += (out.empty() ? "" : ", ") + text(key, value);
  return "{" + out + "}";
}

void write(const Ledger& l) {
  const char* name = std::getenv("MORTISE_PTX_REPORT");
  if (!name) return;
  std::FILE* f = l.forked ? std::fopen((std::string(name) + "." + std::to_string(l.process)).c_str(), "w") : std::fopen(name, "a");
  if (!f) return;
  const auto number = [](const std::string& key, long long n) { return quoted(key) + ": " + std::to_string(n); };
  const auto run = [](const Kernel* k, const Runs& r) {
    return quoted(readable(k)) + ": [" + std::to_string(r.launches) + ", " + std::to_string(r.threads) + ", " + std::to_string(r.traffic.accessed) +
           ", " + std::to_string(r.traffic.touched) + "]";
  };
  std::fprintf(f, "{\"checked\": %s, \"backwards\": %s, \"waits\": %lld, \"faults\": %s, \"calls\": %s, \"kernels\": %s}\n",
               ptx_checked ? "true" : "false", settings().backwards ? "true" : "false", l.waits, object(l.faults, number).c_str(),
               object(l.calls, number).c_str(), object(l.runs, run).c_str());
  std::fclose(f);
}

// What was forked (an environment) ends without destructors, so what it has done is written whenever it waits for the device, to a file of its own;
// what came before is the parent's to tell.
void Ledger::begin_fork() {
  forked = true, process = getpid(), waits = 0;
  faults.clear(), calls.clear();
  for (auto& [kernel, done] : runs) done = {};
}

Ledger::Ledger() {
  pthread_atfork(nullptr, nullptr, [] { ledger().begin_fork(); });
}

Ledger::~Ledger() {
  if (getpid() != process) return;
  write(*this);
  if (faults.empty()) return;
  std::fprintf(stderr, "ptx: %zu kinds of fault\n", faults.size());
  std::fflush(nullptr);
  _exit(70);
}

}  // namespace

std::string readable(const Kernel* kernel) {
  int status = 0;
  char* text = abi::__cxa_demangle(kernel->name, nullptr, nullptr, &status);
  const std::string out = status == 0 ? text : kernel->name;
  std::free(text);
  return out;
}

const Settings& settings() {
  static const auto text = [](const char* name) { return std::string(std::getenv(name) ? std::getenv(name) : ""); };
  static const Settings s{text("MORTISE_PTX_ORDER") == "backwards",
                          (text("MORTISE_PTX_MEMORY_MIB").empty() ? std::size_t{8192} : std::stoul(text("MORTISE_PTX_MEMORY_MIB"))) << 20,
                          text("MORTISE_PTX_FAIL")};
  return s;
}

void report(const std::string& fault, const std::string& details) {
  if (ledger().faults[fault]++ == 0) std::fprintf(stderr, "ptx: %s%s%s\n", fault.c_str(), details.empty() ? "" : ": ", details.c_str());
}
std::size_t faults() { return ledger().faults.size(); }
void count_call(const char* function) { ++ledger().calls[function]; }
void count_run(const Kernel* kernel, std::size_t threads, const Traffic& traffic) {
  Runs& r = ledger().runs[kernel];
  ++r.launches, r.threads += static_cast<long long>(threads);
  r.traffic.accessed += traffic.accessed, r.traffic.touched += traffic.touched;
}
void count_known(const Kernel* kernel) { ledger().runs[kernel]; }
void count_wait() {
  Ledger& l = ledger();
  ++l.waits;
  if (l.forked) write(l);
}

}  // namespace ptx
