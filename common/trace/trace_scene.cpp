#include "trace/trace_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <variant>

#include "base/check.h"
#include "geometry/normals.h"
#include "geometry/ray_shapes.h"
#include "geometry/tangent_frames.h"
#include "math/transform.h"
#include "math/vector.h"
#include "trace/box_tree.h"
#include "trace/texture_lookup.h"

namespace quincunx {
namespace {

using glm::dmat3;
using glm::dmat4;
using glm::dvec3;
using glm::dvec4;

/// Meshes up to this size are flattened even where they are used again: a structure of their own, and a ray
/// carried into their frame, cost more than their triangles.
constexpr std::size_t smallMesh = 256;

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// Half an ulp, relative, and what double arithmetic before the rounding adds to it.
constexpr float halfUlp = 0x1.0001p-24f;

dmat3 absolute(const dmat3& m) {
    return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])};
}

bool isFiniteMatrix(const glm::mat4& m) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!std::isfinite(m[column][row]))
                return false;
    return true;
}

/// Numbers that shading may rely on.
float sane(float value, float most = std::numeric_limits<float>::max()) {
    return value > 0 ? std::min(value, most) : 0;
}
glm::vec3 sane(glm::vec3 v, float most) {
    return {sane(v.x, most), sane(v.y, most), sane(v.z, most)};
}
/// The brightest that anything is, a channel: sums of products of a few of them stay finite.
constexpr float brightest = 1e18f;

/// A placement that rays are carried through.
struct Frame {
    dmat4 worldFromModel{1};
    dmat4 modelFromWorld{1};
    dmat3 spread{1};  ///< |worldFromModel|, entry by entry
    glm::mat3 normalFromModel{1};
    bool mirrored = false;

    static std::optional<Frame> of(const glm::mat4& worldFromModel) {
        Frame frame;
        frame.worldFromModel = dmat4(worldFromModel);
        const double determinant = glm::determinant(dmat3(frame.worldFromModel));
        if (!isFiniteMatrix(worldFromModel) || !(std::abs(determinant) > 0))
            return {};
        frame.modelFromWorld = glm::inverse(frame.worldFromModel);
        frame.spread = absolute(dmat3(frame.worldFromModel));
        frame.normalFromModel = normalMatrix(worldFromModel);
        frame.mirrored = determinant < 0;
        return frame;
    }

    DRay toModel(const Ray& ray) const {
        // The translation is taken off first: far from the world's origin only that keeps the digits.
        const dmat3 linear(modelFromWorld);
        return {linear * (dvec3(ray.origin) - dvec3(worldFromModel[3])), linear * dvec3(ray.direction)};
    }
};

/// Triangles in the world.
struct Flat {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;
    std::vector<std::uint32_t> instanceOf;  ///< by triangle
    std::unique_ptr<Accelerator> accelerator;

    TriangleView view() const { return {positions, indices}; }
};

struct SolidFrame {
    Solid solid;
    Frame frame;
    /// Balls that stay balls are met in the world.
    std::optional<DBall> ball;
    std::uint32_t index = 0;  ///< into the solids
};

/// An instance of a mesh with a structure of its own.
struct SharedInstance {
    const Accelerator* accelerator = nullptr;
    std::uint32_t instance = 0;
};

std::optional<DBall> ballOf(const Shape& shape, const dmat4& worldFromModel) {
    const Sphere* const sphere = std::get_if<Sphere>(&shape);
    const dmat3 m(worldFromModel);
    const bool similar = m[0].y == 0 && m[0].z == 0 && m[1].x == 0 && m[1].z == 0 && m[2].x == 0 &&
                         m[2].y == 0 && std::abs(m[0].x) == std::abs(m[1].y) &&
                         std::abs(m[0].x) == std::abs(m[2].z);
    if (sphere == nullptr || !similar)
        return {};
    return DBall{dvec3(worldFromModel[3]), sphere->radius * std::abs(m[0].x)};
}

/// A box that holds `box` and what rounding makes of rays near it.
Bounds grown(Bounds box) {
    for (int axis = 0; axis < 3; ++axis) {
        const float margin = 0x1p-20f * std::max({std::abs(box.min[axis]), std::abs(box.max[axis]),
                                                  box.max[axis] - box.min[axis]});
        box.min[axis] -= margin;
        box.max[axis] += margin;
    }
    return box;
}

Bounds transformed(const dmat4& worldFromModel, const Bounds& box) {
    Bounds result;
    for (int corner = 0; corner < 8; ++corner)
        result.extend(glm::vec3(dvec3(worldFromModel * dvec4((corner & 1) != 0 ? box.max.x : box.min.x,
                                                             (corner & 2) != 0 ? box.max.y : box.min.y,
                                                             (corner & 4) != 0 ? box.max.z : box.min.z, 1))));
    return result;
}

