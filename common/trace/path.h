#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <glm/glm.hpp>

#include "trace/bsdf.h"
#include "trace/light_set.h"
#include "trace/sample_patterns.h"
#include "trace/trace_scene.h"

/// Path tracing: estimates of the rendering equation
///
///     Lo(x, ωo) = Le(x, ωo) + ∫ f(x, ωi, ωo) Li(x, ωi) |cos θi| dωi,   Li(x, ωi) = Lo(where the ray ends,
///     −ωi)
///
/// (Kajiya, "The rendering equation", SIGGRAPH 1986). Each function of this file is one such estimate of the
/// light that comes along a ray, in W/(m² sr) a channel; the mean over many samples tends to it. All are
/// without bias but for PathLimits::maxBounces. What is emitted leaves the front of a surface, and its back
/// where the material is double-sided; the environment shines from where no surface is. Surfaces that blend
/// let paths through by chance, and shadow rays by their share. No memory is taken for a ray. Held by
/// Path.*.
namespace quincunx {

/// How surfaces scatter that are neither glass (transmission of a half and more) nor all metal: by the
/// metallic-roughness numbers; by the base colour alone, evenly; or by the Phong numbers.
enum class OpaqueModel { metallicRoughness, lambert, phong, blinnPhong };

/// A scene ready for paths. What it refers to outlives it.
class PathScene {
  public:
    explicit PathScene(const TraceScene& scene, OpaqueModel model = OpaqueModel::metallicRoughness)
        : scene_(scene), lights_(scene), model_(model) {}

    const TraceScene& scene() const { return scene_; }
    const LightSet& lights() const { return lights_; }
    OpaqueModel model() const { return model_; }

  private:
    const TraceScene& scene_;
    LightSet lights_;
    OpaqueModel model_;
};

/// When paths end.
struct PathLimits {
    /// Surfaces that light is scattered at, most; the light that is lost beyond is the only bias. 0: emission
    /// alone, 1: direct light.
    int maxBounces = 1000;
    /// Russian roulette: a path whose weight (its largest channel, glass apart) is w goes on with the
    /// probability min(1, w / threshold), and then counts by as much more (Arvo, Kirk, "Particle transport
    /// and image synthesis", SIGGRAPH 1990). 1: paths end as light is absorbed; smaller: later; 0: never.
    /// Every survivor weighs at least the threshold, so that a channel's variance stays bounded for every
    /// albedo below 1.
    float rouletteThreshold = 1;
    /// The flashcard's way: paths below this weight are dropped, their light is lost. 0: none.
    float cutoff = 0;
};

/// What an estimate took.
struct PathCounts {
    static constexpr std::size_t levels = 16;
    std::array<std::uint64_t, levels> raysAtLevel{};  ///< 0: from the eye; the last: and all beyond
    std::uint64_t shadowRays = 0;
    TraversalCounts traversal;

    std::uint64_t rays() const;
    PathCounts& operator+=(const PathCounts& other);
};

/// A surface point that a path has come to, ready to scatter.
struct PathVertex {
    SurfacePoint point;
    Bsdf bsdf;
    glm::mat3 worldFromLocal{
        1};  ///< z: the shading normal; on the side of wo unless the material lets light through
    glm::vec3 wo{0, 0, 1};  ///< local: where the path came from
    glm::vec3 emitted{0};   ///< towards wo

