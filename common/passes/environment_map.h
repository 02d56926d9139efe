#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "gl/executor.h"
#include "passes/forward.h"

/// Environment maps (Blinn and Newell, "Texture and reflection in computer generated images", CACM 1976) on
/// cubes (Greene, "Environment mapping and other applications of world projections", IEEE CG&A 1986): the
/// light that arrives at one point, by direction, from then on taken for the light that arrives anywhere.
namespace quincunx {

struct EnvironmentParams {
    int size = 256;  ///< texels along an edge of a face, ≥ 1
    /// Of roughness: level k is for roughness k / (levels − 1), and 1 holds mirrors only. ≥ 1; more than
    /// there are down to 1×1 texel count as these.
    int levels = 6;
    int samples = 64;  ///< directions a texel of the rough levels, ≥ 1; taken up to a multiple of 4
    /// Each sample reads the level whose texels are as large as its share of the sphere, not the finest.
    bool filteredSamples = true;
    bool irradiance = true;  ///< make what environmentIrradiance reads
    GLenum format = GL_RGBA16F;
    bool operator==(const EnvironmentParams&) const = default;
};

/// What a map is rendered with.
struct EnvironmentView {
    glm::vec3 position{0};  ///< world space
    float nearDistance = 0.05f;
    float farDistance = 1000;
    glm::vec3 zenith{0};  ///< linear RGB behind everything, at +y …
    glm::vec3 nadir{0};   ///< … and at −y, evenly between by the direction's height
};

/// Draws what is around into the bound target's viewport, whose depth is clear and whose colour holds the
/// background.
using EnvironmentDraw = std::function<void(graph::PassContext&, const ForwardView&)>;

/// A face of the map as a view: 90° wide, up along the face's t, no background.
ForwardView environmentFaceView(const EnvironmentView& view, int face);

/// What environmentBrdf in shaders/lib/environment.glsl reads: for the view's cosine (columns, from 0 to 1)
/// and the roughness (rows, from 0 to 1) the directional albedo of GGX with Smith's height-correlated masking
/// (Heitz, JCGT 2014) and Schlick's Fresnel term, as scale and offset of the reflectance at normal incidence.
/// `samples` visible normals (Heitz, "Sampling the GGX distribution of visible normals", JCGT 2018) an entry;
/// cosines below 1e-3 count as that. RGBA, blue and alpha 0. With 128 samples each entry is within 0.004 of
/// the integral, with 32 entries a side the interpolated one within 0.02. Held by EnvironmentBrdf.*.
Image environmentBrdfTable(int size, int samples);

/// A map of what is around one point, prefiltered for rough and matt surfaces. All its light is linear, at
/// least 0, and finite.
class EnvironmentMap {
  public:
    /// Bindings that programs with lib/environment.glsl need, beside those they have.
    static void addBindings(gl::ProgramFiles& files);
    static constexpr GLuint radianceUnit = 8;
    static constexpr GLuint irradianceUnit = 9;
    static constexpr GLuint brdfUnit = 10;
    static constexpr GLuint blockBinding = 4;

    /// From a panorama: an equirectangular picture whose middle looks along +x, and whose top is +y. sRGB is
    /// decoded; negative values and what is not a number count as 0, more than 65504 as that. InputError for
    /// no pixels. `position`: where it was taken, for box projection.
    void fromPanorama(graph::PassContext& context, const Image& panorama, glm::vec3 position,
                      const EnvironmentParams& params);
    /// From two colours: zenith at +y, nadir at −y, evenly between by the direction's height.
    void fromGradient(graph::PassContext& context, glm::vec3 zenith, glm::vec3 nadir,
                      const EnvironmentParams& params);
    /// The same with the scene's background: its top is the zenith.
    void fromBackground(graph::PassContext& context, const Scene& scene, const EnvironmentParams& params);
    /// Drawn from a point, six views.
    void render(graph::PassContext& context, const EnvironmentView& view, const EnvironmentDraw& draw,
                const EnvironmentParams& params);
    /// From six images of params.size², four channels, row 0 at t = 0.
    void fromFaces(graph::PassContext& context, const std::vector<Image>& faces,
                   const EnvironmentParams& params);

    struct Lookup {
        /// A room whose walls are what the map shows, for environmentDirection; none: all is infinitely far.
        std::optional<Bounds> box = {};
        float strength = 1;    ///< what all light is multiplied with
        bool seamless = true;  ///< texels are blended across the edges of faces
    };
    /// For programs with lib/environment.glsl. The map has been made.
    void bind(const Lookup& lookup);
    void bind() { bind(Lookup{}); }

    bool isMade() const { return made_; }
    int levels() const { return params_.levels; }
    /// The prefiltered map; with one level that is the map as it was drawn.
    const gl::TextureCube& radiance() const { return params_.levels > 1 ? radiance_ : source_; }
    const gl::TextureCube& irradiance() const { return irradiance_; }
    glm::vec3 position() const { return position_; }
    /// Of all it keeps on the device.
    std::size_t bytes() const;
    /// Texels that were looked up to prefilter it, the last time it was made.
    std::uint64_t prefilterSamples() const;

  private:
    /// Makes textures and framebuffers where `params` asks for others than there are.
    void prepare(const EnvironmentParams& params);
    /// Prefilters what the source's first level holds.
    void finish(graph::PassContext& context);
    void drawGradient(graph::PassContext& context, int face, glm::vec3 zenith, glm::vec3 nadir);

    EnvironmentParams params_;
    bool made_ = false;
    glm::vec3 position_{0};
    gl::TextureCube source_;
    gl::TextureCube radiance_;
    gl::TextureCube irradiance_;
    gl::Texture2D depth_;
    gl::Texture2D brdf_;
    std::vector<gl::Framebuffer> sourceTargets_;      ///< by face
    std::vector<gl::Framebuffer> radianceTargets_;    ///< by face, from level 1 on
    std::vector<gl::Framebuffer> irradianceTargets_;  ///< by face
    std::optional<gl::Buffer> block_;
    std::vector<std::byte> sent_;  ///< what the block holds
};

/// Adds the pass in which `make` fills a map. Passes that use the map read the resource that is returned,
/// which holds nothing: it puts them in order, and where nobody reads it the map is not made.
graph::Resource addEnvironmentPass(graph::FrameGraph& graph, std::function<void(graph::PassContext&)> make,
                                   const char* name = "environment map");

}  // namespace quincunx