Bounds boundsOf(const Solid& solid) {
    const auto radius = static_cast<float>(solid.boundingRadius());
    const auto y = static_cast<float>(solid.boundingCentreY());
    return grown({{-radius, y - radius, -radius}, {radius, y + radius, radius}});
}

/// The least float that is no less.
float notBelow(double value) {
    const auto rounded = static_cast<float>(value);
    return rounded >= value ? rounded : std::nextafter(rounded, std::numeric_limits<float>::infinity());
}

/// The nearest t ≥ 0, from outside or inside. The centre is projected onto the ray, so that what is compared
/// with the radius does not cancel, and the roots come from c / (b + √), as b² and c do not (Haines, Günther,
/// Akenine-Möller, Ray Tracing Gems, ch. 7). In double: rays that pass the surface at less than 2^-49 of
/// |origin − centre| + radius may be decided either way. Origins that `movedOff` made lie 2^-25 of their
/// distance from it and more, so those do not meet what they left.
std::optional<double> meetBall(const dvec3& origin, const dvec3& direction, const DBall& ball) {
    const dvec3 towards = ball.centre - origin;
    const double squared = glm::dot(direction, direction);
    const double b = glm::dot(towards, direction);
    const double c = glm::dot(towards, towards) - ball.radius * ball.radius;
    if (c > 0 && !(b > 0))
        return {};
    const dvec3 off = towards - (b / squared) * direction;
    const double rest = ball.radius * ball.radius - glm::dot(off, off);
    if (!(rest >= 0))
        return {};
    const double root = std::sqrt(rest * squared);
    if (c > 0)
        return c / (b + root);
    return b >= 0 ? (b + root) / squared : -c / (root - b);
}

/// Any unit vector orthogonal to a unit vector.
glm::vec3 tangentAt(glm::vec3 normal) {
    return basisAround(normal).value_or(glm::mat3(1))[0];
}

/// The side that leads away from a surface along `direction`, moved until `reach`, a box about the origin,
/// lies behind it.
glm::vec3 movedOff(const SurfacePoint& point, glm::vec3 direction, glm::vec3 reach) {
    glm::vec3 n = point.geometricNormal;
    if (glm::dot(n, direction) < 0)
        n = -n;
    // The normal itself is off by 2^-24 a component, its length by 2^-22.
    const float height = (1 + 0x1p-20f) * glm::dot(glm::abs(n) + 0x1p-22f, reach);
    glm::vec3 origin = point.position + height * n;
    for (int axis = 0; axis < 3; ++axis)
        if (n[axis] != 0)
            origin[axis] =
                std::nextafter(origin[axis], std::copysign(std::numeric_limits<float>::infinity(), n[axis]));
    return origin;
}

/// What a texture coordinate leaves of its surface: scenes are not believed.
glm::vec2 interpolated(const std::vector<glm::vec2>& values, const std::array<std::uint32_t, 3>& corners,
                       glm::vec3 weights) {
    if (values.empty())
        return glm::vec2(0);
    return weights.x * values[corners[0]] + weights.y * values[corners[1]] + weights.z * values[corners[2]];
}

}  // namespace

struct TraceScene::Parts {
    Scene scene;
    std::vector<TracedSolid> solids;
    std::vector<std::optional<Frame>> frames;  ///< by instance
    std::vector<std::uint32_t> firstVertex;    ///< by instance: in its flat set; `none` where it is shared
    std::vector<std::uint32_t> firstTriangle;  ///< by instance
    Flat whole;
    Flat cutOut;
    std::vector<std::unique_ptr<Accelerator>> meshStructures;  ///< by mesh
    std::vector<SharedInstance> shared;
    std::vector<SolidFrame> placedSolids;
    BoxTree boxes;  ///< of `shared`, then of `placedSolids`
    Bounds bounds;
    bool blends = false;

    /// What is nearest so far.
    struct Found {
        double t = std::numeric_limits<double>::infinity();
        enum class Kind { nothing, whole, cutOut, shared, solid } kind = Kind::nothing;
        std::uint32_t index = 0;  ///< of the shared instance or the solid
        AcceleratorHit hit;
        Hit onSolid;  ///< model space
    };

    void build(Structure structure);
    void flatten(std::uint32_t instance);
    Mesh readyMesh(const Instance& instance) const;
    const Material& materialOf(std::uint32_t instance) const {
        return scene.materials[scene.instances[instance].material];
    }
    std::array<std::uint32_t, 3> corners(std::uint32_t instance, std::uint32_t triangle) const {
        const std::vector<std::uint32_t>& indices = scene.meshes[scene.instances[instance].mesh].indices;
        return {indices[3 * std::size_t{triangle}], indices[3 * std::size_t{triangle} + 1],
                indices[3 * std::size_t{triangle} + 2]};
    }

