#pragma once
#include <set>
#include <string>

#include "base/error.h"

namespace mortise {

// What is wrong with the parts of a scene, each by itself, so that a user reads all of it at once.
class Complaints {
 public:
  // Keeps an Error(Exit::scene) of `work`; what else it throws goes on.
  template <class Work>
  void gather(const Work& work) {
    try {
      work();
    } catch (const Error& e) {
      if (e.code() != Exit::scene) throw;
      if (!seen_.insert(e.what()).second) return;
      if (text_.empty())
        located_ = e.located();
      else
        text_ += e.located() ? "\n" : "\nerror: ";
      text_ += e.what();
    }
  }
  bool empty() const { return text_.empty(); }
  // Throws one Error(Exit::scene) with all of them, if there are any.
  void raise() const {
    if (!empty()) throw Error(Exit::scene, text_, located_);
  }

 private:
  std::string text_;
  bool located_ = false;
  std::set<std::string> seen_;  // one body's mistake is the same in all environments
};

// `work` on each part, also behind one that is wrong; throws one Error(Exit::scene) with what is wrong with all.
template <class Parts, class Work>
void on_each(const Parts& parts, const Work& work) {
  Complaints wrong;
  for (const auto& part : parts) wrong.gather([&] { work(part); });
  wrong.raise();
}

}  // namespace mortise
