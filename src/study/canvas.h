#pragma once
// A sheet that figures are drawn on, as SVG or as pixels, so that both show the same.
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace mortise::study {

struct Colour {
  std::uint8_t r = 0, g = 0, b = 0;
};
using Place2 = std::pair<double, double>;  // pixels from the upper left corner

struct Stroke {
  Colour colour;
  double width = 1, opacity = 1;
  std::vector<double> dashes{};  // lengths on and off; none: solid
};

enum class Anchor { start, middle, end };

class Canvas {
 public:
  virtual ~Canvas() = default;
  virtual void line(const std::vector<Place2>& points, const Stroke& stroke) = 0;
  // Convex and closed; `tip`: what a reader sees who points at it.
  virtual void shape(const std::vector<Place2>& corners, Colour fill, double opacity, const Stroke* edge, const std::string& tip) = 0;
  virtual void text(Place2 at, const std::string& text, double size, Anchor anchor, Colour colour, bool upwards = false, bool bold = false) = 0;
};

double text_width(const std::string& text, double size);  // in DejaVu Sans [pixels]

class SvgCanvas : public Canvas {
 public:
  SvgCanvas(double width, double height);
  void line(const std::vector<Place2>& points, const Stroke& stroke) override;
  void shape(const std::vector<Place2>& corners, Colour fill, double opacity, const Stroke* edge, const std::string& tip) override;
  void text(Place2 at, const std::string& text, double size, Anchor anchor, Colour colour, bool upwards, bool bold) override;
  std::string finished() const { return svg_ + "</svg>\n"; }

 private:
  std::string svg_;
};

// Pixels: `zoom` of them per unit of the sheet.
class PixelCanvas : public Canvas {
 public:
  PixelCanvas(double width, double height, double zoom);
  ~PixelCanvas() override;
  void line(const std::vector<Place2>& points, const Stroke& stroke) override;
  void shape(const std::vector<Place2>& corners, Colour fill, double opacity, const Stroke* edge, const std::string& tip) override;
  void text(Place2 at, const std::string& text, double size, Anchor anchor, Colour colour, bool upwards, bool bold) override;
  void write(const std::string& path) const;  // PNG; throws Error(Exit::file)

 private:
  struct Sheet;
  Sheet* sheet_;
  double zoom_;
};

std::string escaped(const std::string& text);  // for XML and HTML

}  // namespace mortise::study
