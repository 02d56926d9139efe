#include "labs/22_intersections/picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/gtc/matrix_transform.hpp>
#include <tbb/parallel_for.h>

#include "base/interrupt.h"
#include "math/ulp.h"
#include "math/vector.h"

namespace quincunx {
namespace {

const glm::vec3 toLight = *normalize(glm::vec3(-0.55f, 1.0f, 0.62f));
const glm::vec3 skyTop(0.16f, 0.24f, 0.36f);
const glm::vec3 skyBottom(0.62f, 0.66f, 0.70f);

/// Rays that pass a shape by far need not be tried, but for the textbook's forms, whose wrong answers are to
/// be seen. A twentieth of the radius stands for the rounding of this test.
bool mayMeet(const Exhibit& exhibit, const Ray& ray, const Approach& approach = {}) {
    if (approach.method == Method::naive)
        return true;
    const glm::dvec3 d = glm::normalize(glm::dvec3(ray.direction));
    if (const auto* column = std::get_if<Column>(&exhibit.shape)) {
        const glm::dvec3 f = glm::dvec3(column->cylinder.base) - glm::dvec3(ray.origin);
        return std::abs(f.x * d.z - f.z * d.x) <= 1.05 * column->cylinder.radius * std::hypot(d.x, d.z) ||
               std::hypot(d.x, d.z) < 1e-6;
    }
    if (std::isinf(exhibit.around.radius))
        return true;
    const glm::dvec3 f = glm::dvec3(exhibit.around.centre) - glm::dvec3(ray.origin);
    const glm::dvec3 across = f - glm::dot(f, d) * d;
    return glm::length(across) <= 1.05 * exhibit.around.radius;
}

bool inShadow(const std::vector<Exhibit>& exhibits, int self, glm::vec3 point, const Approach& approach) {
    for (std::size_t i = 0; i < exhibits.size(); ++i) {
        const Ray ray{point, toLight};
        if (static_cast<int>(i) != self && !std::holds_alternative<Plane>(exhibits[i].shape) &&
            mayMeet(exhibits[i], ray, approach) && meet(exhibits[i], ray, approach))
            return true;
    }
    return false;
}

/// The floor's tiles: a thin line every unit.
float tile(glm::vec3 local) {
    const glm::vec2 at(local.x + 0.5f, local.z + 0.5f);
    const glm::vec2 toLine = glm::abs(at - glm::round(at));
    return std::min(toLine.x, toLine.y) < 0.015f ? 0.72f : 1.0f;
}

glm::vec3 shade(const std::vector<Exhibit>& exhibits, const Seen& seen, const Ray& ray,
                const Approach& approach, glm::vec3 place, double height) {
    const glm::vec3 sky = glm::mix(skyBottom, skyTop, static_cast<float>(std::clamp(height, 0.0, 1.0)));
    if (seen.exhibit < 0)
        return sky;
    const Exhibit& exhibit = exhibits[static_cast<std::size_t>(seen.exhibit)];
    const glm::vec3 n = seen.hit.normal;
    const glm::vec3 view = -normalizeOr(ray.direction, glm::vec3(0, 0, -1));
    const float toward = glm::dot(n, toLight);
    const float lit = toward > 0 && !inShadow(exhibits, seen.exhibit, seen.hit.point, approach) ? toward : 0;
    const bool floor = std::holds_alternative<Plane>(exhibit.shape);
    const glm::vec3 local = seen.hit.point - place;
    const glm::vec3 base = exhibit.color * (floor ? tile(local) : 1.0f);
    const float fill = 0.22f + 0.12f * n.y;
    const glm::vec3 half = normalizeOr(toLight + view, n);
    const float highlight = lit > 0 ? exhibit.gloss * std::pow(std::max(glm::dot(n, half), 0.0f), 60.0f) : 0;
    const glm::vec3 color =
        base * (fill * glm::vec3(0.85f, 0.95f, 1.1f) + lit * glm::vec3(1.0f, 0.95f, 0.86f)) +
        glm::vec3(highlight);
    if (!floor)
        return color;
    // The floor goes over into the sky.
    const float far = glm::smoothstep(7.0f, 26.0f, glm::length(glm::vec2(local.x, local.z)));
    return glm::mix(color, sky, std::isfinite(far) ? far : 1.0f);
}

float depthOf(const Seen& seen, const glm::dmat4& clipFromWorld) {
    if (seen.exhibit < 0)
        return 1;
    const glm::dvec4 clip = clipFromWorld * glm::dvec4(glm::dvec3(seen.hit.point), 1);
    const double depth = 0.5 + 0.5 * clip.z / clip.w;
    return static_cast<float>(depth >= 0 && depth <= 1 ? depth : 1.0);
}

glm::vec3 placeOf(const std::vector<Exhibit>& exhibits) {
    for (const Exhibit& exhibit : exhibits)
        if (std::isinf(exhibit.around.radius))
            return exhibit.around.centre;
    return glm::vec3(0);
}

template <typename Row>
void forRows(int height, const Row& row) {
    tbb::parallel_for(0, height, [&](int y) {
        if (!interrupted())
            row(y);
    });
    throwIfInterrupted();
}

}  // namespace

Ray Lens::rayAt(double x, double y) const {
    const double sideways = (2 * x - 1) * halfHeight * aspect;
    const double upwards = (1 - 2 * y) * halfHeight;
    return {glm::vec3(eye), glm::vec3(reach * forward + sideways * right + upwards * up)};
}

glm::dmat4 Lens::clipFromLocal(glm::dvec3 place) const {
    // As much depth as the lab has things in it, however far they are.
    const double nearest = std::max(reach - 40, 0.01 * reach);
    const double farthest = reach + 80;
    const double top = halfHeight / reach * nearest;
    return glm::frustum(-top * aspect, top * aspect, -top, top, nearest, farthest) *
           glm::lookAt(eye - place, eye - place + forward, up);
}

Lens makeLens(const Camera& camera, glm::dvec3 target, double distance, glm::dvec3 place, double aspect) {
    const glm::dmat4 pose(camera.worldFromCamera);
    Lens lens;
    lens.right = glm::normalize(glm::dvec3(pose[0]));
    lens.forward = -glm::normalize(glm::dvec3(pose[2]));
    lens.up = glm::cross(lens.right, lens.forward);
    const glm::dvec3 eye(pose[3]);
    // Along the view: what lies in the plane of the target keeps its size in the picture.
    const double near = std::max(glm::dot(target - eye, lens.forward), 1e-3);
    lens.reach = near * distance;
    lens.eye = eye + place - (lens.reach - near) * lens.forward;
    lens.halfHeight = near * std::tan(0.5 * static_cast<double>(camera.fovYRadians));
    lens.aspect = aspect;
    return lens;
}

Seen look(const std::vector<Exhibit>& exhibits, const Ray& ray, const Approach& approach) {
    Seen seen;
    for (std::size_t i = 0; i < exhibits.size(); ++i) {
        if (!mayMeet(exhibits[i], ray, approach))
            continue;
        const std::optional<RayHit> hit = meet(exhibits[i], ray, approach);
        if (hit && (seen.exhibit < 0 || hit->t < seen.hit.t))
            seen = {static_cast<int>(i), *hit};
    }
    return seen;
}

Judged judge(const std::vector<Exhibit>& exhibits, const Ray& ray, const Approach& approach) {
    const Seen seen = look(exhibits, ray, approach);
    const bool bounded = approach.method == Method::stable || approach.method == Method::exact;
    int exhibit = -1;
    Quad nearest = 0;
    for (std::size_t i = 0; i < exhibits.size(); ++i) {
        if (!mayMeet(exhibits[i], ray))
            continue;
        const std::optional<Quad> t =
            bounded ? meetExactly(exhibits[i], ray) : std::optional<Quad>(meetDistance(exhibits[i], ray, {}));
        if (t && (exhibit < 0 || *t < nearest)) {
            exhibit = static_cast<int>(i);
            nearest = *t;
        }
    }
    if (seen.exhibit < 0 && exhibit < 0)
        return {};
    if (exhibit < 0)
        return {Verdict::falseHit, 0};
    if (seen.exhibit < 0)
        return {Verdict::falseMiss, 0};
    const double ulps = ulpError(static_cast<float>(seen.hit.t), nearest);
    if (ulps <= 0.51)
        return {Verdict::right, ulps};
    if (seen.exhibit == exhibit)
        return {Verdict::wrongT, ulps};
    return {Quad(seen.hit.t) < nearest ? Verdict::falseHit : Verdict::falseMiss, ulps};
}

glm::vec3 colorOf(const Judged& judged) {
    switch (judged.verdict) {
        case Verdict::falseHit:
            return {1.0f, 0.02f, 0.03f};
        case Verdict::falseMiss:
            return {0.02f, 0.12f, 1.0f};
        case Verdict::wrongT:
            break;
        case Verdict::right:
            return {0, 0, 0};
    }
    // From dark olive at one ulp to bright yellow at 2^16 of them.
    const float share = static_cast<float>(std::clamp(std::log2(judged.ulps) / 16, 0.0, 1.0));
    return glm::mix(glm::vec3(0.05f, 0.10f, 0.02f), glm::vec3(1.0f, 0.85f, 0.05f), share * share);
}

Cast castScene(const std::vector<Exhibit>& exhibits, const Lens& lens, const glm::dmat4& clipFromWorld,
               int width, int height, const Approach& approach, int samples, const std::atomic<bool>* stop) {
    Cast cast{Image(width, height, 4, Encoding::linear), {}};
    const glm::vec3 place = placeOf(exhibits);
    forRows(height, [&](int y) {
        if (stop != nullptr && *stop)
            return;
        for (int x = 0; x < width; ++x) {
            glm::vec3 sum(0);
            float depth = 1;
            for (int j = 0; j < samples; ++j)
                for (int i = 0; i < samples; ++i) {
                    const double u = (x + (i + 0.5) / samples) / width;
                    const double v = (y + (j + 0.5) / samples) / height;
                    const Ray ray = lens.rayAt(u, v);
                    const Seen seen = look(exhibits, ray, approach);
                    sum += glm::min(shade(exhibits, seen, ray, approach, place, 1 - v), glm::vec3(4));
                    depth = std::min(depth, depthOf(seen, clipFromWorld));
                }
            const glm::vec3 mean = sum / static_cast<float>(samples * samples);
            float* const out = cast.color.pixel(x, y);
            for (int c = 0; c < 3; ++c)
                out[c] = mean[c];
            out[3] = depth;
        }
    });
    cast.counts["rays"] = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) *
                          static_cast<std::uint64_t>(samples * samples);
    return cast;
}

