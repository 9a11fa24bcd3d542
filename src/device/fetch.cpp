#include "device/device.h"

namespace mortise::device {
namespace {

constexpr Index kAtOnce = 16;

// Some ranges of words, gathered by one launch.
struct Sources {
  const std::uint32_t* from[kAtOnce] = {};
  Index words[kAtOnce] = {}, to[kAtOnce] = {};
};

// The words [begin, end) of `out`.
void gather(const Sources& sources, Index begin, Index end, View<std::uint32_t> out) {
  const Sources s = sources;
  parallel_for("fetch.gather", end - begin, [=] MORTISE_HD(Index i) {
    Index k = 0;
    while (begin + i >= s.to[k] + s.words[k]) ++k;
    out[begin + i] = s.from[k][begin + i - s.to[k]];
  });
}

}  // namespace

std::vector<std::uint32_t> Fetch::bring(std::string_view who) const {
  std::vector<const Wish*> there;
  Index total = 0;
  for (const Wish& w : wishes_)
    if (w.words > 0) there.push_back(&w), total += w.words;
  std::vector<Word> host(total);
  if (there.size() == 1) copy_out(host.data(), there[0]->from, total * sizeof(Word), who);
  if (there.size() < 2) return host;
  Buffer<Word> staged(total);
  Index to = 0;
  for (std::size_t first = 0; first < there.size(); first += kAtOnce) {
    Sources s;
    const Index begin = to;
    for (Index n = 0; n < kAtOnce && first + n < there.size(); ++n) {
      const Wish& w = *there[first + n];
      s.from[n] = w.from, s.words[n] = w.words, s.to[n] = to;
      to += w.words;
    }
    gather(s, begin, to, staged.view());
  }
  copy_out(host.data(), staged.view().p, total * sizeof(Word), who);
  return host;
}

void Fetch::now(std::string_view who) {
  const std::vector<Word> host = bring(who);
  const std::vector<Wish> wishes = std::move(wishes_);
  wishes_.clear(), kept_.clear();
  const Word* at = host.data();
  for (const Wish& w : wishes) {
    w.receive(at);
    at += w.words;
  }
}

}  // namespace mortise::device
