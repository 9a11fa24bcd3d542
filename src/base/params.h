#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/types.h"

namespace mortise {

// A resolved scene value: checked, defaults filled in, every number in SI. The scene reader builds the tree; everything
// behind it (model, effects, render) only reads it. Asking for what is not there is a bug of ours (Exit::internal).
class Params {
 public:
  enum class Kind { none, number, integer, flag, text, list, table };

  Params() = default;
  static Params make_number(double v, SourceLoc at = {});
  static Params make_integer(long long v, SourceLoc at = {});
  static Params make_flag(bool v, SourceLoc at = {});
  static Params make_text(std::string v, SourceLoc at = {});
  static Params make_path(std::string v, SourceLoc at = {});  // text that names a file
  static Params make_list(std::vector<Params> items = {}, SourceLoc at = {});
  static Params make_table(SourceLoc at = {});

  Kind kind() const { return kind_; }
  bool is_path() const { return path_; }
  const SourceLoc& where() const { return at_; }

  // Value of this node.
  double as_number() const;  // integers convert
  long long as_integer() const;
  bool as_flag() const;
  const std::string& as_text() const;
  Vec3 as_vec3() const;  // list of three numbers
  std::vector<double> as_numbers() const;
  const std::vector<Params>& items() const;                            // list
  const std::vector<std::pair<std::string, Params>>& entries() const;  // table, in file order

  // Children of a table.
  bool has(std::string_view key) const;
  const Params& at(std::string_view key) const;
  const Params* find(std::string_view key) const;
  double number(std::string_view key) const { return at(key).as_number(); }
  long long integer(std::string_view key) const { return at(key).as_integer(); }
  bool flag(std::string_view key) const { return at(key).as_flag(); }
  const std::string& text(std::string_view key) const { return at(key).as_text(); }
  Vec3 vec3(std::string_view key) const { return at(key).as_vec3(); }
  std::vector<double> numbers(std::string_view key) const { return at(key).as_numbers(); }

  void set(std::string key, Params value);  // table: replace or append
  void remove(std::string_view key);        // table
  void push(Params value);                  // list: append

 private:
  Kind kind_ = Kind::none;
  double number_ = 0;
  long long integer_ = 0;
  std::string text_;
  bool path_ = false;
  std::vector<Params> items_;
  std::vector<std::pair<std::string, Params>> entries_;
  SourceLoc at_;
};

// Piecewise-linear function of time: what a `schedule` parameter resolves to. A plain number is constant in time.
// Before the first key and after the last the value stays.
class Schedule {
 public:
  Schedule() = default;
  explicit Schedule(const Params& p, bool smooth = false);  // number, or table {time: [...], value: [...]}; smooth: see slope_
  double operator()(double t) const;
  const std::vector<double>& keys() const { return time_; }  // where it may bend [s]

 private:
  std::vector<double> time_, value_;
  // At the keys, of a cubic that starts and ends at rest and never overshoots them (Fritsch, Butland, SIAM J. Sci. Stat. Comput. 5, 1984);
  // empty: linear in between.
  std::vector<double> slope_;
};

}  // namespace mortise
