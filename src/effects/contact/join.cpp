#include "effects/contact/join.h"

#include <utility>

namespace mortise::effects::contact {
namespace {

using device::Buffer;
using device::View;
using model::ContactSample;

// How many samples belong to environments before `env`.
MORTISE_HD inline Index count_before(View<const ContactSample> samples, Index env) {
  Index lo = 0, hi = samples.n;
  while (lo < hi) {
    const Index mid = (lo + hi) / 2;
    if (samples[mid].env < env)
      lo = mid + 1;
    else
      hi = mid;
  }
  return lo;
}

// Of joined sample i, which is number `from` of its list: how many of the first list come before it.
MORTISE_HD inline Index firsts_before(Index i, Index from) { return from >= 0 ? from : i + 1 + from; }

// Room for joined changes whose samples have points of their own: those of the second list have them from the samples.
void scatter(const Buffer<ContactSample>& joined, View<const Index> from, const model::SampleChangesView& first, Index functionals,
             linalg::StencilSizes sizes, model::SampleChanges& out) {
  constexpr Index kPoints = model::SampleChangesView::kUniform;
  const View<const ContactSample> sample = joined.view();
  const Index n = sample.n;
  Buffer<Index> starts(n + 1), nodes(first.node.n + kPoints * (n - (first.start.n - 1)));
  const View<Index> start = starts.view(), node = nodes.view();
  device::parallel_for("contact.join_nodes", n + 1, [=] MORTISE_HD(Index i) {
    if (i == n) {
      start[i] = node.n;
      return;
    }
    const Index f = firsts_before(i, from[i]), at = first.start[f] + kPoints * (i - f);
    start[i] = at;
    if (from[i] >= 0)
      for (Index k = 0; k < first.points(f); ++k) node[at + k] = first.node[first.start[f] + k];
    else
      for (Index k = 0; k < kPoints; ++k) node[at + k] = sample[i].point[k];  // -1 where there is none
  });
  out.resize(n, functionals, starts, nodes);
  out.sizes = sizes;
}

}  // namespace

void join(const Buffer<ContactSample>& more, const std::vector<Index>& more_env, linalg::StencilSizes more_sizes, model::ContactView& to,
          Buffer<Index>& origin) {
  const Index n = to.samples.size(), all = n + more.size();
  Buffer<ContactSample> joined(all);
  origin.resize(all);
  const View<const ContactSample> first = std::as_const(to.samples).view(), second = more.view();
  const View<ContactSample> out = joined.view();
  const View<Index> from = origin.view();
  device::parallel_for("contact.join", all, [=] MORTISE_HD(Index i) {
    const bool of_first = i < n;
    const Index j = of_first ? i : i - n;
    const ContactSample& s = of_first ? first[j] : second[j];
    const Index place = j + (of_first ? count_before(second, s.env) : count_before(first, s.env + 1));
    out[place] = s, from[place] = of_first ? j : -1 - j;
  });
  to.samples.swap(joined);
  to.sizes = to.sizes + more_sizes;
  for (std::size_t e = 0; e < to.env_offset.size(); ++e) to.env_offset[e] += more_env[e];
}

void join(const Buffer<ContactSample>& joined, const Buffer<Index>& origin, model::SampleChanges& more, model::SampleChanges& to) {
  const View<const Index> from = origin.view();
  const model::SampleChangesView first = to.view(), second = more.view();
  const Index functionals = first.functionals > second.functionals ? first.functionals : second.functionals;
  model::SampleChanges changes;
  if (to.scattered())
    scatter(joined, from, first, functionals, to.sizes + more.sizes, changes);
  else
    changes.resize(joined.size(), functionals, true);
  const model::SampleChangesView out = changes.view();
  device::parallel_for("contact.join_changes", functionals * joined.size(), [=] MORTISE_HD(Index at) {
    const Index i = at / functionals, c = at % functionals, j = from[i] >= 0 ? from[i] : -1 - from[i];
    const model::SampleChangesView& of = from[i] >= 0 ? first : second;
    out.clear(i, c);
    if (c == 0) out.known_[i] = of.functionals > 0 && of.known(j);
    if (c >= of.functionals) return;
    out.force(i, c) = of.force(j, c), out.normal(i, c) = of.normal(j, c);
    for (Index k = 0; k < of.points(j); ++k) out.along(i, c)[k] = of.along(j, c)[k], out.weight(i, c)[k] = of.weight(j, c)[k];
  });
  std::swap(to, changes);
}

}  // namespace mortise::effects::contact
