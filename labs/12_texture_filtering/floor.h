#pragma once

#include <algorithm>
#include <atomic>

#include <glm/glm.hpp>

#include "image/texture_unit.h"
#include "scene/scene.h"

namespace quincunx {

/// The plane y = 0 under a texture, seen by a camera: for each pixel the place on the texture, its exact
/// derivatives, and the haze before it. Pixels are counted as OpenGL does, from the bottom left.
/// shaders/labs/12_texture_filtering/floor.frag has the same formulas in float.
class FloorView {
  public:
    /// `repeats`: of the texture along a unit of the world.
    FloorView(const Camera& camera, int width, int height, double repeats);

    struct Place {
        bool floor = false;  ///< else sky
        glm::dvec2 st{0};
        glm::dvec2 alongX{0};   ///< ∂(s,t) for a pixel to the right
        glm::dvec2 alongY{0};   ///< … and up
        double visibility = 0;  ///< how much of the floor's light comes through the haze
        TexturePoint point() const { return {glm::vec2(st), glm::vec2(alongX), glm::vec2(alongY)}; }
    };
    Place at(glm::dvec2 pixel) const;
    /// What is seen at a pixel of a texture's colour there.
    glm::dvec3 color(const Place& place, glm::dvec2 pixel, glm::dvec3 texture) const;

    const glm::dmat3& rayFromPixel() const { return rayFromPixel_; }
    glm::dvec3 eye() const { return eye_; }
    double repeats() const { return repeats_; }
    int width() const { return width_; }
    int height() const { return height_; }

  private:
    glm::dmat3 rayFromPixel_{1};
    glm::dvec3 eye_{0};
    double repeats_ = 1;
    int width_ = 1;
    int height_ = 1;
};

/// Distance in which haze takes all but 1/e of the floor's light.
inline constexpr double hazeDistance = 45;
inline const glm::dvec3 horizonColor(0.62, 0.66, 0.70);  ///< linear RGB
inline const glm::dvec3 zenithColor(0.16, 0.27, 0.45);

/// The floor by the CPU's texture unit, one sample a pixel. RGBA, linear, top row first.
Image floorPicture(const MipTexture& texture, const SamplerSettings& settings, const FloorView& view);

/// The mean over each pixel's square, by side × side samples of the finest level under bilinear
/// magnification, one at a random place of each cell (the same for the same seed): what minification filters
/// try to be. Where `stop` becomes true, the remaining rows are left at zero.
Image floorReference(const MipTexture& texture, TextureWrap wrap, const FloorView& view, int side,
                     const std::atomic<bool>& stop, std::uint64_t seed = 1);

/// Texels that the picture reads, and probes of its anisotropic filter.
struct FloorCounts {
    std::uint64_t texels = 0;
    std::uint64_t probes = 0;
    std::uint64_t samples = 0;  ///< pixels that show floor
    int mostTexels = 0;         ///< for one pixel

    FloorCounts& operator+=(const FloorCounts& other) {
        texels += other.texels;
        probes += other.probes;
        samples += other.samples;
        mostTexels = std::max(mostTexels, other.mostTexels);
        return *this;
    }
};
FloorCounts countFloor(const MipTexture& texture, const SamplerSettings& settings, const FloorView& view);

}  // namespace quincunx