    glm::vec3 toLocal(glm::vec3 world) const { return world * worldFromLocal; }
};

/// Where a ray ends; nothing where it leaves the scene. A surface that blends ends it with the probability of
/// its alpha, to 2^-24, by numbers of the sampler; without one, always.
std::optional<PathVertex> meet(const PathScene& scene, const Ray& ray, PathSampler* sampler = nullptr,
                               PathCounts* counts = nullptr);

/// A direction drawn by the BSDF at a vertex.
struct Scattered {
    Ray ray;              ///< leaves the surface
    glm::vec3 weight{0};  ///< f |cos| / density
    float density = 0;    ///< as BsdfSample::density
    bool delta = false;
    /// What radiance is squeezed by where it enters glass: the square of the index. It spreads again where it
    /// leaves, so that it says nothing about what a path is worth, and roulette leaves it out.
    float squeeze = 1;
};
/// Nothing where the light is absorbed, and where the shading normal's answer leads through a surface that
/// the real one does not let it through.
std::optional<Scattered> scatter(const PathVertex& vertex, PathSampler& sampler);

/// Light from a light that is drawn, less what stands before it.
struct DirectLight {
    glm::vec3 light{0};      ///< f |cos| L / density
    float lightDensity = 0;  ///< of having drawn this direction; 0 of lights without extent
    float bsdfDensity = 0;   ///< that `scatter` would have had for it
};
std::optional<DirectLight> drawDirectLight(const PathScene& scene, const PathVertex& vertex,
                                           PathSampler& sampler, PathCounts* counts = nullptr);

/// Light is found by chance: the path scatters by the BSDF until it ends, and counts what shines where it
/// comes by. Lights without extent (points, spots, the sun) are never met, so they are dark here.
glm::vec3 tracePathNaive(const PathScene& scene, Ray ray, PathSampler& sampler, const PathLimits& limits = {},
                         PathCounts* counts = nullptr);

/// Next event estimation: at every surface one shadow ray to a random place on a light; what shines counts
/// by chance only where a shadow ray could not have found it.
glm::vec3 tracePathNee(const PathScene& scene, Ray ray, PathSampler& sampler, const PathLimits& limits = {},
                       PathCounts* counts = nullptr);

/// Both, each weighted by how well it finds that light: multiple importance sampling by the power heuristic
/// (Veach, Guibas, "Optimally combining sampling techniques for Monte Carlo rendering", SIGGRAPH 1995).
glm::vec3 tracePathMis(const PathScene& scene, Ray ray, PathSampler& sampler, const PathLimits& limits = {},
                       PathCounts* counts = nullptr);

/// Distribution ray tracing (Cook, Porter, Carpenter, SIGGRAPH 1984): at every surface `branches` rays go on,
/// each with a shadow ray, so that their number grows by that factor a level, down to limits.maxBounces.
glm::vec3 traceTree(const PathScene& scene, const Ray& ray, PathSampler& sampler, int branches,
                    const PathLimits& limits, PathCounts* counts = nullptr);

enum class PathMethod { naive, nee, mis };
/// The function of that name.
glm::vec3 tracePath(PathMethod method, const PathScene& scene, const Ray& ray, PathSampler& sampler,
                    const PathLimits& limits = {}, PathCounts* counts = nullptr);

/// The rendering equation at one point, term by term.
struct EquationTerms {
    glm::vec3 emitted{0};
    glm::vec3 direct{0};       ///< light that comes straight from lights, scattered once here
    glm::vec3 indirect{0};     ///< light that has been scattered elsewhere before
    glm::vec3 directError{0};  ///< standard errors
    glm::vec3 indirectError{0};

    glm::vec3 sum() const { return emitted + direct + indirect; }
};
/// Each term by draws of its own where the ray ends; only `direct`, the environment, where it leaves the
/// scene. The same bits for as many draws, however they are shared out among calls.
class TermEstimate {
  public:
    /// `scene` outlives it.
    TermEstimate(const PathScene& scene, const Ray& ray, std::uint64_t seed, const PathLimits& limits = {});

    void add(int samples);
    int samples() const { return samples_; }
    EquationTerms terms() const;  ///< errors are infinite below two samples

  private:
    /// A mean and its standard error, by Welford's sums.
    class Mean {
      public:
        void add(glm::dvec3 value);
        glm::vec3 mean() const { return glm::vec3(mean_); }
        glm::vec3 error() const;

      private:
        double count_ = 0;
        glm::dvec3 mean_{0};
        glm::dvec3 squares_{0};
    };

    const PathScene& scene_;
    std::optional<PathVertex> vertex_;
    glm::vec3 beyond_;
    std::uint64_t seed_;
    PathLimits limits_;
    int samples_ = 0;
    Mean direct_;
    Mean indirect_;
};
/// The same by `samples` (≥ 2) draws.
EquationTerms estimateTerms(const PathScene& scene, const Ray& ray, int samples, std::uint64_t seed,
                            const PathLimits& limits = {});

/// What OpenGL's MaterialPass draws with shadows, seen along a ray: the lights of Scene::lights, with sharp
/// shadows, ambient light and emission, by the arithmetic of shaders/lib/brdf.glsl; nothing where the ray
/// leaves the scene. Not an estimate: no sampling.
std::optional<glm::vec3> traceDirect(const TraceScene& scene, const Ray& ray);

}  // namespace quincunx
