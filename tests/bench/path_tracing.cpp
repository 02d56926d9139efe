// Path tracing to a given error, beside a plain tracer in the style of well-known small books: virtual calls,
// a binary tree over boxes, independent random numbers, fifty bounces and no roulette; and how threads scale.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include <tbb/global_control.h>

#include "base/random.h"
#include "image/compare.h"
#include "trace/path_scenes.h"
#include "trace/render.h"

namespace {

using namespace quincunx;
using glm::dvec3;

double secondsOf(const auto& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Of all the program's threads: what others do on the machine does not count.
double processorSecondsOf(const auto& work) {
    const std::clock_t start = std::clock();
    work();
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

// The peer ------------------------------------------------------------------------------------------------

struct PlainHit {
    double t;
    dvec3 position;
    dvec3 normal;  ///< against the ray
    bool front;
    const Material* material;
};

struct PlainRay {
    dvec3 origin;
    dvec3 direction;
    dvec3 at(double t) const { return origin + t * direction; }
};

struct PlainBox {
    dvec3 min{std::numeric_limits<double>::infinity()};
    dvec3 max{-std::numeric_limits<double>::infinity()};
    void extend(const PlainBox& other) {
        min = glm::min(min, other.min);
        max = glm::max(max, other.max);
    }
    bool meets(const PlainRay& ray, double tMin, double tMax) const {
        for (int axis = 0; axis < 3; ++axis) {
            const double inverse = 1 / ray.direction[axis];
            double a = (min[axis] - ray.origin[axis]) * inverse;
            double b = (max[axis] - ray.origin[axis]) * inverse;
            if (a > b)
                std::swap(a, b);
            tMin = std::max(a, tMin);
            tMax = std::min(b, tMax);
            if (tMax <= tMin)
                return false;
        }
        return true;
    }
};

class PlainObject {
  public:
    virtual ~PlainObject() = default;
    virtual bool meet(const PlainRay& ray, double tMin, double tMax, PlainHit& hit) const = 0;
    virtual PlainBox box() const = 0;
};

PlainHit hitOf(const PlainRay& ray, double t, dvec3 outward, const Material* material) {
    const bool front = glm::dot(ray.direction, outward) < 0;
    return {t, ray.at(t), front ? outward : -outward, front, material};
}

class PlainSphere final : public PlainObject {
  public:
    PlainSphere(dvec3 centre, double radius, const Material* material)
        : centre_(centre), radius_(radius), material_(material) {}
    bool meet(const PlainRay& ray, double tMin, double tMax, PlainHit& hit) const override {
        const dvec3 oc = ray.origin - centre_;
        const double a = glm::dot(ray.direction, ray.direction);
        const double halfB = glm::dot(oc, ray.direction);
        const double discriminant = halfB * halfB - a * (glm::dot(oc, oc) - radius_ * radius_);
        if (discriminant < 0)
            return false;
        const double root = std::sqrt(discriminant);
        double t = (-halfB - root) / a;
        if (t <= tMin || tMax <= t) {
            t = (-halfB + root) / a;
            if (t <= tMin || tMax <= t)
                return false;
        }
        hit = hitOf(ray, t, (ray.at(t) - centre_) / radius_, material_);
        return true;
    }
    PlainBox box() const override { return {centre_ - radius_, centre_ + radius_}; }

  private:
    dvec3 centre_;
    double radius_;
    const Material* material_;
};

class PlainQuad final : public PlainObject {
  public:
    PlainQuad(dvec3 corner, dvec3 u, dvec3 v, const Material* material)
        : corner_(corner), u_(u), v_(v), material_(material) {
        const dvec3 n = glm::cross(u, v);
        normal_ = glm::normalize(n);
        w_ = n / glm::dot(n, n);
    }
    bool meet(const PlainRay& ray, double tMin, double tMax, PlainHit& hit) const override {
        const double facing = glm::dot(normal_, ray.direction);
        if (std::abs(facing) < 1e-8)
            return false;
        const double t = glm::dot(normal_, corner_ - ray.origin) / facing;
        if (t <= tMin || tMax <= t)
            return false;
        const dvec3 off = ray.at(t) - corner_;
        const double a = glm::dot(w_, glm::cross(off, v_));
        const double b = glm::dot(w_, glm::cross(u_, off));
        if (a < 0 || a > 1 || b < 0 || b > 1)
            return false;
        hit = hitOf(ray, t, normal_, material_);
        return true;
    }
    PlainBox box() const override {
        PlainBox box;
        for (const dvec3 p : {corner_, corner_ + u_, corner_ + v_, corner_ + u_ + v_})
            box.extend({p - 1e-4, p + 1e-4});
        return box;
    }

  private:
    dvec3 corner_, u_, v_, normal_, w_;
    const Material* material_;
};

class PlainNode final : public PlainObject {
  public:
    PlainNode(std::vector<std::shared_ptr<PlainObject>>& objects, std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            box_.extend(objects[i]->box());
        const dvec3 size = box_.max - box_.min;
        const int axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
        if (last - first == 1) {
            left_ = right_ = objects[first];
            return;
        }
        const auto begin = objects.begin();
        std::sort(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(last),
                  [axis](const auto& a, const auto& b) { return a->box().min[axis] < b->box().min[axis]; });
        const std::size_t middle = first + (last - first) / 2;
        left_ = std::make_shared<PlainNode>(objects, first, middle);
        right_ = std::make_shared<PlainNode>(objects, middle, last);
    }
    bool meet(const PlainRay& ray, double tMin, double tMax, PlainHit& hit) const override {
        if (!box_.meets(ray, tMin, tMax))
            return false;
        const bool left = left_->meet(ray, tMin, tMax, hit);
        const bool right = right_->meet(ray, tMin, left ? hit.t : tMax, hit);
        return left || right;
    }
    PlainBox box() const override { return box_; }

  private:
    PlainBox box_;
    std::shared_ptr<PlainObject> left_;
    std::shared_ptr<PlainObject> right_;
};

/// The plain tracer: a scene of balls under the sky, or a box of rectangles with one that shines.
class Plain {
  public:
    explicit Plain(const PathSet& set) : set_(set), random_(7) {
        std::vector<std::shared_ptr<PlainObject>> objects;
        for (const TracedSolid& solid : set.solids)
            objects.push_back(std::make_shared<PlainSphere>(dvec3(solid.worldFromModel[3]),
                                                            std::get<Sphere>(solid.shape).radius,
                                                            &set.scene.materials[solid.material]));
        for (const Instance& instance : set.scene.instances) {
            const std::vector<glm::vec3>& p = set.scene.meshes[instance.mesh].positions;
            const Material* const material = &set.scene.materials[instance.material];
            objects.push_back(std::make_shared<PlainQuad>(p[0], dvec3(p[1]) - dvec3(p[0]),
                                                          dvec3(p[3]) - dvec3(p[0]), material));
            if (material->emission != glm::vec3(0))
                light_ = {dvec3(p[0]), dvec3(p[1]) - dvec3(p[0]), dvec3(p[3]) - dvec3(p[0])};
        }
        world_ = std::make_shared<PlainNode>(objects, 0, objects.size());
    }

    Image picture(int width, int height, int samples) {
        Image image(width, height, 4, Encoding::linear);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                dvec3 sum(0);
                for (int i = 0; i < samples; ++i) {
                    const glm::vec2 place(x + random_.uniformDouble(), y + random_.uniformDouble());
                    glm::vec2 lens(1);
                    while (glm::dot(lens, lens) > 1)
                        lens = {random_.uniform(-1, 1), random_.uniform(-1, 1)};
                    const Ray ray = cameraRay(set_.scene.cameras[0], width, height, place, lens);
                    sum += color({dvec3(ray.origin), dvec3(ray.direction)}, 50);
                }
                for (int c = 0; c < 3; ++c)
                    image.pixel(x, y)[c] = static_cast<float>(sum[c] / samples);
                image.pixel(x, y)[3] = 1;
            }
        return image;
    }
    std::uint64_t rays() const { return rays_; }

  private:
    dvec3 onSphere() {
        for (;;) {
            const dvec3 v(random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1));
            const double squared = glm::dot(v, v);
            if (squared > 1e-160 && squared <= 1)
                return v / std::sqrt(squared);
        }
    }

    dvec3 sky(const PlainRay& ray) const {
        if (!set_.scene.environment)
            return dvec3(0);
        const double share = 0.5 * (glm::normalize(ray.direction).y + 1);
        return glm::mix(dvec3(1), dvec3(0.5, 0.7, 1), share);
    }

    dvec3 color(const PlainRay& ray, int depth) {
        if (depth <= 0)
            return dvec3(0);
        ++rays_;
        PlainHit hit{};
        if (!world_->meet(ray, 0.001, std::numeric_limits<double>::infinity(), hit))
            return sky(ray);
        const Material& m = *hit.material;
        if (m.emission != glm::vec3(0))
            return hit.front ? dvec3(m.emission) : dvec3(0);
        const dvec3 unit = glm::normalize(ray.direction);
        const dvec3 tone(m.baseColor);
        if (m.transmission > 0) {
            const double ratio = hit.front ? 1 / static_cast<double>(m.ior) : static_cast<double>(m.ior);
            const double cosine = std::min(glm::dot(-unit, hit.normal), 1.0);
            const double sine = std::sqrt(1 - cosine * cosine);
            double r0 = (1 - ratio) / (1 + ratio);
            r0 *= r0;
            const double mirrored = r0 + (1 - r0) * std::pow(1 - cosine, 5);
            dvec3 direction;
            if (ratio * sine > 1 || mirrored > random_.uniformDouble())
                direction = glm::reflect(unit, hit.normal);
            else
                direction = glm::refract(unit, hit.normal, ratio);
            return color({hit.position, direction}, depth - 1);
        }
        if (m.metallic > 0) {
            const dvec3 direction =
                glm::reflect(unit, hit.normal) + static_cast<double>(m.roughness) * onSphere();
            return glm::dot(direction, hit.normal) > 0 ? tone * color({hit.position, direction}, depth - 1)
                                                       : dvec3(0);
        }
        if (!light_) {
            dvec3 direction = hit.normal + onSphere();
            if (glm::dot(direction, direction) < 1e-16)
                direction = hit.normal;
            return tone * color({hit.position, direction}, depth - 1);
        }
        // Half by the cosine, half towards the light.
        const auto& [corner, u, v] = *light_;
        dvec3 direction;
        if (random_.uniformDouble() < 0.5)
            direction = glm::normalize(corner + random_.uniformDouble() * u + random_.uniformDouble() * v -
                                       hit.position);
        else
            direction = glm::normalize(hit.normal + onSphere());
        const double cosine = glm::dot(direction, hit.normal);
        if (!(cosine > 0))
            return dvec3(0);
        double towards = 0;
        PlainHit there{};
        const PlainQuad shining(corner, u, v, hit.material);
        const PlainRay next{hit.position, direction};
        if (shining.meet(next, 0.001, std::numeric_limits<double>::infinity(), there)) {
            const double area = glm::length(glm::cross(u, v));
            towards = there.t * there.t / (std::abs(glm::dot(direction, there.normal)) * area);
        }
        const double pi = 3.14159265358979323846;
        const double density = 0.5 * cosine / pi + 0.5 * towards;
        return tone * (cosine / pi / density) * color(next, depth - 1);
    }

    struct Panel {
        dvec3 corner, u, v;
    };
    const PathSet& set_;
    Random random_;
    std::shared_ptr<PlainNode> world_;
    std::optional<Panel> light_;
    std::uint64_t rays_ = 0;
};

// Comparison ----------------------------------------------------------------------------------------------

/// Of RGB alone, as alpha is 1 in both.
double errorOf(const Image& exact, const Image& picture) {
    return rmse(exact, picture) * std::sqrt(4.0 / 3);
}

struct Work {
    double error = 0;
    double seconds = 0;
    double rays = 0;
};

void compare(const char* name, const PathSet& set, int width, int height, int plainSamples,
             PathMethod method) {
    Plain plain(set);
    // Errors from two independent pictures of as many samples: half of the squared difference is the
    // variance.
    Image a;
    Image b;
    Work theirs;
    theirs.seconds = processorSecondsOf([&] { a = plain.picture(width, height, plainSamples); });
    theirs.rays = static_cast<double>(plain.rays());
    b = plain.picture(width, height, plainSamples);
    theirs.error = errorOf(a, b) / std::sqrt(2.0);

    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const TraceScene traced(set.scene, set.solids);
    const PathScene paths(traced, set.model);
    RenderSettings settings{
        .width = width, .height = height, .camera = set.scene.cameras[0], .method = method};
    // Later roulette: longer paths, but fewer of them for the same error.
    settings.limits = {.maxBounces = 50, .rouletteThreshold = 0.1f};
    settings.seed = 11;
    ProgressiveRender reference(paths, settings);
    reference.addSamples(8 * plainSamples);
    const Image exact = reference.picture();
    settings.seed = 12;
    Work ours;
    int samples = 0;
    for (int wanted = 1; wanted <= 4 * plainSamples; wanted *= 2) {
        ProgressiveRender render(paths, settings);
        Work work;
        work.seconds = processorSecondsOf([&] { render.addSamples(wanted); });
        work.error = errorOf(exact, render.picture());
        work.rays = static_cast<double>(render.counts().rays());
        if (work.error < theirs.error && ours.error > theirs.error) {
            // Between two powers of two, along the line through both in logarithms.
            const double share = std::log(ours.error / theirs.error) / std::log(ours.error / work.error);
            work.seconds = ours.seconds * std::pow(work.seconds / ours.seconds, share);
            work.rays = ours.rays * std::pow(work.rays / ours.rays, share);
            work.error = theirs.error;
        }
        ours = work;
        samples = wanted;
        std::printf("  %-6s ours %4d samples: RMSE %.4f in %.3f s\n", name, wanted, work.error, work.seconds);
        if (work.error <= theirs.error)
            break;
    }
    std::printf("%-8s plain: %d samples, RMSE %.4f, %.2f s, %.2f Mrays/s\n", name, plainSamples, theirs.error,
                theirs.seconds, theirs.rays / theirs.seconds / 1e6);
    std::printf("%-8s ours:  at most %d samples, RMSE %.4f, %.2f s, %.2f Mrays/s: %.3f of the time\n", name,
                samples, ours.error, ours.seconds, ours.rays / ours.seconds / 1e6,
                ours.seconds / theirs.seconds);
}

/// The Cornell kind of box: rectangles, a light in the ceiling, two blocks.
PathSet makeBox() {
    PathSet set = makeChamber();
    set.model = OpaqueModel::lambert;
    set.solids = {{Sphere{0.6}, set.solids[0].material, glm::mat4(1)},
                  {Sphere{0.5}, set.solids[0].material, glm::mat4(1)}};
    set.solids[0].worldFromModel[3] = glm::vec4(-0.7f, 0.6f, -0.6f, 1);
    set.solids[1].worldFromModel[3] = glm::vec4(0.7f, 0.5f, 0.4f, 1);
    for (const TracedSolid& solid : set.solids)
        set.scene.materials[solid.material].transmission = 0;
    return set;
}

void scaling() {
    const PathSet set = makeChamber();
    const TraceScene traced(set.scene, set.solids);
    const PathScene paths(traced, set.model);
    std::vector<double> ratios;
    for (int i = 0; i < 5; ++i) {
        std::array<double, 2> seconds{};
        for (const int threads : {1, 2}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(threads));
            ProgressiveRender render(paths, {.width = 160, .height = 120, .camera = set.scene.cameras[0]});
            seconds[static_cast<std::size_t>(threads - 1)] = secondsOf([&] { render.addSamples(8); });
        }
        ratios.push_back(seconds[0] / seconds[1]);
    }
    std::sort(ratios.begin(), ratios.end());
    std::printf("two threads against one: %.2f times as fast (median of five)\n", ratios[2]);
}

}  // namespace

int main() {
    compare("balls", makeBallField(1), 200, 112, 64, PathMethod::naive);
    compare("box", makeBox(), 200, 200, 64, PathMethod::mis);
    scaling();
}