Cast castMap(const std::vector<Exhibit>& exhibits, const Lens& lens, const glm::dmat4& clipFromWorld,
             int width, int height, const Approach& approach) {
    Cast cast = castScene(exhibits, lens, clipFromWorld, width, height, {}, 1);
    std::vector<Judged> judged(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    forRows(height, [&](int y) {
        for (int x = 0; x < width; ++x)
            judged[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(x)] =
                judge(exhibits, lens.rayAt((x + 0.5) / width, (y + 0.5) / height), approach);
    });
    for (const char* name : {"false hits", "false misses", "wrong t"})
        cast.counts[name] = 0;
    std::size_t index = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x, ++index) {
            float* const out = cast.color.pixel(x, y);
            const Judged& found = judged[index];
            if (found.verdict == Verdict::right) {
                const float grey = 0.35f * (0.2126f * out[0] + 0.7152f * out[1] + 0.0722f * out[2]) + 0.03f;
                std::fill_n(out, 3, grey);
                continue;
            }
            const glm::vec3 color = colorOf(found);
            for (int c = 0; c < 3; ++c)
                out[c] = color[c];
            ++cast.counts[found.verdict == Verdict::falseHit    ? "false hits"
                          : found.verdict == Verdict::falseMiss ? "false misses"
                                                                : "wrong t"];
        }
    return cast;
}

}  // namespace quincunx
