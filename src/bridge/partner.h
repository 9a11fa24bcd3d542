#pragma once
// Whoever commands the drives: a program that this one starts and talks to through two pipes, or the one that started it, through the standard
// streams. A line each way at a time; both ways are served at once, so nobody waits for somebody who waits.
#include <sys/types.h>

#include <functional>
#include <string>

namespace mortise::bridge {

class Partner {
 public:
  // command: for the shell; "-": the standard input and output of this process. timeout [s]: for an answer; 0: none.
  // Throws Error(Exit::internal) where there can be no more processes.
  Partner(std::string command, double timeout);
  ~Partner();  // a partner that does not end by itself is ended
  Partner(const Partner&) = delete;
  Partner& operator=(const Partner&) = delete;

  struct Stopped {};
  // Says the lines that wait and `line`, and returns the next line of the answer. Throws Error(kPartnerFailed) where there is none in time (`to`:
  // what it should have answered to), and Stopped where `stop` says so.
  std::string ask(const std::string& line, const std::string& to, const std::function<bool()>& stop);
  // Said together with the next question, or at the end.
  void say(const std::string& line) { out_ += line + "\n"; }

 private:
  bool take_line(std::string& line);
  void write_some();
  void read_some();
  [[noreturn]] void gone(const std::string& to);
  std::string who() const { return child_ < 0 && input_ == 0 ? "the standard input" : "the bridge's partner '" + command_ + "'"; }
  int ended(double seconds);  // status of the child, -1 where it still runs

  std::string command_;
  double timeout_;
  pid_t child_ = -1;
  int input_ = -1, output_ = -1;  // what it says; what it hears
  bool heard_all_ = false, started_ = false;
  std::string out_, in_;
};

}  // namespace mortise::bridge
