#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "image/image.h"
#include "image/mipmaps.h"

/// A texture unit on the CPU: what OpenGL 3.3 core says of sampling (sections 3.8.11, 3.8.12), in double and
/// rounded once, and the filters that hardware leaves out. Texture coordinates (s, t): the finest level
/// spans 0…1 in each, its row 0 is at t = 0; a texel's centre is at (i + ½) / side. Coordinates that are not
/// finite count as 0. Results are finite for finite texels.
namespace quincunx {

/// What is found beyond 0…1.
enum class TextureWrap { repeat, mirroredRepeat, clampToEdge, clampToBorder };

/// The texel that number `texel` of an endless row of texels means: 0 … side − 1, or −1 for the border.
/// `texel` is whole; exact for every finite one, whatever its size (section 3.8.11, the table of wrap modes).
int wrapTexel(double texel, int side, TextureWrap wrap);

/// The texel at a coordinate: that of ⌊s · side⌋, exactly.
int nearestTexel(float coordinate, int side, TextureWrap wrap);
/// The textbook's REPEAT in float: int((s − ⌊s⌋) · side). Not kept within the texture.
int nearestTexelNaive(float coordinate, int side);

/// The two texels around a coordinate, and how much the second one counts, within 2⁻⁵². Where texels repeat,
/// that holds for every finite coordinate; where they are clamped, all that lies beyond the edge is the edge.
struct LinearTexels {
    int first = 0;
    int second = 0;
    double share = 0;  ///< of the second: [0, 1)
};
LinearTexels linearTexels(float coordinate, int side, TextureWrap wrap);

/// (1 − t) a + t b for t in [0, 1], in double and rounded once: exact at 0 and 1 and for a = b, never beyond
/// a and b, monotone in t, never overflowing, within 0.5000001 ulp of the larger of |a| and |b|. As t b is
/// exact in double, and (1 − t) a and the sum are off by 2⁻⁵³ each, the rounding to float hides both.
/// Held by TextureHardCases.
inline float lerp(float a, float b, float t) {
    return static_cast<float>((1 - static_cast<double>(t)) * a + static_cast<double>(t) * b);
}
/// a + t (b − a) in float.
inline float lerpNaive(float a, float b, float t) {
    return a + t * (b - a);
}

/// A place on a texture and how it moves from pixel to pixel.
struct TexturePoint {
    glm::vec2 st{0};
    glm::vec2 alongX{0};  ///< ∂(s,t)/∂x, a pixel to the right
    glm::vec2 alongY{0};  ///< ∂(s,t)/∂y
};

/// λ of section 3.8.11: log₂ of the longer of the two derivatives in texels of level 0, plus `bias`, within
/// −1000 … 1000, in which −1000 stands for derivatives of 0. A derivative with a NaN counts as 0, an infinite
/// one gives 1000. Error: 1e-13.
double levelOfDetail(const TexturePoint& point, int width, int height, double bias = 0);
/// log₂ of the longer length, in float.
float levelOfDetailNaive(const TexturePoint& point, int width, int height);
/// λ kept within the levels: 0 … levels − 1.
double clampedLevel(double lambda, int levels);

/// How a texture is sampled where it is made smaller. `bilinear` and `nearest` read level 0 only; the names
/// with "mipmap" the one level that is nearest to λ; the others blend two levels.
enum class Minification {
    nearest,
    bilinear,
    nearestMipmap,
    bilinearMipmap,
    nearestBlended,  ///< GL_NEAREST_MIPMAP_LINEAR
    trilinear,
    anisotropic  ///< trilinear probes along the long axis of the footprint
};

/// … and where it is made larger. The wide ones are separable, their weights brought to a sum of 1.
enum class Magnification {
    nearest,   ///< a box as wide as a texel
    bilinear,  ///< a tent
    mitchell,  ///< the cubic with B = C = ⅓ (Mitchell, Netravali: Reconstruction filters, SIGGRAPH 1988): 4×4
    lanczos,  ///< a windowed sinc of `lobes` lobes: (2 lobes)²
    sinc      ///< the whole sinc: every texel. Repeated textures go on for ever, and so does the sum: its
              ///< closed form is Dirichlet's kernel. Others are continued as if mirrored.
};

struct SamplerSettings {
    TextureWrap wrapS = TextureWrap::repeat;
    TextureWrap wrapT = TextureWrap::repeat;
    Minification minification = Minification::trilinear;
    Magnification magnification = Magnification::bilinear;
    int maxAnisotropy = 16;  ///< probes, ≥ 1
    int lobes = 3;           ///< of Lanczos, ≥ 1
    double lodBias = 0;
    double minLod = -1000;
    double maxLod = 1000;
    glm::vec4 border{0};
};

/// A texture with its mipmaps, as linear light: what sampling reads.
class MipTexture {
  public:
    MipTexture() = default;
    /// Level 0 first. sRGB is decoded; grey becomes RGB, a missing alpha 1. A level of another size than its
    /// place asks for, or an empty one, leaves the texture incomplete; fewer levels than a full chain do not.
    explicit MipTexture(std::span<const Image8> levels);
    explicit MipTexture(std::vector<Image> levels);
    /// With the levels that makeMipmaps makes.
    MipTexture(const Image8& base, const MipmapParams& params);

