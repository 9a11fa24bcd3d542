#pragma once
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace mortise {

// One pass over everything a restart needs; the same code saves and loads. Doubles only: they carry indices exactly to 2^53.
class Archive {
 public:
  virtual ~Archive() = default;
  virtual bool loading() const = 0;
  virtual bool loads(int env) const {  // what belongs to this environment
    (void)env;
    return loading();
  }
  virtual void io(std::string_view name, std::vector<double>& values) = 0;
  // Values of which [first[e], first[e+1]) belong to environment e. Where the archive is that of some of them only (env_archives.h), what is loaded
  // takes the place of theirs, and all others stay as they came in.
  virtual void io(std::string_view name, std::vector<double>& values, const std::vector<std::size_t>& first) {
    (void)first;
    io(name, values);
  }
  void io(std::string_view name, double& value) {
    std::vector<double> v{value};
    io(name, v);
    value = v.at(0);
  }
  void io(std::string_view name, long& value) {
    auto v = static_cast<double>(value);
    io(name, v);
    value = static_cast<long>(v);
  }
  void io(std::string_view name, bool& value) {
    double v = value ? 1 : 0;
    io(name, v);
    value = v != 0;
  }
  void io(std::string_view name, std::string& text) {  // a byte per number
    std::vector<double> v;
    for (char c : text) v.push_back(static_cast<unsigned char>(c));
    io(name, v);
    text.clear();
    for (double c : v) text += static_cast<char>(static_cast<unsigned char>(c));
  }
  void io(std::string_view name, std::map<std::string, double>& map) {  // keys without line feeds
    std::string keys;
    std::vector<double> values;
    for (const auto& [key, value] : map) keys += key + "\n", values.push_back(value);
    io(std::string(name) + ".keys", keys);
    io(std::string(name) + ".values", values);
    map.clear();
    std::size_t at = 0;
    for (double value : values) {
      const std::size_t end = keys.find('\n', at);
      map.emplace(keys.substr(at, end - at), value);
      at = end + 1;
    }
  }
};

}  // namespace mortise
