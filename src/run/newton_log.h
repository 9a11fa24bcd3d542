#pragma once
// newton.csv: one line per Newton iteration, for scenes with `solver: {trace: true}`. A resumed run continues it behind the steps that its
// checkpoint has.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "base/archive.h"
#include "base/error.h"
#include "solver/report.h"

namespace mortise::run {

class NewtonLog {
 public:
  explicit NewtonLog(std::string path) : path_(std::move(path)) {}
  ~NewtonLog() {
    if (file_ >= 0) ::close(file_);
  }
  NewtonLog(const NewtonLog&) = delete;
  NewtonLog& operator=(const NewtonLog&) = delete;

  void step(const solver::StepReport& r) {
    if (r.trace.empty()) return;
    open();
    std::string text = length_ > 0 ? "" : "step,time,dt,round,iteration,residual,tolerance,energy,concave,products,step_length,alpha,where\n";
    for (const solver::Iterate& i : r.trace)
      text += fmt::format("{},{:.9g},{:.6g},{},{},{:.6g},{:.6g},{:.15g},{:.4g},{},{:.6g},{:.6g},{}\n", r.step + 1, i.time, i.dt, i.round, i.iteration,
                          i.residual, i.tolerance, i.energy, i.concave, i.products, i.step, i.alpha, i.where);
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t n = ::write(file_, text.data() + done, text.size() - done);
      if (n <= 0 && errno != EINTR) fail();
      if (n > 0) done += static_cast<std::size_t>(n);
    }
    length_ += static_cast<long>(text.size());
  }
  void checkpoint(Archive& archive) { archive.io("length", length_); }

 private:
  // What is behind the steps that count is of steps that were never saved.
  void open() {
    if (file_ >= 0) return;
    file_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0666);
    struct stat status = {};
    if (file_ < 0 || ::fstat(file_, &status) != 0) fail();
    if (status.st_size < length_) throw Error(Exit::file, "'" + path_ + "' has lost lines since the checkpoint; move it away to go on without them");
    if (status.st_size > length_ && ::ftruncate(file_, length_) != 0) fail();
  }
  [[noreturn]] void fail() const { throw Error(Exit::file, "cannot write '" + path_ + "': " + std::strerror(errno)); }

  std::string path_;
  int file_ = -1;
  long length_ = 0;
};

}  // namespace mortise::run
