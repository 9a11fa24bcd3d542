#include "study/figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/axis.h"
#include "study/canvas.h"
#include "study/compare.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

constexpr double kPlotWidth = 330, kPlotHeight = 250, kLeft = 74, kTop = 34, kBottom = 52, kGap = 22, kLegendLine = 21, kText = 12;
constexpr double kLeastSeconds = 1e-4;  // clocks of CPU time tell no less: what took none by them is drawn here
constexpr Colour kBlack{0, 0, 0}, kGrey{120, 120, 120}, kGrid{222, 222, 222}, kFaint{240, 240, 240}, kWhite{255, 255, 255}, kBand{226, 226, 226};
// Okabe and Ito: told apart by everyone.
constexpr Colour kColours[] = {{0, 114, 178}, {213, 94, 0}, {0, 158, 115}, {204, 121, 167}, {230, 159, 0}, {86, 180, 233}, {90, 90, 90}};

// Disc, square, triangle, diamond, triangle downwards: with the colours 35 that differ.
std::vector<Place2> marker(std::size_t kind, double x, double y, double size) {
  std::vector<Place2> out;
  const int corners[] = {24, 4, 3, 4, 3};
  const double turns[] = {0, 0.125, 0.25, 0.25, 0.75}, sizes[] = {1, 1.2, 1.3, 1.3, 1.3};
  const std::size_t k = kind % 5;
  for (int i = 0; i < corners[k]; ++i) {
    const double a = 2 * M_PI * (turns[k] + static_cast<double>(i) / corners[k]);
    out.emplace_back(x + size * sizes[k] * std::cos(a), y - size * sizes[k] * std::sin(a));
  }
  return out;
}

void cross(Canvas& c, double x, double y, Colour colour) {
  c.line({{x - 4, y - 4}, {x + 4, y + 4}}, {colour, 2});
  c.line({{x - 4, y + 4}, {x + 4, y - 4}}, {colour, 2});
}

const Stroke kFront{kGrey, 5, 0.35};

struct Style {
  std::string curve;
  Colour colour;
  std::size_t marker;
  bool line;
};

// The same curve has the same look in all panels.
std::vector<Style> styles(const Results& r) {
  std::vector<Style> out;
  std::size_t colours = 0;
  for (const Point& p : r.points) {
    if (std::any_of(out.begin(), out.end(), [&](const Style& s) { return s.curve == p.curve; })) continue;
    if (p.step == SIZE_MAX)
      out.push_back({p.curve, kBlack, 3, false});
    else
      out.push_back({p.curve, kColours[colours % std::size(kColours)], colours, p.refines}), ++colours;
  }
  // What all curves meet in lies on top.
  std::stable_partition(out.begin(), out.end(), [](const Style& s) { return s.line; });
  return out;
}

class Panel {
 public:
  Panel(const Results& r, std::size_t quantity, const std::vector<Style>& styles, double left, double top)
      : r_(r), q_(quantity), styles_(styles), left_(left), top_(top) {
    const Reference& ref = r.references[q_];
    band_ = std::isfinite(ref.uncertainty) ? ref.uncertainty / ref.scale : 0;
    std::vector<double> xs, ys;
    for (const Point& p : r.points) {
      if (p.quantity != q_ || p.reference) continue;
      if (std::isfinite(p.seconds)) xs.push_back(std::max(p.seconds, kLeastSeconds));
      // What is known no better than the band may lie anywhere below: the axis ends soon after.
      if (!p.failed && std::isfinite(p.error)) ys.push_back(std::max({p.error, band_ / 4, tuning::kRounding}));
    }
    if (band_ > 0) ys.push_back(1.5 * band_);
    empty_ = xs.empty();
    x_ = Axis(xs, left_, left_ + kPlotWidth), y_ = Axis(ys, top_ + kPlotHeight, top_);
  }