    glm::vec4 read(const TextureUse& use, std::uint32_t instance, std::uint32_t triangle, glm::vec3 weights,
                   glm::vec2 texcoord) const;
    float alphaAt(std::uint32_t instance, std::uint32_t triangle, glm::vec3 weights) const;
    bool isHole(std::uint32_t instance, std::uint32_t triangle, glm::vec3 weights) const;

    std::optional<AcceleratorHit> nearestInCutOuts(const Ray& ray, RayInterval interval,
                                                   TraversalCounts* counts) const;
    std::optional<AcceleratorHit> nearestInShared(const SharedInstance& shared, const Ray& ray,
                                                  RayInterval interval, TraversalCounts* counts) const;
    std::optional<Hit> meetSolid(const SolidFrame& solid, const Ray& ray, RayInterval interval) const;
    Found find(const Ray& ray, RayInterval interval, TraversalCounts* counts) const;
    bool meetsAny(const Ray& ray, RayInterval interval, TraversalCounts* counts) const;

    SurfacePoint onTriangle(const Ray& ray, const Found& found) const;
    SurfacePoint onSolid(const Ray& ray, const Found& found) const;
    void bendNormal(SurfacePoint& point, const std::array<std::uint32_t, 3>& corner) const;
};

// Building -----------------------------------------------------------------------------------------------

/// Gives a mesh what its material asks for and it lacks.
void completeTangents(Scene& scene) {
    for (const Instance& instance : scene.instances) {
        Mesh& mesh = scene.meshes[instance.mesh];
        const std::optional<TextureUse>& map = scene.materials[instance.material].normalTexture;
        if (!map || !mesh.tangents.empty() || mesh.positions.empty())
            continue;
        if (mesh.normals.empty())
            makeSmoothNormals(mesh);
        makeTangents(mesh, map->texcoordSet, map->textureFromTexcoord);
    }
}

void TraceScene::Parts::flatten(std::uint32_t index) {
    const Instance& instance = scene.instances[index];
    const Mesh& mesh = scene.meshes[instance.mesh];
    Flat& flat = materialOf(index).alphaMode == Material::AlphaMode::mask ? cutOut : whole;
    firstVertex[index] = static_cast<std::uint32_t>(flat.positions.size());
    firstTriangle[index] = static_cast<std::uint32_t>(flat.instanceOf.size());
    const dmat4 worldFromModel(instance.worldFromModel);
    for (const glm::vec3& position : mesh.positions)
        flat.positions.emplace_back(dvec3(worldFromModel * dvec4(position, 1)));
    for (const std::uint32_t corner : mesh.indices)
        flat.indices.push_back(firstVertex[index] + corner);
    flat.instanceOf.resize(flat.indices.size() / 3, index);
}

void TraceScene::Parts::build(Structure structure) {
    for (const Instance& instance : scene.instances) {
        QX_CHECK_LT(instance.mesh, scene.meshes.size());
        QX_CHECK_LT(instance.material, scene.materials.size());
    }
    for (const TracedSolid& solid : solids)
        QX_CHECK_LT(solid.material, scene.materials.size());
    completeTangents(scene);

    std::vector<Bounds> around;
    std::vector<std::size_t> uses(scene.meshes.size());
    for (const Instance& instance : scene.instances)
        ++uses[instance.mesh];
    meshStructures.resize(scene.meshes.size());
    firstVertex.assign(scene.instances.size(), none);
    firstTriangle.assign(scene.instances.size(), 0);
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        frames.push_back(Frame::of(instance.worldFromModel));
        const Mesh& mesh = scene.meshes[instance.mesh];
        if (!frames.back() || mesh.indices.empty())
            continue;
        if (uses[instance.mesh] == 1 || mesh.triangleCount() <= smallMesh) {
            flatten(i);
            continue;
        }
        std::unique_ptr<Accelerator>& own = meshStructures[instance.mesh];
        if (!own)
            own = makeAccelerator(structure, {mesh.positions, mesh.indices});
        shared.push_back({own.get(), i});
        around.push_back(grown(transformed(frames[i]->worldFromModel, mesh.bounds())));
    }
    for (Flat* flat : {&whole, &cutOut}) {
        for (const glm::vec3& position : flat->positions)
            bounds.extend(position);
        if (!flat->indices.empty())
            flat->accelerator = makeAccelerator(structure, flat->view());
    }
    for (std::uint32_t i = 0; i < solids.size(); ++i)
        if (const std::optional<Frame> frame = Frame::of(solids[i].worldFromModel)) {
            Solid solid(solids[i].shape);
            around.push_back(grown(transformed(frame->worldFromModel, boundsOf(solid))));
            placedSolids.push_back(
                {std::move(solid), *frame, ballOf(solids[i].shape, frame->worldFromModel), i});
        }
    boxes = BoxTree(around);
    bounds.extend(boxes.bounds());
    blends = std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& material) {
        return material.alphaMode == Material::AlphaMode::blend;
    });
}

