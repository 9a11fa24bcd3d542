#pragma once
#include <array>
#include <cstdint>

namespace mortise::render {

// 256 sRGB colours from the lowest to the highest value of a range.
using ColourMap = std::array<std::uint8_t, 256 * 3>;

// Equal steps of value are equal steps of lightness in OKLab (Ottosson, "A perceptual color space for image processing",
// 2020), with the hue running indigo - magenta - orange - pale yellow. The first entry is a neutral dark grey, so that
// "nothing here" cannot be taken for "a little".
ColourMap sequential_map();

// Blue - neutral grey - orange for ranges that straddle zero; the grey sits at `zero`, the share of the range below zero.
ColourMap diverging_map(double zero);

// The map that suits the range [low, high]: diverging where zero lies inside.
ColourMap map_for(double low, double high);

// sRGB value in 0..1 -> linear.
double linear_of_srgb(double c);

}  // namespace mortise::render
