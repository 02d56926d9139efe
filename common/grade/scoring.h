#pragma once

#include <string>
#include <vector>

#include "grade/alignment.h"
#include "grade/rubric.h"
#include "image/image.h"

namespace quincunx::grade {

/// What a picture is held against.
struct Reference {
    Image8 picture;               ///< as it should be
    std::vector<Image8> without;  ///< by the rubric's properties; empty for those that are no effects
};

/// A property as it was measured.
struct Score {
    std::string name;
    double figure = 0;
    double points = 0;
    double of = 0;       ///< points there were; 0 if the property could not be seen in this picture
    std::string reason;  ///< why points were lost; empty: none were
};

/// A share of the points that is left, and why.
struct Limit {
    double share = 1;
    std::string reason;
};

struct Result {
    std::vector<Score> scores;
    std::vector<Limit> limits;
    std::vector<std::string> remarks;  ///< what was noticed, without cost
    Image8 reference;                  ///< the two pictures as they were compared, and
    Image8 submitted;
    Image errors;  ///< the ꟻLIP error of each pixel

    double points() const;  ///< what the least of the limits leaves of the sum
    double of() const;
};

/// The share of an effect that a picture shows where pictures with and without it differ by 6 codes or more
/// in a channel: 1 − Σ|picture − with|² / Σ|without − with|², over the codes of those pixels. 1: as in
/// `with`; 0: as far from it as if there were none; less for what is wrong besides. None where fewer than a
/// thousandth of the pixels differ. All three are RGB and of one size.
std::optional<double> effectShare(const Image8& with, const Image8& without, const Image8& picture);

/// The share of the pixels where an effect shows, as `effectShare` has it.
double effectArea(const Image8& with, const Image8& without);

/// Aligns and measures a screenshot. `reference` has as many entries of `without` as the rubric has
/// properties.
Result scoreScreenshot(const Reference& reference, const Image8& submitted, const Rubric& rubric);

/// The same for pictures that were drawn here, by these properties: nothing is aligned.
Result scoreDrawn(const Reference& reference, const Image8& submitted,
                  const std::vector<Property>& properties);

}  // namespace quincunx::grade