TraceScene::TraceScene(Scene scene, std::vector<TracedSolid> solids, Structure structure)
    : parts_(std::make_unique<Parts>()) {
    parts_->scene = std::move(scene);
    parts_->solids = std::move(solids);
    parts_->build(structure);
}

TraceScene::TraceScene(const StillLife& stillLife) : parts_(std::make_unique<Parts>()) {
    Scene& scene = parts_->scene;
    scene.lights = stillLife.lights;
    scene.cameras = {stillLife.camera};
    scene.ambientLight = stillLife.ambientLight;
    scene.backgroundTop = stillLife.backgroundTop;
    scene.backgroundBottom = stillLife.backgroundBottom;
    for (const StillLife::Object& object : stillLife.objects) {
        parts_->solids.push_back({object.shape, scene.materials.size(), object.worldFromModel});
        scene.materials.push_back(object.material);
    }
    parts_->build(Structure::wideBvh);
}

TraceScene::~TraceScene() = default;
TraceScene::TraceScene(TraceScene&&) noexcept = default;
TraceScene& TraceScene::operator=(TraceScene&&) noexcept = default;

const Scene& TraceScene::scene() const {
    return parts_->scene;
}
const std::vector<TracedSolid>& TraceScene::solids() const {
    return parts_->solids;
}
Bounds TraceScene::bounds() const {
    return parts_->bounds;
}

// Meeting ------------------------------------------------------------------------------------------------

glm::vec4 TraceScene::Parts::read(const TextureUse& use, std::uint32_t instance, std::uint32_t triangle,
                                  glm::vec3 weights, glm::vec2 texcoord) const {
    if (use.texcoordSet == 1)
        texcoord = instance < scene.instances.size()
                       ? interpolated(scene.meshes[scene.instances[instance].mesh].texcoords1,
                                      corners(instance, triangle), weights)
                       : glm::vec2(0);
    return lookUp(scene.textures[use.texture], glm::vec2(use.textureFromTexcoord * glm::vec3(texcoord, 1)));
}

float TraceScene::Parts::alphaAt(std::uint32_t instance, std::uint32_t triangle, glm::vec3 weights) const {
    const Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
    const Material& material = materialOf(instance);
    const std::array<std::uint32_t, 3> corner = corners(instance, triangle);
    float alpha = material.baseColor.a;
    if (material.baseColorTexture)
        alpha *= read(*material.baseColorTexture, instance, triangle, weights,
                      interpolated(mesh.texcoords, corner, weights))
                     .a;
    if (!mesh.colors.empty())
        alpha *= weights.x * mesh.colors[corner[0]].a + weights.y * mesh.colors[corner[1]].a +
                 weights.z * mesh.colors[corner[2]].a;
    return alpha;
}

bool TraceScene::Parts::isHole(std::uint32_t instance, std::uint32_t triangle, glm::vec3 weights) const {
    const Material& material = materialOf(instance);
    return material.alphaMode == Material::AlphaMode::mask &&
           alphaAt(instance, triangle, weights) < material.alphaCutoff;
}

std::optional<AcceleratorHit> TraceScene::Parts::nearestInCutOuts(const Ray& ray, RayInterval interval,
                                                                  TraversalCounts* counts) const {
    for (;;) {
        const std::optional<AcceleratorHit> hit = cutOut.accelerator->nearest(ray, interval, counts);
        if (!hit)
            return hit;
        const std::uint32_t instance = cutOut.instanceOf[hit->triangle];
        if (!isHole(instance, hit->triangle - firstTriangle[instance], hit->weights))
            return hit;
        interval.tMin = std::nextafter(notBelow(hit->t), std::numeric_limits<float>::infinity());
        if (!(interval.tMin <= interval.tMax))
            return {};
    }
}

std::optional<AcceleratorHit> TraceScene::Parts::nearestInShared(const SharedInstance& one, const Ray& ray,
                                                                 RayInterval interval,
                                                                 TraversalCounts* counts) const {
    const DRay inModel = frames[one.instance]->toModel(ray);
    const Ray modelRay{glm::vec3(inModel.origin), glm::vec3(inModel.direction)};
    for (;;) {
        const std::optional<AcceleratorHit> hit = one.accelerator->nearest(modelRay, interval, counts);
        if (!hit || !isHole(one.instance, hit->triangle, hit->weights))
            return hit;
        interval.tMin = std::nextafter(notBelow(hit->t), std::numeric_limits<float>::infinity());
        if (!(interval.tMin <= interval.tMax))
            return {};
    }
}