    bool complete() const { return complete_; }
    int levels() const { return static_cast<int>(levels_.size()); }
    int width(int level = 0) const { return levels_[static_cast<std::size_t>(level)].width; }
    int height(int level = 0) const { return levels_[static_cast<std::size_t>(level)].height; }
    const Image& level(int level) const { return levels_[static_cast<std::size_t>(level)]; }

  private:
    void check();
    std::vector<Image> levels_;
    bool complete_ = false;
};

struct TextureSample {
    glm::vec4 color{0, 0, 0, 1};
    int texels = 0;  ///< read, the border included
};

/// The value at a point by its derivatives. An incomplete texture gives (0, 0, 0, 1) and reads nothing, as
/// section 3.9.2 has it.
TextureSample sampleTexture(const MipTexture& texture, const SamplerSettings& settings,
                            const TexturePoint& point);
/// The value at a given λ, as GLSL's textureLod. `anisotropic` is trilinear here: λ has no direction.
TextureSample sampleTextureLod(const MipTexture& texture, const SamplerSettings& settings, glm::vec2 st,
                               double lambda);
/// The trilinear value by the textbook in float: the logarithm unguarded, indices by fract.
glm::vec4 sampleTrilinearNaive(const MipTexture& texture, const TexturePoint& point);

/// One of the texels that a value is made of.
struct TexelTap {
    int level = 0;
    int x = 0;  ///< −1: the border
    int y = 0;
    double weight = 0;
};
/// All of them, for display: their weights sum to 1. A texel may occur more than once.
std::vector<TexelTap> texelTaps(const MipTexture& texture, const SamplerSettings& settings,
                                const TexturePoint& point);

/// The parallelogram that a pixel covers on the texture, as the ellipse inside it, and how the anisotropic
/// filter covers that: `probes` trilinear samples in a row along the long axis, all at level λ, each of
/// weight 1 / probes.
struct Footprint {
    glm::dvec2 longAxis{0};  ///< in (s, t): the whole long axis; singular vector of the derivatives
    double longTexels = 0;   ///< its length in texels of level 0
    double shortTexels = 0;  ///< of the other
    int probes = 1;          ///< 1 … maxAnisotropy
    double lambda = -1000;  ///< log₂ of the short axis, or of what the probes must cover if they are too few

    /// Where probe `i` is.
    glm::dvec2 probe(int i, glm::dvec2 centre) const {
        return centre + ((i + 0.5) / probes - 0.5) * longAxis;
    }
};
/// Feline-like (McCormack, Perry, Farkas, Jouppi, SIGGRAPH 1999) with evenly weighted probes; the count as
/// EXT_texture_filter_anisotropic: ⌈long / short⌉, at most `maxAnisotropy`. Nothing is gained by probes less
/// than a texel apart, so the short axis counts as a texel at least, and a footprint without an area, or one
/// that is not finite, gets one probe at `levelOfDetail`. Both axes are within 1e-15, relative, where their
/// derivatives are finite.
Footprint footprintOf(const TexturePoint& point, int width, int height, int maxAnisotropy, double bias = 0);

/// The long and the short axis by the textbook's eigenvalues in float, which cancel.
glm::vec2 footprintAxesNaive(const TexturePoint& point, int width, int height);

/// The weight of a texel whose centre is `distance` texels away, before weights are brought to a sum of 1.
double filterWeight(Magnification filter, double distance, int lobes);
/// sin(πx) / (πx) as it stands, in float.
float sincNaive(float x);
/// Within 4e-16, by reducing x before the sine: exact zeros at whole numbers, 1 at 0.
double sinc(double x);
/// Σ over all k of sinc(x − k period), whole `period` ≥ 1: sin(πx) / (period tan(πx / period)) for an even
/// one, the sine in place of the tangent for an odd one; 1 at multiples of the period. Within 1e-15.
double periodicSinc(double x, int period);
/// The closed form as it stands, in float.
float periodicSincNaive(float x, int period);

/// What one texel of an enlarged line is made of.
struct LineTap {
    int texel = 0;  ///< −1: the border
    double weight = 0;
};
/// The texels around `position` (in texels from the line's beginning, a texel's centre at i + ½) with their
/// weights, whose sum is 1; `taps` is emptied first.
void lineTaps(Magnification filter, int lobes, double position, int side, TextureWrap wrap,
              std::vector<LineTap>& taps);

/// A part of a texture's finest level: from (s, t) = `low` to `high`.
struct TextureWindow {
    glm::dvec2 low{0};
    glm::dvec2 high{1};
};
/// The window at width × height pixels, each the value at its centre, by rows and then by columns: the same
/// as sampling each pixel with `settings.magnification`, but for rounding (tests: 1e-6), and far cheaper.
Image enlarge(const MipTexture& texture, const SamplerSettings& settings, const TextureWindow& window,
              int width, int height);

}  // namespace quincunx
