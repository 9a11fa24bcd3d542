#include "run/signals.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

namespace mortise::run {

TEST(Signals, TheSecondEndsAProgramThatHangs) {
  for (const int signal : {SIGTERM, SIGINT}) {
    int ready[2];
    ASSERT_EQ(pipe(ready), 0);
    const pid_t child = fork();
    if (child == 0) {
      install_signal_handlers();
      (void)!write(ready[1], "x", 1);
      while (!stop_asked()) usleep(1000);
      (void)!write(ready[1], "x", 1);
      for (;;) usleep(1000);  // never asks again
    }
    char mark;
    ASSERT_EQ(read(ready[0], &mark, 1), 1);
    kill(child, signal);
    ASSERT_EQ(read(ready[0], &mark, 1), 1) << "the first one asks";
    kill(child, signal);
    alarm(20);
    int status = 0;
    waitpid(child, &status, 0);
    alarm(0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 128 + signal) << status;
    close(ready[0]), close(ready[1]);
  }
}

}  // namespace mortise::run