std::optional<Hit> TraceScene::Parts::meetSolid(const SolidFrame& one, const Ray& ray,
                                                RayInterval interval) const {
    const double from = std::max<double>(interval.tMin, 0);
    if (one.ball) {
        const dvec3 direction(ray.direction);
        const dvec3 start = dvec3(ray.origin) + from * direction;
        const std::optional<double> t = meetBall(start, direction, *one.ball);
        if (!t || from + *t > interval.tMax)
            return {};
        Hit hit;
        hit.t = from + *t;
        // Drawn onto the ball: t times the direction keeps few digits where the ray comes from afar.
        const dvec3 off = start - one.ball->centre + *t * direction;
        const double length = glm::length(off);
        hit.normal = length > 0 ? off / length : dvec3(0, 1, 0);
        hit.position = one.ball->centre + one.ball->radius * hit.normal;
        return hit;
    }
    DRay inModel = one.frame.toModel(ray);
    inModel.origin += from * inModel.direction;
    std::optional<Hit> hit = one.solid.intersect(inModel);
    if (!hit || from + hit->t > interval.tMax)
        return {};
    hit->t += from;
    return hit;
}

TraceScene::Parts::Found TraceScene::Parts::find(const Ray& ray, RayInterval interval,
                                                 TraversalCounts* counts) const {
    Found found;
    const auto keep = [&](Found::Kind kind, std::uint32_t index, const AcceleratorHit& hit) {
        if (hit.t >= found.t)
            return;
        found.t = hit.t;
        found.kind = kind;
        found.index = index;
        found.hit = hit;
        interval.tMax = std::min(interval.tMax, notBelow(hit.t));
    };
    if (whole.accelerator)
        if (const auto hit = whole.accelerator->nearest(ray, interval, counts))
            keep(Found::Kind::whole, 0, *hit);
    if (cutOut.accelerator)
        if (const auto hit = nearestInCutOuts(ray, interval, counts))
            keep(Found::Kind::cutOut, 0, *hit);
    boxes.visit(
        ray, interval,
        [&](std::uint32_t i, float) {
            if (i < shared.size()) {
                if (const auto hit = nearestInShared(shared[i], ray, interval, counts))
                    keep(Found::Kind::shared, i, *hit);
                return interval.tMax;
            }
            const auto index = static_cast<std::uint32_t>(i - shared.size());
            if (const auto hit = meetSolid(placedSolids[index], ray, interval); hit && hit->t < found.t) {
                keep(Found::Kind::solid, index, {.t = hit->t});
                found.onSolid = *hit;
            }
            return interval.tMax;
        },
        counts);
    return found;
}

bool TraceScene::Parts::meetsAny(const Ray& ray, RayInterval interval, TraversalCounts* counts) const {
    if (whole.accelerator && whole.accelerator->occluded(ray, interval, counts))
        return true;
    if (cutOut.accelerator && nearestInCutOuts(ray, interval, counts))
        return true;
    bool found = false;
    boxes.visit(
        ray, interval,
        [&](std::uint32_t i, float tMax) {
            found = i < shared.size() ? nearestInShared(shared[i], ray, interval, counts).has_value()
                                      : meetSolid(placedSolids[i - shared.size()], ray, interval).has_value();
            return found ? -std::numeric_limits<float>::infinity() : tMax;
        },
        counts);
    return found;
}

// Surface points -----------------------------------------------------------------------------------------

void TraceScene::Parts::bendNormal(SurfacePoint& point, const std::array<std::uint32_t, 3>& corner) const {
    const Material& material = scene.materials[point.material];
    const Mesh& mesh = scene.meshes[scene.instances[point.instance].mesh];
    if (!material.normalTexture || mesh.tangents.empty())
        return;
    const Frame& frame = *frames[point.instance];
    const glm::mat3 linear(scene.instances[point.instance].worldFromModel);
    const glm::vec3 w = point.weights;
    glm::vec3 tangent(0);
    float side = 0;
    for (int i = 0; i < 3; ++i) {
        const glm::vec4& at = mesh.tangents[corner[static_cast<std::size_t>(i)]];
        tangent += w[i] * normalizeOr(linear * glm::vec3(at), glm::vec3(0));
        side += w[i] * at.w;
    }
    if (frame.mirrored)
        side = -side;
    const glm::vec4 texel = read(*material.normalTexture, point.instance, point.triangle, w, point.texcoord);
    const glm::vec3 mapped(material.normalScale * (2 * texel.x - 1), material.normalScale * (2 * texel.y - 1),
                           2 * texel.z - 1);
    const glm::vec3 n = point.shadingNormal;
    const glm::vec3 bent = normalizeOr(
        mapped.x * tangent + mapped.y * side * glm::cross(n, tangent) + mapped.z * n, glm::vec3(0));
    if (glm::dot(bent, point.geometricNormal) > 0)
        point.shadingNormal = bent;
}

