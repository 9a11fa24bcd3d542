#pragma once
#include <sys/types.h>

#include <functional>
#include <string>

#include "run/environment_end.h"
#include "run/progress.h"

namespace mortise::run {

// One environment in a process of its own: a copy of this one, which must not have started threads.
class EnvironmentProcess {
 public:
  // `work` is called in there, and its progress is what listen() hears.
  EnvironmentProcess(long environment, int threads, const std::function<Exit(Progress&)>& work);
  ~EnvironmentProcess();
  EnvironmentProcess(const EnvironmentProcess&) = delete;
  EnvironmentProcess& operator=(const EnvironmentProcess&) = delete;

  long environment() const { return environment_; }
  int threads() const { return threads_; }
  int pipe() const { return pipe_; }
  void signal(int number) const;
  // Hands on what it says, line by line; false when it has ended, and then `end` says how.
  bool listen(const std::function<void(const std::string&)>& said, EnvironmentEnd& end);

 private:
  void ended(EnvironmentEnd& end);

  long environment_;
  int threads_;
  pid_t process_ = -1;
  int pipe_ = -1;
  std::string line_, error_;  // begun; what it could not do
  double began_;              // [s]
};

// Does `work` in a process of its own and returns its exit code: for questions whose answer must leave nothing behind here.
int asked_aside(const std::function<int()>& work);

}  // namespace mortise::run
