#pragma once

#include <optional>
#include <vector>

#include "image/image.h"

/// Mipmaps: a texture at halved sizes down to 1×1, each texel standing for what it covers of level 0.
/// Williams: Pyramidal parametrics, SIGGRAPH 1983.
namespace quincunx {

/// Levels of a full chain: ⌊log₂ of the longer side⌋ + 1, exact for every side ≥ 1.
int mipLevelCount(int width, int height);
/// The same by the textbook's logarithm of a float.
int mipLevelCountNaive(int width, int height);

/// Texels along a side of level `level` (OpenGL 3.3 core, section 3.8.11: halved and rounded down, at least
/// 1).
inline int mipSide(int baseSide, int level) {
    return level < 31 && baseSide >> level > 1 ? baseSide >> level : 1;
}

/// How the texels of a level are made from the level above.
enum class MipFilter {
    box,     ///< the mean of the texels that a texel covers: 2×2, with shares of a third row or column where
             ///< the side is odd (Guthe, Heckbert: Non-power-of-two mipmap creation, NVIDIA 2005)
    kaiser,  ///< sinc under a Kaiser window, α = 4, three lobes a side
    lanczos  ///< sinc under the middle lobe of another three times as wide
};

struct MipmapParams {
    MipFilter filter = MipFilter::box;
    bool linearLight = true;  ///< sRGB is decoded before and encoded after; false: the codes are averaged
    bool repeats = false;     ///< wide filters go on at the other edge; else with the texels of the edge
    /// Levels keep the share of texels whose alpha is at least this, by scaling alpha (Castaño: Computing
    /// alpha mipmaps, 2010), exactly up to ties and to what a level's count of texels can express. For 2 or 4
    /// channels.
    std::optional<float> coverageCutoff = {};
};

/// The levels below `base`: element i is level i + 1. Levels are made from one another as floats and
/// rounded once each, so that no error of rounding piles up: with `box`, each level's mean is the base's
/// within half a code, and so is the texel of the last one (MipChain.*). 1 to 4 channels.
std::vector<Image8> makeMipmaps(const Image8& base, const MipmapParams& params = {});
/// The same of floats; wide filters may give values beyond those of the base. Means are kept to 1e-6 of the
/// largest value. An sRGB-encoded image gives sRGB-encoded levels.
std::vector<Image> makeMipmaps(const Image& base, const MipmapParams& params = {});

/// The textbook's chain: each texel the mean of 2×2 codes, cut off to a whole code; of an odd side the last
/// texel is left out.
std::vector<Image8> makeMipmapsNaive(const Image8& base);

/// The image, halved by the box filter until no side exceeds `mostTexels` ≥ 1.
Image8 reducedToSide(const Image8& image, int mostTexels);

}  // namespace quincunx
