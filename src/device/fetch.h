#pragma once
// Numbers on their way to the host: results of reductions and scans wait on the device until one copy brings all of them. Every copy to
// the host makes it wait for the device, so what a phase of the solver wants to know is fetched together. Included by device.h.
#include <cstring>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

namespace mortise::device {

class Fetch {
 public:
  Fetch() = default;
  Fetch(const Fetch&) = delete;
  Fetch& operator=(const Fetch&) = delete;

  // `values` must stay as they are until now(), which hands a copy to take(const std::vector<T>&).
  template <class T, class Receive>
  void add(View<const T> values, Receive receive) {
    static_assert(sizeof(T) % sizeof(Word) == 0 && alignof(T) >= sizeof(Word));
    wishes_.push_back({reinterpret_cast<const Word*>(values.p), static_cast<Index>(values.n * (sizeof(T) / sizeof(Word))),
                       [n = values.n, receive](const Word* from) {
                         std::vector<T> host(n);
                         if (n) std::memcpy(host.data(), from, n * sizeof(T));
                         receive(host);
                       }});
  }
  template <class T>
  void add(View<const T> values, std::vector<T>& to) {
    add(values, [&to](const std::vector<T>& host) { to = host; });
  }
  // The total that scan() left behind the counts.
  void add_total(const Buffer<Index>& scanned, Index& to) {
    add(View<const Index>{scanned.view().p + scanned.size() - 1, 1}, [&to](const std::vector<Index>& host) { to = host[0]; });
  }
  // Done by now() after all that was added before.
  void then(std::function<void()> what) {
    wishes_.push_back({nullptr, 0, [what](const Word*) { what(); }});
  }
  // Memory that must stand until now().
  template <class T>
  void keep(Buffer<T>&& memory) {
    kept_.push_back(std::make_shared<Buffer<T>>(std::move(memory)));
  }

  // One copy, none where nothing was added; then everything is handed out in the order in which it was added. `who` waits, for the table of waits.
  void now(std::string_view who = "other");

 private:
  using Word = std::uint32_t;
  struct Wish {
    const Word* from;
    Index words;
    std::function<void(const Word*)> receive;
  };
  std::vector<Word> bring(std::string_view who) const;

  std::vector<Wish> wishes_;
  std::vector<std::shared_ptr<void>> kept_;
};

// One value per environment on the host, into which results are combined once `fetch` brings them; `value` must live until then.
struct EnvValues {
  std::vector<double>& value;
  Fetch& fetch;
};

}  // namespace mortise::device
