#pragma once
// Flags of a command, by CLI11, whose header takes seconds to compile and is read by two sources only.
#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace mortise::cli {

class Flag {
 public:
  explicit Flag(CLI::Option* option) : option_(option) {}
  Flag required() const;
  Flag take_all() const;      // values of all its occurrences
  Flag one_each() const;      // an occurrence takes one value and leaves the next word to others
  Flag show_default() const;  // in the help text: the value it has now
  Flag maybe_value(const std::string& otherwise) const;
  Flag split(char at) const;
  Flag environment_variable(const std::string& name) const;  // stands for a flag that is not given
  Flag excludes(Flag other) const;
  Flag needs(Flag other) const;
  Flag positive() const;
  Flag not_negative() const;
  Flag within(int low, int high) const;
  Flag one_of(const std::vector<std::string>& values) const;
  Flag check(std::function<std::string(const std::string&)> wrong) const;  // empty where it is not

 private:
  CLI::Option* option_;
};

class Command {
 public:
  explicit Command(CLI::App* app) : app_(app) {}
  Command command(const std::string& name, const std::string& help) const;
  // A name without dashes is a place in the line, others are flags with a value of the variable's type.
  Flag option(const std::string& name, std::string& to, const std::string& help) const;
  Flag option(const std::string& name, std::vector<std::string>& to, const std::string& help) const;
  Flag option(const std::string& name, std::vector<double>& to, const std::string& help) const;
  Flag option(const std::string& name, int& to, const std::string& help) const;
  Flag option(const std::string& name, long& to, const std::string& help) const;
  Flag option(const std::string& name, unsigned long& to, const std::string& help) const;
  Flag option(const std::string& name, double& to, const std::string& help) const;
  Flag time(const std::string& name, double& to, const std::string& help, bool positive = false) const;  // '4 h' [s]
  Flag flag(const std::string& name, bool& to, const std::string& help) const;
  void footer(const std::string& text) const;
  void action(std::function<void()> when_named) const;

 private:
  CLI::App* app_;
};

}  // namespace mortise::cli