SurfacePoint TraceScene::Parts::onTriangle(const Ray&, const Found& found) const {
    SurfacePoint point;
    point.t = found.t;
    point.weights = found.hit.weights;
    const bool isShared = found.kind == Found::Kind::shared;
    const Flat& flat = found.kind == Found::Kind::cutOut ? cutOut : whole;
    point.instance = isShared ? shared[found.index].instance : flat.instanceOf[found.hit.triangle];
    point.triangle = isShared ? found.hit.triangle : found.hit.triangle - firstTriangle[point.instance];
    const Instance& instance = scene.instances[point.instance];
    const Mesh& mesh = scene.meshes[instance.mesh];
    const Frame& frame = *frames[point.instance];
    point.material = instance.material;
    // A structure of its own lies in the model's frame, where nothing is mirrored.
    point.front = found.hit.front != (frame.mirrored && !isShared);
    const std::array<std::uint32_t, 3> corner = corners(point.instance, point.triangle);

    const auto vertex = [&](std::size_t i) {
        return isShared ? mesh.positions[corner[i]] : flat.positions[firstVertex[point.instance] + corner[i]];
    };
    const std::array<glm::vec3, 3> v{vertex(0), vertex(1), vertex(2)};
    // Weights that are no less than 0 and sum to 1 make a point of the triangle, whatever they are off by.
    const dvec3 weights = dvec3(found.hit.weights) / (static_cast<double>(found.hit.weights.x) +
                                                      found.hit.weights.y + found.hit.weights.z);
    const dvec3 inPlace = weights.x * dvec3(v[0]) + weights.y * dvec3(v[1]) + weights.z * dvec3(v[2]);
    const glm::vec3 largest = glm::max(glm::max(glm::abs(v[0]), glm::abs(v[1])), glm::abs(v[2]));
    glm::dvec3 normal = triangleNormal(v[0], v[1], v[2]);
    if (isShared) {
        const dvec3 fromOrigin = dmat3(frame.worldFromModel) * inPlace;
        point.position = glm::vec3(fromOrigin + dvec3(frame.worldFromModel[3]));
        // Rays that leave are carried into the model's frame and rounded there: half an ulp of the origin,
        // which is the point but for the little that it is moved.
        const dvec3 reach = frame.spread * (0x1p-23 * glm::abs(inPlace) + 0x1p-48 * dvec3(largest));
        point.positionError = halfUlp * glm::abs(point.position) + glm::vec3((1 + 0x1p-20) * reach);
        normal = glm::normalize(dvec3(frame.normalFromModel * glm::vec3(normal)));
        point.geometricNormal = glm::vec3(normal);
    } else {
        point.position = glm::vec3(inPlace);
        point.positionError = halfUlp * glm::abs(point.position) + 0x1p-48f * largest;
        point.geometricNormal = frame.mirrored ? -glm::vec3(normal) : glm::vec3(normal);
    }
    point.positionError += std::numeric_limits<float>::denorm_min();

    const glm::vec3 w = point.weights;
    point.shadingNormal = point.geometricNormal;
    if (!mesh.normals.empty()) {
        glm::vec3 sum(0);
        for (int i = 0; i < 3; ++i)
            sum +=
                w[i] * normalizeOr(frame.normalFromModel * mesh.normals[corner[static_cast<std::size_t>(i)]],
                                   glm::vec3(0));
        point.shadingNormal = normalizeOr(sum, point.geometricNormal);
        if (glm::dot(point.shadingNormal, point.geometricNormal) < 0)
            point.shadingNormal = -point.shadingNormal;
    }
    point.texcoord = interpolated(mesh.texcoords, corner, w);
    if (!mesh.colors.empty())
        point.color =
            w.x * mesh.colors[corner[0]] + w.y * mesh.colors[corner[1]] + w.z * mesh.colors[corner[2]];
    bendNormal(point, corner);
    point.tangent = tangentAt(point.shadingNormal);
    return point;
}

