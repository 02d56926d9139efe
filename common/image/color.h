#pragma once

#include <array>
#include <cstdint>

#include "image/image.h"

/// The sRGB transfer curve (IEC 61966-2-1, amendment 1) and what is computed from linear light.
namespace quincunx {

/// Encoded value of a linear one; both 0…1. Below 0 and NaN give 0, above 1 gives 1. Within ½ ulp (rounded
/// from double). Monotone except one step of 3e-9 at 0.0031308, which the standard's own constants have.
float srgbFromLinear(float linear);

/// Linear value of an encoded one; the same domain, error and treatment of NaN as `srgbFromLinear`.
float linearFromSrgb(float encoded);

/// The code 0…255 nearest to 255 · srgbFromLinear(linear): exact, by the 255 floats where the code changes.
/// Below 0 and NaN give 0, above 1 gives 255. All 256 codes survive `linearOfCode` and back.
std::uint8_t srgbCode(float linear);

/// Linear values of the 256 sRGB codes.
const std::array<float, 256>& linearOfCode();

/// Luminance of linear RGB with sRGB primaries and white D65: the row Y of IEC 61966-2-1, rounded there to
/// four digits that sum to 1. White is exactly 1 in double.
inline constexpr std::array<double, 3> luminanceWeights = {0.2126, 0.7152, 0.0722};

/// Luma of encoded R'G'B' by ITU-R BT.601, as image metrics use it; the weights sum to 1.
inline constexpr std::array<double, 3> lumaWeights = {0.299, 0.587, 0.114};

/// Linear values 0…1 of all channels; alpha (the last of 2 or 4 channels) is never decoded.
Image toLinear(const Image8& image);

/// Linear values; an image that is linear already is returned as it is (values beyond 0…1 and NaN kept).
Image toLinear(Image image);

/// 8-bit sRGB codes of linear values, or of values that are sRGB-encoded already; nearest, halves up. Below 0
/// and NaN give 0, above 1 gives 255. Alpha is rounded without the curve.
Image8 toSrgb8(const Image& image);

}  // namespace quincunx
