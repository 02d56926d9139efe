#pragma once

#include <optional>
#include <string>
#include <vector>

#include "image/image.h"

/// How a picture that was handed in lies over the reference. Screenshots come scaled, cropped, in a window's
/// border, through another gamma: that is found out and told, so that what is compared is the drawing.
namespace quincunx::grade {

/// What a picture can be besides right or wrong.
enum class Handling { blank, bordered, cropped, shifted, scaled, mirrored, swappedChannels, gamma };
/// "blank", "bordered" …, the names in rubrics and reports.
std::string_view handlingName(Handling handling);
std::optional<Handling> parseHandling(std::string_view name);
inline constexpr int handlingCount = 8;

struct Finding {
    Handling handling = Handling::blank;
    std::string text;  ///< "cropped: the picture lacks 1 column on the left"
};

/// The two pictures where they overlap: the same size, RGB, the submitted one with what was found undone.
struct Alignment {
    Image8 reference;
    Image8 submitted;
    int left = 0;  ///< of the overlap in the whole reference, pixels
    int top = 0;
    std::vector<Finding> findings;

    bool has(Handling handling) const;
};

/// Looks, in this order, for: no picture at all (all pixels nearly one colour), another size (a border
/// around, some rows or columns cut off, another scale), a mirrored picture, exchanged channels, a shift by
/// up to six pixels, and a power curve. Each is taken as found only if undoing it removes most of the
/// difference, so that a wrong picture stays as it is. The pictures have 1 to 4 channels; alpha is left out.
/// Of different sizes whose sides differ by more than 8 pixels the submitted one is brought to the
/// reference's size.
Alignment align(const Image8& reference, const Image8& submitted);

/// RGB codes: grey spread, alpha left out.
Image8 rgbOf(const Image8& image);

/// The picture at another size: means of the area that a pixel covers, bilinear where it grows; of codes.
Image8 resized(const Image8& image, int width, int height);

/// A rectangle of it; must lie inside.
Image8 cropped(const Image8& image, int left, int top, int width, int height);

}  // namespace quincunx::grade