SurfacePoint TraceScene::Parts::onSolid(const Ray& ray, const Found& found) const {
    const SolidFrame& one = placedSolids[found.index];
    const Frame& frame = one.frame;
    SurfacePoint point;
    point.t = found.t;
    point.instance = static_cast<std::uint32_t>(scene.instances.size()) + one.index;
    point.material = solids[one.index].material;
    dvec3 normal = found.onSolid.normal;
    dvec3 inModel = found.onSolid.position;
    if (one.ball) {
        point.position = glm::vec3(found.onSolid.position);
        // As below: the ball is met to 2^-50 of its size, and the distance to its centre.
        point.positionError =
            glm::vec3(static_cast<float>(0x1p-46 * one.ball->radius)) + halfUlp * glm::abs(point.position);
        inModel = (found.onSolid.position - one.ball->centre) / one.ball->radius;
    } else {
        point.position = glm::vec3(dmat3(frame.worldFromModel) * inModel + dvec3(frame.worldFromModel[3]));
        // Rays that pass the solid at less than 64 · 2^-53 of its size may count as meeting it.
        point.positionError =
            halfUlp * glm::abs(point.position) + glm::vec3(frame.spread * dvec3(0x1p-46 * one.solid.size()));
        const dmat3 model(frame.modelFromWorld);
        normal = glm::normalize(glm::transpose(model) * normal);
    }
    point.positionError += std::numeric_limits<float>::denorm_min();
    point.geometricNormal = glm::vec3(normal);
    point.shadingNormal = point.geometricNormal;
    point.tangent = tangentAt(point.shadingNormal);
    point.front = glm::dot(normal, dvec3(ray.direction)) < 0;
    const Material& material = scene.materials[point.material];
    if (!material.baseColorTexture && !material.metallicRoughnessTexture && !material.emissionTexture &&
        !material.occlusionTexture)
        return point;
    const double turn = std::atan2(inModel.x, inModel.z) / (2 * std::numbers::pi);
    const double level = std::hypot(inModel.x, inModel.z);
    point.texcoord = {
        static_cast<float>(turn < 0 ? turn + 1 : turn),
        static_cast<float>(std::atan2(level, inModel.y - one.solid.boundingCentreY()) / std::numbers::pi)};
    return point;
}

std::optional<SurfacePoint> TraceScene::nearest(const Ray& ray, RayInterval interval,
                                                TraversalCounts* counts) const {
    const Parts::Found found = parts_->find(ray, interval, counts);
    if (found.kind == Parts::Found::Kind::nothing)
        return {};
    return found.kind == Parts::Found::Kind::solid ? parts_->onSolid(ray, found)
                                                   : parts_->onTriangle(ray, found);
}

bool TraceScene::occluded(const Ray& ray, RayInterval interval, TraversalCounts* counts) const {
    return parts_->meetsAny(ray, interval, counts);
}

SurfaceValues TraceScene::valuesAt(const SurfacePoint& point) const {
    const Material& material = parts_->scene.materials[point.material];
    const auto read = [&](const TextureUse& use) {
        return parts_->read(use, point.instance, point.triangle, point.weights, point.texcoord);
    };
    SurfaceValues values;
    glm::vec4 color = point.color;
    if (material.baseColorTexture)
        color *= read(*material.baseColorTexture);
    values.diffuse = sane(material.diffuse * glm::vec3(color), brightest);
    values.specular = sane(material.specular, brightest);
    values.shininess = sane(material.shininess, 1e5f);
    color *= material.baseColor;
    values.baseColor = glm::vec4(sane(glm::vec3(color), brightest), sane(color.a, 1));
    float metallic = material.metallic;
    float roughness = material.roughness;
    if (material.metallicRoughnessTexture) {
        const glm::vec4 map = read(*material.metallicRoughnessTexture);
        roughness *= map.g;
        metallic *= map.b;
    }
    values.metallic = sane(metallic, 1);
    values.roughness = sane(roughness, 1);
    values.transmission = sane(material.transmission, 1);
    values.ior = std::clamp(sane(material.ior), 1.0f, 1e3f);
    if (material.occlusionTexture)
        values.occlusion = sane(1 + material.occlusionStrength * (read(*material.occlusionTexture).r - 1), 1);
    glm::vec3 emission = material.emission;
    if (material.emissionTexture)
        emission *= glm::vec3(read(*material.emissionTexture));
    values.emission = sane(emission, brightest);
    return values;
}

// Rays ---------------------------------------------------------------------------------------------------

Ray TraceScene::leave(const SurfacePoint& point, glm::vec3 direction) {
    return {movedOff(point, direction, point.positionError), direction};
}

namespace {

/// The ray between two points is rounded, once here and once in the frame of an instance, so that its end is
/// off by that as well.
glm::vec3 endOf(const SurfacePoint& from, const SurfacePoint& to) {
    const glm::vec3 between = to.position - from.position;
    return movedOff(to, -between,
                    to.positionError + 0x1p-22f * (glm::abs(between) + glm::length(between) * 0x1p-2f));
}

Ray rayTo(const SurfacePoint& from, glm::vec3 end) {
    const glm::vec3 origin = movedOff(from, end - from.position, from.positionError);
    return {origin, end - origin};
}

}  // namespace

