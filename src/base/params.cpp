#include "base/params.h"

#include <algorithm>

namespace mortise {
namespace {

[[noreturn]] void wrong(const char* wanted, const SourceLoc& at) { throw Error(Exit::internal, at, std::string("parameter is not a ") + wanted); }

}  // namespace

Params Params::make_number(double v, SourceLoc at) {
  Params p;
  p.kind_ = Kind::number, p.number_ = v, p.at_ = std::move(at);
  return p;
}
Params Params::make_integer(long long v, SourceLoc at) {
  Params p;
  p.kind_ = Kind::integer, p.integer_ = v, p.at_ = std::move(at);
  return p;
}
Params Params::make_flag(bool v, SourceLoc at) {
  Params p;
  p.kind_ = Kind::flag, p.integer_ = v, p.at_ = std::move(at);
  return p;
}
Params Params::make_text(std::string v, SourceLoc at) {
  Params p;
  p.kind_ = Kind::text, p.text_ = std::move(v), p.at_ = std::move(at);
  return p;
}
Params Params::make_path(std::string v, SourceLoc at) {
  Params p = make_text(std::move(v), std::move(at));
  p.path_ = true;
  return p;
}
Params Params::make_list(std::vector<Params> items, SourceLoc at) {
  Params p;
  p.kind_ = Kind::list, p.items_ = std::move(items), p.at_ = std::move(at);
  return p;
}
Params Params::make_table(SourceLoc at) {
  Params p;
  p.kind_ = Kind::table, p.at_ = std::move(at);
  return p;
}

double Params::as_number() const {
  if (kind_ == Kind::number) return number_;
  if (kind_ == Kind::integer) return static_cast<double>(integer_);
  wrong("number", at_);
}
long long Params::as_integer() const {
  if (kind_ != Kind::integer) wrong("integer", at_);
  return integer_;
}
bool Params::as_flag() const {
  if (kind_ != Kind::flag) wrong("flag", at_);
  return integer_ != 0;
}
const std::string& Params::as_text() const {
  if (kind_ != Kind::text) wrong("text", at_);
  return text_;
}
Vec3 Params::as_vec3() const {
  if (kind_ != Kind::list || items_.size() != 3) wrong("vector of three numbers", at_);
  return {items_[0].as_number(), items_[1].as_number(), items_[2].as_number()};
}
std::vector<double> Params::as_numbers() const {
  std::vector<double> out;
  for (const Params& item : items()) out.push_back(item.as_number());
  return out;
}
const std::vector<Params>& Params::items() const {
  if (kind_ != Kind::list) wrong("list", at_);
  return items_;
}
const std::vector<std::pair<std::string, Params>>& Params::entries() const {
  if (kind_ != Kind::table) wrong("table", at_);
  return entries_;
}

const Params* Params::find(std::string_view key) const {
  for (const auto& [k, v] : entries_)
    if (k == key) return &v;
  return nullptr;
}
bool Params::has(std::string_view key) const { return find(key) != nullptr; }
const Params& Params::at(std::string_view key) const {
  if (const Params* p = find(key)) return *p;
  throw Error(Exit::internal, at_, "no parameter '" + std::string(key) + "'");
}

void Params::set(std::string key, Params value) {
  kind_ = Kind::table;
  for (auto& [k, v] : entries_)
    if (k == key) {
      v = std::move(value);
      return;
    }
  entries_.emplace_back(std::move(key), std::move(value));
}
void Params::remove(std::string_view key) {
  std::erase_if(entries_, [&](const auto& entry) { return entry.first == key; });
}
void Params::push(Params value) {
  kind_ = Kind::list;
  items_.push_back(std::move(value));
}

Schedule::Schedule(const Params& p, bool smooth) {
  if (p.kind() == Params::Kind::table) {
    time_ = p.numbers("time");
    value_ = p.numbers("value");
  } else {
    time_ = {0};
    value_ = {p.as_number()};
  }
  if (!smooth) return;
  slope_.assign(time_.size(), 0.0);
  for (std::size_t k = 1; k + 1 < time_.size(); ++k) {
    const double h0 = time_[k] - time_[k - 1], h1 = time_[k + 1] - time_[k];
    const double d0 = (value_[k] - value_[k - 1]) / h0, d1 = (value_[k + 1] - value_[k]) / h1;
    if (!(d0 * d1 > 0)) continue;
    const double a = (h0 + 2 * h1) / (3 * (h0 + h1));
    slope_[k] = d0 * d1 / (a * d1 + (1 - a) * d0);
  }
}

double Schedule::operator()(double t) const {
  if (t <= time_.front()) return value_.front();
  if (t >= time_.back()) return value_.back();
  const auto hi = std::upper_bound(time_.begin(), time_.end(), t) - time_.begin();
  const double s = (t - time_[hi - 1]) / (time_[hi] - time_[hi - 1]);
  if (slope_.empty()) return value_[hi - 1] + s * (value_[hi] - value_[hi - 1]);
  const double h = time_[hi] - time_[hi - 1], r = 1 - s;
  return r * r * (1 + 2 * s) * value_[hi - 1] + s * s * (3 - 2 * s) * value_[hi] + h * s * r * (r * slope_[hi - 1] - s * slope_[hi]);
}

}  // namespace mortise
