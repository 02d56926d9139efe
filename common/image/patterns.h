#pragma once

#include <cstdint>
#include <vector>

#include "image/image.h"

/// Textures from code. Each is width × height texels of RGB, sRGB-encoded, repeats without a seam unless it
/// says otherwise, and is antialiased: a texel is the mean of what it covers, in linear light.
namespace quincunx {

/// `across` × `down` squares, alternately light and dark, the top left one light; both even to repeat.
Image8 checkerTexture(int width, int height, int across, int down);
/// cos(π r² f / side) about the centre: rings that are ever closer, at the middle of an edge `f` of the
/// highest frequency that the texels can hold. Does not repeat.
Image8 zonePlateTexture(int side, double frequency = 1);
/// Running bond with mortar: `rows`, even, of bricks twice as long as high.
Image8 brickTexture(int side, int rows, std::uint64_t seed);
/// Planks with grain and growth rings along t.
Image8 woodTexture(int side, std::uint64_t seed);
/// Sum of octaves of gradient noise (Perlin: An image synthesizer, SIGGRAPH 1985), in greys with a warm cast.
Image8 noiseTexture(int side, std::uint64_t seed);

/// A sum of cosines with whole numbers of periods over the texture, all below half its sides: band-limited,
/// and known at every point. One channel, linear.
class WavePicture {
  public:
    /// Waves of random directions and phases with at most `share` < 1 of the highest frequency that `side`
    /// texels can hold; values within 0…1.
    WavePicture(int side, double share, std::uint64_t seed);
    double at(double s, double t) const;
    /// Its values at the centres of side × side texels.
    Image texels() const;

  private:
    struct Wave {
        int across = 0;  ///< periods
        int down = 0;
        double phase = 0;
        double amplitude = 0;
    };
    int side_;
    std::vector<Wave> waves_;
};

}  // namespace quincunx
