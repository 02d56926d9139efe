#pragma once

#include <cstdint>

#include <glm/glm.hpp>

namespace quincunx {

/// How a frame is turned left about its own y, over and over.
enum class TurnUpdate {
    exact,        ///< `Orientation`: a unit quaternion in double
    rounded,      ///< `turned`: floats, orthonormal after each turn
    product,      ///< `turnedNaive`: a product of float matrices
    card,         ///< `turnLeftNaive`: the flashcard's update with x = y × z
    cardMirrored  ///< `turnLeftMirroredNaive`: the flashcard's update as it stands, x = z × y
};

/// How a frame that drifted is made orthonormal again.
enum class Renormalizer { gramSchmidt, newtonSchulz, nearest, duff };

struct DriftSettings {
    TurnUpdate update = TurnUpdate::exact;
    std::int64_t turns = 0;
    float epsilon = 0.01f;   ///< of a turn: the card's step, so an angle of atan ε for all updates
    std::int64_t every = 0;  ///< made orthonormal after so many turns; 0: never. For `product` and the cards.
    Renormalizer renormalizer = Renormalizer::gramSchmidt;

    bool operator==(const DriftSettings&) const = default;
};

/// The frame that the turns begin with: a car on a slope, so that no entry is 0 or 1.
glm::dmat3 slopingFrame();

/// worldFromBody after the turns, from `start` rounded to float (`exact`: from `start`).
glm::mat3 turnedOften(const DriftSettings& settings, const glm::dmat3& start);

/// The same in long double by one turn of turns · atan ε.
glm::dmat3 turnedExactly(const DriftSettings& settings, const glm::dmat3& start);

/// The largest entry of |RᵀR − I|.
double departureFromOrthonormal(const glm::mat3& r);
/// The largest entry of |a − b|.
double largestDifference(const glm::mat3& a, const glm::dmat3& b);

}  // namespace quincunx
