#include "cli/flags.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>

#include "scene/quantity.h"

namespace mortise::cli {

namespace {
bool is_nan(const std::string& value) { return std::isnan(std::strtod(value.c_str(), nullptr)); }
// CLI11 gives a flag whose value was forgotten the next one for it.
Flag no_flag(CLI::Option* option) {
  return Flag(option).check(
      [](const std::string& value) { return value.starts_with("--") ? "'" + value + "' is a flag where a value is wanted" : std::string(); });
}
// CLI11 would say "Could not convert".
Flag whole(CLI::Option* option) {
  return Flag(option).check([](const std::string& value) {
    const std::size_t sign = !value.empty() && (value[0] == '-' || value[0] == '+') ? 1 : 0;
    const bool digits = value.size() > sign && value.size() < 19 && value.find_first_not_of("0123456789", sign) == std::string::npos;
    return digits ? std::string() : "'" + value + "' must be a whole number";
  });
}
}  // namespace

Flag Flag::required() const { return Flag(option_->required()); }
Flag Flag::take_all() const { return Flag(option_->take_all()); }
Flag Flag::one_each() const { return Flag(option_->allow_extra_args(false)); }
Flag Flag::show_default() const { return Flag(option_->capture_default_str()); }
Flag Flag::maybe_value(const std::string& otherwise) const { return Flag(option_->expected(0, 1)->default_str(otherwise)); }
Flag Flag::split(char at) const { return Flag(option_->delimiter(at)); }
Flag Flag::environment_variable(const std::string& name) const { return Flag(option_->envname(name)); }
Flag Flag::excludes(Flag other) const { return Flag(option_->excludes(other.option_)); }
Flag Flag::needs(Flag other) const { return Flag(option_->needs(other.option_)); }
Flag Flag::positive() const {  // CLI11 would say that it is not in the range up to the largest number there is
  return check([](const std::string& value) {
    return CLI::PositiveNumber(value).empty() && !is_nan(value) ? std::string() : value + " must be a number above zero";
  });
}
Flag Flag::not_negative() const {
  return check([](const std::string& value) {
    return CLI::NonNegativeNumber(value).empty() && !is_nan(value) ? std::string() : value + " must be a number from 0";
  });
}
Flag Flag::within(int low, int high) const { return Flag(option_->check(CLI::Range(low, high))); }
Flag Flag::one_of(const std::vector<std::string>& values) const { return Flag(option_->check(CLI::IsMember(values))); }
Flag Flag::check(std::function<std::string(const std::string&)> wrong) const {
  return Flag(option_->check([wrong](const std::string& value) { return wrong(value); }));
}

Command Command::command(const std::string& name, const std::string& help) const { return Command(app_->add_subcommand(name, help)); }
Flag Command::option(const std::string& name, std::string& to, const std::string& help) const { return no_flag(app_->add_option(name, to, help)); }
Flag Command::option(const std::string& name, std::vector<std::string>& to, const std::string& help) const {
  return no_flag(app_->add_option(name, to, help));
}
Flag Command::option(const std::string& name, std::vector<double>& to, const std::string& help) const {
  return Flag(app_->add_option(name, to, help));
}
Flag Command::option(const std::string& name, int& to, const std::string& help) const { return whole(app_->add_option(name, to, help)); }
Flag Command::option(const std::string& name, long& to, const std::string& help) const { return whole(app_->add_option(name, to, help)); }
Flag Command::option(const std::string& name, unsigned long& to, const std::string& help) const { return whole(app_->add_option(name, to, help)); }
Flag Command::option(const std::string& name, double& to, const std::string& help) const { return Flag(app_->add_option(name, to, help)); }
Flag Command::time(const std::string& name, double& to, const std::string& help, bool positive) const {
  const auto read = [&to, name, positive](const std::string& text) {
    const scene::Quantity q = scene::parse_quantity(text, Unit::time);
    if (!q.error.empty()) throw CLI::ValidationError("a time " + q.error + (q.hint.empty() ? "" : "\n  " + q.hint));
    if (q.value < 0 || (positive && q.value == 0))
      throw CLI::ValidationError(name + " is '" + text + "'; must " + (positive ? "be more than 0 s" : "not be negative"));
    to = q.value;
  };
  return Flag(app_->add_option_function<std::string>(name, read, help));
}
Flag Command::flag(const std::string& name, bool& to, const std::string& help) const { return Flag(app_->add_flag(name, to, help)); }
void Command::footer(const std::string& text) const { app_->footer(text); }
void Command::action(std::function<void()> when_named) const { app_->callback(std::move(when_named)); }

}  // namespace mortise::cli