  void draw(Canvas& c) const {
    const double right = left_ + kPlotWidth, bottom = top_ + kPlotHeight;
    if (empty_) {
      frame(c);
      return c.text({left_ + 0.5 * kPlotWidth, top_ + 0.5 * kPlotHeight}, "no run to compare with the reference", kText, Anchor::middle, kGrey);
    }
    if (band_ > 0) {
      const double at = std::clamp(y_.at(band_), top_, bottom);
      c.shape({{left_, at}, {right, at}, {right, bottom}, {left_, bottom}}, kBand, 0.7, nullptr, "below the uncertainty of the reference");
    }
    for (const Axis::Tick& t : x_.ticks()) {
      c.line({{t.at, top_}, {t.at, bottom}}, {t.label.empty() ? kFaint : kGrid, 1});
      if (!t.label.empty()) c.text({t.at, bottom + 17}, t.label, kText, Anchor::middle, kBlack);
    }
    for (const Axis::Tick& t : y_.ticks()) {
      c.line({{left_, t.at}, {right, t.at}}, {t.label.empty() ? kFaint : kGrid, 1});
      if (!t.label.empty()) c.text({left_ - 7, t.at + 4}, t.label, kText, Anchor::end, kBlack);
    }
    front(c);
    for (const Style& s : styles_) curve(c, s);
    frame(c);  // over what lies on it
    const Reference& ref = r_.references[q_];
    c.text({left_ + 0.5 * kPlotWidth, bottom + 38}, r_.device == "cuda" ? "seconds" : "CPU seconds", kText, Anchor::middle, kBlack);
    c.text({left_ - 56, top_ + 0.5 * kPlotHeight}, ref.relative ? "relative error" : "error", kText, Anchor::middle, kBlack, true);
  }

  bool has_band() const { return !empty_ && band_ > 0; }

 private:
  // Outline and name.
  void frame(Canvas& c) const {
    const double right = left_ + kPlotWidth, bottom = top_ + kPlotHeight;
    c.line({{left_, top_}, {left_, bottom}, {right, bottom}, {right, top_}, {left_, top_}}, {kBlack, 1});
    c.text({left_ + 0.5 * kPlotWidth, top_ - 11}, shortened(r_.study.quantities[q_].name, kPlotWidth + kLeft - 20, 13), 13, Anchor::middle, kBlack,
           false, true);
  }

  static std::string shortened(std::string text, double width, double size) {
    if (text_width(text, size) <= width) return text;
    while (text.size() > 4 && text_width(text + "…", size) > width) {
      text.pop_back();
      while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0) == 0x80) text.pop_back();
    }
    return text + "…";
  }

  Place2 place(const Point& p) const {
    const double y = y_.at(std::max(p.error, tuning::kRounding));
    return {x_.at(std::max(p.seconds, kLeastSeconds)), std::clamp(y, top_, top_ + kPlotHeight - 5)};
  }

  void front(Canvas& c) const {
    std::vector<const Point*> best;
    for (const Point& p : r_.points)
      if (p.quantity == q_ && p.best) best.push_back(&p);
    std::sort(best.begin(), best.end(), [](const Point* a, const Point* b) { return a->seconds < b->seconds; });
    std::vector<Place2> steps;
    for (const Point* p : best) {
      Point known = *p;  // no better than the reference
      known.error = std::max(p->error, band_);
      if (!steps.empty()) steps.emplace_back(place(known).first, steps.back().second);
      steps.push_back(place(known));
    }
    if (best.empty()) return;
    steps.insert(steps.begin(), {steps.front().first, top_});     // nothing is quicker
    steps.emplace_back(left_ + kPlotWidth, steps.back().second);  // nothing slower is better
    c.line(steps, kFront);
  }

  void curve(Canvas& c, const Style& s) const {
    std::vector<Place2> path;
    const auto mine = [&](const Point& p) { return p.quantity == q_ && p.curve == s.curve && !p.reference; };
    for (const Point& p : r_.points)
      if (mine(p) && !p.failed && std::isfinite(p.error)) path.push_back(place(p));
    if (s.line) c.line(path, {s.colour, 1.6});
    for (const Point& p : r_.points) {
      if (!mine(p)) continue;
      const std::string tip =
          fmt::format("{}: {}", p.label, p.failed ? p.why : fmt::format("{:.6g}, error {:.3g}, {:.3g} s", p.value, p.error, p.seconds));
      if (p.failed || !std::isfinite(p.error)) {
        if (std::isfinite(p.seconds)) cross(c, x_.at(std::max(p.seconds, kLeastSeconds)), top_ + 8, s.colour);
        continue;
      }
      const auto [x, y] = place(p);
      if (p.slowest > p.seconds * 1.05) c.line({{x, y}, {x_.at(p.slowest), y}}, {s.colour, 1, 0.7});
      if (p.knee) {
        const Stroke ring{kBlack, 1.4};
        c.shape(marker(0, x, y, 9), kWhite, 0, &ring, "");
      }
      const Stroke edge{s.colour, 1.6};
      c.shape(marker(s.marker, x, y, 4.2), p.hollow ? kWhite : s.colour, 1, &edge, tip);
    }
  }

  const Results& r_;
  std::size_t q_;
  const std::vector<Style>& styles_;
  double left_, top_, band_ = 0;
  bool empty_ = false;  // every run is the reference
  Axis x_, y_;
};

