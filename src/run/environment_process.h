#pragma once
#include <sys/types.h>

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "run/environment_end.h"
#include "run/progress.h"

namespace mortise::run {

// One environment in a process of its own, or several together: a copy of this process, which must not have started threads.
class EnvironmentProcess {
 public:
  // `work` is called in there; what it says (make_progress_of, tell_end) is what listen() hears.
  EnvironmentProcess(std::vector<long> environments, int threads, const std::function<void()>& work);
  ~EnvironmentProcess();
  EnvironmentProcess(const EnvironmentProcess&) = delete;
  EnvironmentProcess& operator=(const EnvironmentProcess&) = delete;

  const std::vector<long>& environments() const { return environments_; }
  int threads() const { return threads_; }
  int pipe() const { return pipe_; }
  void signal(int number) const;
  // Hands on what environments say, line by line, and calls `ended` of each that has; false when the process has. `all`: of every environment of the
  // scene.
  bool listen(const std::function<void(long, const std::string&)>& said, const std::function<void(long)>& ended, std::vector<EnvironmentEnd>& all);

 private:
  void end(const std::function<void(long)>& ended, std::vector<EnvironmentEnd>& all);

  std::vector<long> environments_;
  std::set<long> told_;  // which have ended, by their own account
  int threads_;
  pid_t process_ = -1;
  int pipe_ = -1;
  std::string line_, error_;  // begun; what it could not do
  double began_;              // [s]
};

// In such a process: an environment has ended so.
void tell_end(long environment, const EnvironmentEnd& end);

// Does `work` in a process of its own and returns its exit code: for questions whose answer must leave nothing behind here.
int asked_aside(const std::function<int()>& work);

}  // namespace mortise::run