bool TraceScene::visible(const SurfacePoint& from, const SurfacePoint& to, TraversalCounts* counts) const {
    const glm::vec3 origin = movedOff(from, to.position - from.position, from.positionError);
    return !occluded({origin, endOf(from, to) - origin}, {0, 1}, counts);
}

bool TraceScene::visible(const SurfacePoint& from, glm::vec3 to, TraversalCounts* counts) const {
    return !occluded(rayTo(from, to), {0, 1}, counts);
}

bool TraceScene::blends() const {
    return parts_->blends;
}

float TraceScene::coverAt(const SurfacePoint& point, const SurfaceValues& values) const {
    return parts_->scene.materials[point.material].alphaMode == Material::AlphaMode::blend
               ? values.baseColor.a
               : 1.0f;
}

template <typename GoOn>
float TraceScene::clearShareOf(Ray ray, RayInterval interval, TraversalCounts* counts,
                               const GoOn& goOn) const {
    float share = 1;
    while (share > 0) {
        const std::optional<SurfacePoint> point = nearest(ray, interval, counts);
        if (!point)
            break;
        share *= 1 - coverAt(*point, valuesAt(*point));
        ray = goOn(*point);
    }
    return share;
}

float TraceScene::clearShare(const SurfacePoint& from, const SurfacePoint& to,
                             TraversalCounts* counts) const {
    if (!blends())
        return visible(from, to, counts) ? 1.0f : 0.0f;
    const glm::vec3 end = endOf(from, to);
    const glm::vec3 origin = movedOff(from, to.position - from.position, from.positionError);
    return clearShareOf({origin, end - origin}, {0, 1}, counts,
                        [&](const SurfacePoint& between) { return rayTo(between, end); });
}

float TraceScene::clearShare(const SurfacePoint& from, glm::vec3 to, TraversalCounts* counts) const {
    if (!blends())
        return visible(from, to, counts) ? 1.0f : 0.0f;
    return clearShareOf(rayTo(from, to), {0, 1}, counts,
                        [&](const SurfacePoint& between) { return rayTo(between, to); });
}

float TraceScene::clearShareAlong(const SurfacePoint& from, glm::vec3 direction,
                                  TraversalCounts* counts) const {
    if (!blends())
        return occluded(leave(from, direction), {}, counts) ? 0.0f : 1.0f;
    return clearShareOf(leave(from, direction), {}, counts,
                        [&](const SurfacePoint& between) { return leave(between, direction); });
}

std::optional<SurfacePoint> nearestDrawn(const TraceScene& scene, const Ray& ray, RayInterval interval) {
    for (;;) {
        std::optional<SurfacePoint> point = scene.nearest(ray, interval);
        if (!point || point->front || point->instance >= scene.scene().instances.size() ||
            scene.scene().materials[point->material].doubleSided)
            return point;
        interval.tMin = std::nextafter(notBelow(point->t), std::numeric_limits<float>::infinity());
        if (!(interval.tMin <= interval.tMax))
            return {};
    }
}

Scene movedBy(Scene scene, glm::dvec3 by) {
    const auto move = [&](glm::mat4& worldFromThing) {
        for (int i = 0; i < 3; ++i)
            worldFromThing[3][i] = static_cast<float>(worldFromThing[3][i] + by[i]);
    };
    for (Instance& instance : scene.instances)
        move(instance.worldFromModel);
    for (Light& light : scene.lights)
        light.position = glm::vec3(dvec3(light.position) + by);
    for (Camera& camera : scene.cameras)
        move(camera.worldFromCamera);
    return scene;
}

Camera movedBy(Camera camera, glm::dvec3 by) {
    for (int i = 0; i < 3; ++i)
        camera.worldFromCamera[3][i] = static_cast<float>(camera.worldFromCamera[3][i] + by[i]);
    return camera;
}

Ray cameraRay(const Camera& camera, int width, int height, glm::vec2 pixel, glm::vec2 lens) {
    const double halfHeight = std::tan(0.5 * static_cast<double>(camera.fovYRadians));
    const double halfWidth = halfHeight * width / height;
    const dvec3 pinhole((2.0 * pixel.x / width - 1) * halfWidth, (1 - 2.0 * pixel.y / height) * halfHeight,
                        -1);
    const dmat4 worldFromCamera(camera.worldFromCamera);
    dvec3 origin(0);
    dvec3 direction = pinhole;
    if (camera.apertureRadius > 0) {
        origin = dvec3(static_cast<double>(camera.apertureRadius) * glm::dvec2(lens), 0);
        if (std::isfinite(camera.focusDistance))
            direction = pinhole * static_cast<double>(camera.focusDistance) - origin;
    }
    return {glm::vec3(dvec3(worldFromCamera * dvec4(origin, 1))),
            glm::vec3(glm::normalize(dmat3(worldFromCamera) * direction))};
}

}  // namespace quincunx