// What the marks mean, as many side by side as there is room for; only what there is. Returns the height.
double legend(Canvas* c, const Results& r, const std::vector<Style>& all, bool band, double top, double width) {
  double x = 14, y = top;
  const auto place = [&](const std::string& text, auto&& mark) {
    const double wide = 30 + text_width(text, kText) + 18;
    if (x + wide > width && x > 14) x = 14, y += kLegendLine;
    if (c) mark(x + 12, y), c->text({x + 28, y + 4}, text, kText, Anchor::start, kBlack);
    x += wide;
  };
  const auto any = [&](auto is) { return std::any_of(r.points.begin(), r.points.end(), is); };
  for (const Style& s : all)
    place(s.curve.empty() ? "runs" : s.curve, [&](double px, double py) {
      if (s.line) c->line({{px - 11, py}, {px + 11, py}}, {s.colour, 1.6});
      const Stroke edge{s.colour, 1.6};
      c->shape(marker(s.marker, px, py, 4.2), s.colour, 1, &edge, "");
    });
  if (any([](const Point& p) { return p.best; })) {
    place("Pareto front", [&](double px, double py) { c->line({{px - 11, py}, {px + 11, py}}, kFront); });
    place("knee", [&](double px, double py) {
      const Stroke ring{kBlack, 1.4};
      c->shape(marker(0, px, py, 8), kWhite, 0, &ring, "");
    });
  }
  if (band)
    place("below the reference's uncertainty", [&](double px, double py) {
      c->shape({{px - 10, py - 6}, {px + 10, py - 6}, {px + 10, py + 6}, {px - 10, py + 6}}, kBand, 0.7, nullptr, "");
      const Stroke edge{kGrey, 1.6};
      c->shape(marker(0, px, py, 4.2), kWhite, 1, &edge, "");
    });
  if (any([](const Point& p) { return p.failed && std::isfinite(p.seconds); }))
    place("failed", [&](double px, double py) { cross(*c, px, py, kGrey); });
  return y + kLegendLine - top;
}

struct Layout {
  std::size_t columns, rows;
  double width, plots, height;
};

Layout layout(const Results& r, const std::vector<Style>& all) {
  const std::size_t n = std::max<std::size_t>(1, r.study.quantities.size());
  Layout out{};
  out.columns = n == 4 ? 2 : std::min<std::size_t>(n, 3), out.rows = (n + out.columns - 1) / out.columns;
  out.width = static_cast<double>(out.columns) * (kLeft + kPlotWidth) + kGap,
  out.plots = static_cast<double>(out.rows) * (kTop + kPlotHeight + kBottom);
  out.height = out.plots + legend(nullptr, r, all, true, 0, out.width) + 6;
  return out;
}

void draw(Canvas& c, const Results& r, const std::vector<Style>& all, const Layout& l) {
  bool band = false;
  for (std::size_t k = 0; k < r.study.quantities.size(); ++k) {
    const Panel panel(r, k, all, kLeft + static_cast<double>(k % l.columns) * (kLeft + kPlotWidth),
                      kTop + static_cast<double>(k / l.columns) * (kTop + kPlotHeight + kBottom));
    panel.draw(c);
    band = band || panel.has_band();
  }
  legend(&c, r, all, band, l.plots + 10, l.width);
}

}  // namespace

std::string figure_svg(const Results& r) {
  const std::vector<Style> all = styles(r);
  const Layout l = layout(r, all);
  SvgCanvas c(l.width, l.height);
  draw(c, r, all, l);
  return c.finished();
}

void write_figure_png(const Results& r, const std::string& path) {
  const std::vector<Style> all = styles(r);
  const Layout l = layout(r, all);
  PixelCanvas c(l.width, l.height, 2);
  draw(c, r, all, l);
  c.write(path);
}

}  // namespace mortise::study
