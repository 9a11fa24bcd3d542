#include "bridge/message.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "bridge/exit.h"
#include "bridge/tuning.h"
#include "effects/tie_name.h"
#include "scene/suggest.h"

namespace mortise::bridge {
namespace {

using Json = nlohmann::ordered_json;

class Reader {
 public:
  Reader(const std::string& line, const std::string& from, const std::vector<Drive>& drives) : line_(line), from_(from), drives_(drives) {}

  Message read() {
    const Json j = parsed();
    if (!j.is_object()) fail(fmt::format("is {}, not an object like {{\"targets\": {{\"elbow\": 0.3}}}}", a(j)));
    Message out;
    for (const auto& [key, value] : j.items()) {
      if (key == "targets" || key == "efforts")
        commands(key, value, out);
      else if (key == "reset" || key == "end")
        (key == "reset" ? out.reset : out.end) = is_true(key, value);
      else
        fail(fmt::format("unknown key '{}'{}", key, hint(key, {"targets", "efforts", "reset", "end"})));
    }
    if ((out.reset || out.end) && j.size() > 1) fail("'reset' and 'end' stand alone: the step they answer is not taken");
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(kPartnerFailed, from_ + ": " + what); }

  // A key that stands twice is an error, not the later one.
  Json parsed() const {
    std::vector<std::set<std::string>> keys;
    std::string twice;
    const auto watch = [&](int, Json::parse_event_t event, Json& value) {
      if (event == Json::parse_event_t::object_start) keys.emplace_back();
      if (event == Json::parse_event_t::object_end) keys.pop_back();
      if (event == Json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second) twice = value.get<std::string>();
      return true;
    };
    if (line_.find_first_not_of(" \t\r") == std::string::npos) fail("is an empty line; {} leaves everything as it is");
    try {
      Json j = Json::parse(line_, watch);
      if (!twice.empty()) fail("the key '" + twice + "' stands twice");
      return j;
    } catch (const Json::parse_error& e) {
      const auto at = static_cast<std::size_t>(e.byte);
      const std::size_t from = at > kExcerpt / 2 ? at - kExcerpt / 2 : 0;
      fail(fmt::format("is no JSON at character {}: {}{}{}{}", at, from > 0 ? "..." : "", line_.substr(from, kExcerpt),
                       from + kExcerpt < line_.size() ? "..." : "",
                       line_.find("NaN") != std::string::npos || line_.find("Infinity") != std::string::npos
                           ? "\n  NaN and Infinity are no JSON; a number has to be finite"
                           : "\n  the standard output of a partner belongs to the exchange; print other things to the standard error"));
    } catch (const Json::exception&) {
      fail("a number is too large");
    }
  }

  void commands(const std::string& key, const Json& all, Message& out) const {
    if (!all.is_object()) fail(fmt::format("{} is {}, not an object of joints and numbers", key, a(all)));
    for (const auto& [joint, value] : all.items()) {
      const Drive& d = drive(key, joint);
      const bool effort = key == "efforts";
      if ((d.mode == Drive::Mode::effort) != effort)
        fail(fmt::format("{}.{}: its drive is of mode {}, which takes '{}' [{}]", key, joint, d.mode_name(), effort ? "targets" : "efforts",
                         d.unit()));
      if (!value.is_number()) fail(fmt::format("{}.{} is {}, not a number [{}]", key, joint, a(value), d.unit()));
      const double x = value.get<double>();
      if (!std::isfinite(x)) fail(fmt::format("{}.{} is not finite", key, joint));
      if (d.mode == Drive::Mode::kinematic && !(d.low < x && x < d.high))
        fail(fmt::format("{}.{} is {} {}, not between the limits of the joint, {} and {} {}", key, joint, x, d.unit(), d.low, d.high, d.unit()));
      out.values[joint] = x;
    }
  }

  const Drive& drive(const std::string& key, const std::string& joint) const {
    std::vector<std::string> known;
    for (const Drive& d : drives_) {
      if (d.joint == joint) return d;
      known.push_back(d.joint);
    }
    fail(fmt::format("{}: no drive of the scene moves a joint '{}'{}", key, joint, hint(joint, known)));
  }

  bool is_true(const std::string& key, const Json& value) const {
    if (!value.is_boolean() || !value.get<bool>()) fail(fmt::format("{} is {}; it can only be true", key, a(value)));
    return true;
  }

  static std::string hint(const std::string& typed, const std::vector<std::string>& known) {
    const std::string text = scene::suggestion(typed, known);
    return text.empty() ? "" : "; " + text;
  }
  static std::string a(const Json& j) {
    switch (j.type()) {
      case Json::value_t::null:
        return "null";
      case Json::value_t::object:
        return "an object";
      case Json::value_t::array:
        return "a list";
      case Json::value_t::string:
        return "a text";
      case Json::value_t::boolean:
        return j.get<bool>() ? "true" : "false";
      default:
        return "a number";
    }
  }

  const std::string &line_, &from_;
  const std::vector<Drive>& drives_;
};

}  // namespace

std::vector<Drive> drives_of(const Params& scene) {
  std::vector<Drive> out;
  const Params& effects = scene.at("effects");
  const Params *drives = effects.find("drive"), *joints = effects.find("joint");
  if (!drives || !joints) return out;
  for (const Params& d : drives->items()) {
    const std::string& mode = d.text("mode");
    if (mode == "passive") continue;
    Drive drive{d.text("joint"),
                mode == "pd"          ? Drive::Mode::pd
                : mode == "kinematic" ? Drive::Mode::kinematic
                                      : Drive::Mode::effort,
                false, -INFINITY, INFINITY};
    for (const Params& j : joints->items()) {
      if (effects::tie_name(j) != drive.joint) continue;
      drive.slides = j.text("type") == "prismatic";
      if (const Params* limits = j.find(drive.slides ? "travel_limits" : "angle_limits")) {
        const std::vector<double> ends = limits->as_numbers();
        drive.low = ends.at(0), drive.high = ends.at(1);
      }
    }
    out.push_back(std::move(drive));
  }
  return out;
}

Message read_message(const std::string& line, const std::string& from, const std::vector<Drive>& drives) { return Reader(line, from, drives).read(); }

}  // namespace mortise::bridge
