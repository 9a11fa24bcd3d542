#include <fmt/format.h>

#include "render/font.h"
#include "study/canvas.h"

namespace mortise::study {
namespace {

std::string hex(Colour c) { return fmt::format("#{:02x}{:02x}{:02x}", c.r, c.g, c.b); }

std::string places(const std::vector<Place2>& points) {
  std::string out;
  for (const auto& [x, y] : points) out += fmt::format("{}{:.1f},{:.1f}", out.empty() ? "" : " ", x, y);
  return out;
}

std::string pen(const Stroke& s) {
  std::string out = fmt::format(" stroke=\"{}\" stroke-width=\"{:g}\"", hex(s.colour), s.width);
  if (s.opacity < 1) out += fmt::format(" stroke-opacity=\"{:g}\"", s.opacity);
  for (std::size_t i = 0; i < s.dashes.size(); ++i) out += (i == 0 ? " stroke-dasharray=\"" : " ") + fmt::format("{:g}", s.dashes[i]);
  return s.dashes.empty() ? out : out + "\"";
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (char c : text) out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
  return out;
}

double text_width(const std::string& text, double size) { return render::text_width(text, size * 1.17); }

SvgCanvas::SvgCanvas(double width, double height)
    : svg_(fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 {0:g} {1:g}\" "
                       "font-family=\"DejaVu Sans, Verdana, sans-serif\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
                       width, height)) {}

void SvgCanvas::line(const std::vector<Place2>& points, const Stroke& stroke) {
  if (points.size() > 1) svg_ += "<polyline points=\"" + places(points) + "\" fill=\"none\" stroke-linejoin=\"round\"" + pen(stroke) + "/>\n";
}

void SvgCanvas::shape(const std::vector<Place2>& corners, Colour fill, double opacity, const Stroke* edge, const std::string& tip) {
  svg_ += "<polygon points=\"" + places(corners) + "\" fill=\"" + hex(fill) + "\"";
  if (opacity < 1) svg_ += fmt::format(" fill-opacity=\"{:g}\"", opacity);
  if (edge) svg_ += pen(*edge);
  svg_ += tip.empty() ? "/>\n" : "><title>" + escaped(tip) + "</title></polygon>\n";
}

void SvgCanvas::text(Place2 at, const std::string& text, double size, Anchor anchor, Colour colour, bool upwards, bool bold) {
  const char* names[] = {"start", "middle", "end"};
  svg_ += fmt::format("<text x=\"{0:.1f}\" y=\"{1:.1f}\" font-size=\"{2:g}\" text-anchor=\"{3}\" fill=\"{4}\"{5}{6}>{7}</text>\n", at.first,
                      at.second, size, names[static_cast<int>(anchor)], hex(colour),
                      upwards ? fmt::format(" transform=\"rotate(-90 {:.1f} {:.1f})\"", at.first, at.second) : "",
                      bold ? " font-weight=\"bold\"" : "", escaped(text));
}

}  // namespace mortise::study
