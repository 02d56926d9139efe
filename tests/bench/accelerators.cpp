// Structures over triangles: rays a second and time to build, beside Embree in the same run, on the same
// meshes with the same rays. Every figure is the median of interleaved runs, in CPU time of the thread.
//
//     bench_accelerators [mesh [repeats [rays]]]    blob, town, waves, all; camera, diffuse, random, shadow
//     bench_accelerators gaps [millions]            rays at edges and corners that miss a closed surface

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <embree3/rtcore.h>
#include <glm/gtc/constants.hpp>
#include <oneapi/tbb/global_control.h>

#include "base/random.h"
#include "geometry/shapes.h"
#include "scene/town.h"
#include "trace/accelerator.h"
#include "trace/slabs.h"

namespace {

using namespace quincunx;

struct Model {
    std::string name;
    std::vector<glm::vec3> positions = {};
    std::vector<std::uint32_t> indices = {};
    glm::vec3 eye{0};
    glm::vec3 target{0};
    float width = 1;  ///< of the picture, at distance 1

    TriangleView view() const { return {positions, indices}; }
};

/// A ball with bumps of several sizes, as a scanned figure has them.
Model makeBlob() {
    const Mesh mesh = tessellate(Sphere{1}, 264);
    Model model{.name = "blob", .positions = mesh.positions, .indices = mesh.indices};
    for (glm::vec3& p : model.positions) {
        double height = 1;
        for (int octave = 0; octave < 6; ++octave) {
            const double frequency = 2.1 * std::exp2(octave);
            height += 0.22 * std::exp2(-octave) *
                      (std::sin(frequency * p.x + octave) * std::cos(frequency * p.y + 2 * octave) +
                       std::sin(frequency * p.z + 3 * octave));
        }
        p *= static_cast<float>(height);
    }
    model.eye = {1.5f, 1.2f, 3.2f};
    model.width = 0.9f;
    return model;
}

Model makeTownModel() {
    const Town town = makeTown();
    Model model;
    model.name = "town";
    for (const Instance& instance : town.scene.instances) {
        const Mesh& mesh = town.scene.meshes[instance.mesh];
        const auto first = static_cast<std::uint32_t>(model.positions.size());
        for (const glm::vec3& p : mesh.positions)
            model.positions.emplace_back(instance.worldFromModel * glm::vec4(p, 1));
        for (const std::uint32_t i : mesh.indices)
            model.indices.push_back(first + i);
    }
    model.eye = {-30, 9, 40};
    model.target = {0, 4, 0};
    model.width = 1.2f;
    return model;
}

Model makeWaves() {
    constexpr int side = 708;  // 2 · 708² triangles
    Model model;
    model.name = "waves";
    for (int z = 0; z <= side; ++z)
        for (int x = 0; x <= side; ++x) {
            const double u = 20.0 * x / side - 10;
            const double v = 20.0 * z / side - 10;
            const double y = 0.5 * std::sin(1.7 * u) * std::cos(1.3 * v) + 0.15 * std::sin(5 * u + 3 * v) +
                             0.04 * std::sin(19 * u) * std::sin(23 * v);
            model.positions.emplace_back(u, y, v);
        }
    for (std::uint32_t z = 0; z < side; ++z)
        for (std::uint32_t x = 0; x < side; ++x) {
            const std::uint32_t a = z * (side + 1) + x;
            const std::uint32_t c = a + side + 1;
            for (const std::uint32_t i : {a, c, a + 1, a + 1, c, c + 1})
                model.indices.push_back(i);
        }
    model.eye = {6, 3, 9};
    return model;
}

struct RaySet {
    std::string name;
    std::vector<Ray> rays;
    bool shadow = false;
    RayInterval interval;
};

glm::vec3 onSphere(Random& random) {
    const double z = random.uniform(-1, 1);
    const double angle = random.uniform(0, 2 * glm::pi<double>());
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
}

/// Pixels along the Z curve, so that any power of two of rays that follow one another fills a square or two.
std::vector<Ray> cameraRays(const Model& model, int side) {
    const glm::vec3 forward = glm::normalize(model.target - model.eye);
    const glm::vec3 right = glm::normalize(glm::cross(forward, glm::vec3(0, 1, 0)));
    const glm::vec3 up = glm::cross(right, forward);
    std::vector<Ray> rays;
    for (int i = 0; i < side * side; ++i) {
        int x = 0;
        int y = 0;
        for (int bit = 0; bit < 12; ++bit) {
            x |= (i >> (2 * bit) & 1) << bit;
            y |= (i >> (2 * bit + 1) & 1) << bit;
        }
        const float u = model.width * ((static_cast<float>(x) + 0.5f) / static_cast<float>(side) - 0.5f);
        const float v = model.width * ((static_cast<float>(y) + 0.5f) / static_cast<float>(side) - 0.5f);
        rays.push_back({model.eye, glm::normalize(forward + u * right - v * up)});
    }
    return rays;
}

std::vector<RaySet> makeRays(const Model& model, const Accelerator& structure) {
    Random random(5);
    std::vector<RaySet> sets(4);
    sets[0] = {.name = "camera", .rays = cameraRays(model, 512), .shadow = false, .interval = {}};
    sets[1] = {.name = "diffuse", .rays = {}, .shadow = false, .interval = {}};
    sets[2] = {.name = "random", .rays = {}, .shadow = false, .interval = {}};
    sets[3] = {.name = "shadow", .rays = {}, .shadow = true, .interval = {0, 1}};
    Bounds box;
    for (const glm::vec3& p : model.positions)
        box.extend(p);
    const glm::vec3 light = box.centre() + glm::vec3(0.6f, 1.5f, 0.4f) * box.radius();
    for (const Ray& ray : sets[0].rays) {
        const auto hit = structure.nearest(ray);
        if (!hit)
            continue;
        const Triangle triangle = model.view()[hit->triangle];
        glm::vec3 normal = glm::normalize(glm::cross(triangle.b - triangle.a, triangle.c - triangle.a));
        if (glm::dot(normal, ray.direction) > 0)
            normal = -normal;
        const glm::vec3 point =
            ray.origin + static_cast<float>(hit->t) * ray.direction + 1e-4f * box.radius() * normal;
        sets[1].rays.push_back({point, glm::normalize(normal + 0.999f * onSphere(random))});
        sets[3].rays.push_back({point, light + 0.05f * box.radius() * onSphere(random) - point});
    }
    for (int i = 0; i < 150000; ++i) {
        const glm::vec3 from = box.centre() + box.radius() * onSphere(random);
        const glm::vec3 to = box.centre() + box.radius() * onSphere(random);
        if (from != to)
            sets[2].rays.push_back({from, glm::normalize(to - from)});
    }
    return sets;
}

double cpuSeconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
}

class EmbreeScene {
  public:
    explicit EmbreeScene(const Model& model, RTCSceneFlags flags = RTC_SCENE_FLAG_NONE)
        : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
        rtcSetSceneFlags(scene_, flags);
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12,
                                                 model.positions.size());
        std::copy_n(model.positions.data(), model.positions.size(), static_cast<glm::vec3*>(vertices));
        void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                                model.indices.size() / 3);
        std::copy_n(model.indices.data(), model.indices.size(), static_cast<std::uint32_t*>(indices));
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        const double start = cpuSeconds();
        rtcCommitScene(scene_);
        buildSeconds_ = cpuSeconds() - start;
    }
    ~EmbreeScene() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    double buildSeconds() const { return buildSeconds_; }

    std::uint64_t single(const RaySet& set) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        std::uint64_t hits = 0;
        for (const Ray& ray : set.rays) {
            RTCRayHit rayHit{};
            rayHit.ray = {ray.origin.x,
                          ray.origin.y,
                          ray.origin.z,
                          set.interval.tMin,
                          ray.direction.x,
                          ray.direction.y,
                          ray.direction.z,
                          0,
                          set.interval.tMax,
                          ~0u,
                          0,
                          0};
            rayHit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            if (set.shadow) {
                rtcOccluded1(scene_, &context, &rayHit.ray);
                hits += rayHit.ray.tfar < 0 ? 1 : 0;
            } else {
                rtcIntersect1(scene_, &context, &rayHit);
                hits += rayHit.hit.geomID != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
            }
        }
        return hits;
    }

    std::uint64_t packets(const RaySet& set) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = set.name == "camera" ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                             : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
        alignas(32) std::array<int, 8> valid;
        valid.fill(-1);
        std::uint64_t hits = 0;
        for (std::size_t begin = 0; begin + 8 <= set.rays.size(); begin += 8) {
            alignas(32) RTCRayHit8 rayHit{};
            for (std::size_t i = 0; i < 8; ++i) {
                const Ray& ray = set.rays[begin + i];
                rayHit.ray.org_x[i] = ray.origin.x;
                rayHit.ray.org_y[i] = ray.origin.y;
                rayHit.ray.org_z[i] = ray.origin.z;
                rayHit.ray.dir_x[i] = ray.direction.x;
                rayHit.ray.dir_y[i] = ray.direction.y;
                rayHit.ray.dir_z[i] = ray.direction.z;
                rayHit.ray.tnear[i] = set.interval.tMin;
                rayHit.ray.tfar[i] = set.interval.tMax;
                rayHit.ray.mask[i] = ~0u;
                rayHit.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
            }
            if (set.shadow)
                rtcOccluded8(valid.data(), scene_, &context, &rayHit.ray);
            else
                rtcIntersect8(valid.data(), scene_, &context, &rayHit);
            for (std::size_t i = 0; i < 8; ++i)
                hits +=
                    (set.shadow ? rayHit.ray.tfar[i] < 0 : rayHit.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID)
                        ? 1
                        : 0;
        }
        return hits;
    }

  private:
    RTCDevice device_;
    RTCScene scene_;
    double buildSeconds_ = 0;
};

std::uint64_t single(const Accelerator& structure, const RaySet& set) {
    std::uint64_t hits = 0;
    for (const Ray& ray : set.rays)
        hits += (set.shadow ? structure.occluded(ray, set.interval)
                            : structure.nearest(ray, set.interval).has_value())
                    ? 1
                    : 0;
    return hits;
}

std::uint64_t packets(const Accelerator& structure, const RaySet& set) {
    constexpr std::size_t batch = 1024;
    std::array<std::optional<AcceleratorHit>, batch> hits;
    std::uint64_t found = 0;
    for (std::size_t begin = 0; begin < set.rays.size(); begin += batch) {
        const std::size_t size = std::min(batch, set.rays.size() - begin);
        structure.nearestOfEach({&set.rays[begin], size}, set.interval, {hits.data(), size});
        for (std::size_t i = 0; i < size; ++i)
            found += hits[i] ? 1 : 0;
    }
    return found;
}

/// Rays from inside the blob, which is closed, at corners and at places on edges: how many miss it.
void countGaps(std::size_t rays) {
    const Model model = makeBlob();
    const auto wide = makeAccelerator(Structure::wideBvh, model.view());
    const EmbreeScene embree(model);
    const EmbreeScene robust(model, RTC_SCENE_FLAG_ROBUST);
    Random random(11);
    std::array<std::uint64_t, 3> missed{};
    std::array<double, 3> seconds{};
    for (std::size_t done = 0; done < rays; done += 100000) {
        RaySet set{.name = "gaps", .rays = {}, .shadow = false, .interval = {}};
        for (int i = 0; i < 100000; ++i) {
            const Triangle triangle = model.view()[random.below(model.view().size())];
            const glm::vec3 from = 0.1f * onSphere(random);
            const float along = i % 4 == 0 ? 0 : random.uniform();
            set.rays.push_back({from, glm::mix(triangle.a, triangle.b, along) - from});
        }
        const auto time = [&](std::size_t which, const auto& trace) {
            const double start = cpuSeconds();
            missed[which] += set.rays.size() - trace();
            seconds[which] += cpuSeconds() - start;
        };
        time(0, [&] { return single(*wide, set); });
        time(1, [&] { return embree.single(set); });
        time(2, [&] { return robust.single(set); });
    }
    const auto millions = static_cast<double>(rays) * 1e-6;
    std::printf("\n%.0f million rays from inside the blob at corners and edges\n", millions);
    const std::array<const char*, 3> names = {"wide", "Embree", "Embree robust"};
    for (std::size_t i = 0; i < names.size(); ++i)
        std::printf("  %-14s %9llu missed (%.4f%%), %.2f Mrays/s\n", names[i],
                    static_cast<unsigned long long>(missed[i]),
                    100 * static_cast<double>(missed[i]) / static_cast<double>(rays), millions / seconds[i]);
}

/// How many times faster two threads are than one, each with half of the rays, by the clock on the wall: what
/// others do on the machine counts.
double gainOfTwoThreads(const std::function<std::uint64_t(const RaySet&)>& trace, const RaySet& set,
                        int repeats) {
    std::array<RaySet, 2> halves = {set, set};
    const auto middle = static_cast<std::ptrdiff_t>(set.rays.size() / 2048 * 1024);
    halves[0].rays.resize(static_cast<std::size_t>(middle));
    halves[1].rays.erase(halves[1].rays.begin(), halves[1].rays.begin() + middle);
    const auto secondsOf = [](const auto& work) {
        const auto start = std::chrono::steady_clock::now();
        work();
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    std::vector<double> gains;
    for (int i = 0; i < repeats; ++i) {
        const double one = secondsOf([&] {
            for (const RaySet& half : halves)
                trace(half);
        });
        const double two = secondsOf([&] {
            std::thread other([&] { trace(halves[1]); });
            trace(halves[0]);
            other.join();
        });
        gains.push_back(one / two);
    }
    return median(gains);
}

struct Contender {
    const char* name;
    std::function<std::uint64_t(const RaySet&)> trace;
    std::vector<double> seconds = {};
    std::uint64_t hits = 0;
};

void measure(const Model& model, int repeats, const std::string& only) {
    std::printf("\n%s: %zu triangles\n", model.name.c_str(), model.view().size());
    std::vector<double> buildOurs;
    std::vector<double> buildTheirs;
    std::unique_ptr<Accelerator> wide;
    std::unique_ptr<EmbreeScene> embree;
    {
        const oneapi::tbb::global_control oneThread(oneapi::tbb::global_control::max_allowed_parallelism, 1);
        for (int i = 0; i < std::max(3, repeats / 2); ++i) {
            embree = std::make_unique<EmbreeScene>(model);
            buildTheirs.push_back(embree->buildSeconds());
            const double start = cpuSeconds();
            wide = makeAccelerator(Structure::wideBvh, model.view());
            buildOurs.push_back(cpuSeconds() - start);
        }
    }
    const auto binary = makeAccelerator(Structure::binaryBvh, model.view());
    const EmbreeScene robust(model, RTC_SCENE_FLAG_ROBUST);
    std::printf(
        "  build, one thread: wide %.1f ms, Embree %.1f ms: %.2f times; %.1f bytes a triangle (binary "
        "%.1f)\n",
        median(buildOurs) * 1e3, median(buildTheirs) * 1e3, median(buildOurs) / median(buildTheirs),
        static_cast<double>(wide->memoryBytes()) / static_cast<double>(model.view().size()),
        static_cast<double>(binary->memoryBytes()) / static_cast<double>(model.view().size()));

    std::printf("  Mrays/s   %8s %8s %8s %8s %8s %8s | %8s %8s %8s\n", "wide", "packets", "binary", "Embree",
                "robust", "of 8", "single", "packets", "to binary");
    for (const RaySet& set : makeRays(model, *wide)) {
        if (!only.empty() && set.name != only)
            continue;
        std::vector<Contender> contenders = {
            {"wide", [&](const RaySet& s) { return single(*wide, s); }},
            {"packets", [&](const RaySet& s) { return s.shadow ? 0 : packets(*wide, s); }},
            {"binary", [&](const RaySet& s) { return single(*binary, s); }},
            {"Embree", [&](const RaySet& s) { return embree->single(s); }},
            {"robust", [&](const RaySet& s) { return robust.single(s); }},
            {"of 8", [&](const RaySet& s) { return embree->packets(s); }},
        };
        for (int i = 0; i < repeats; ++i)
            for (Contender& contender : contenders) {
                const double start = cpuSeconds();
                contender.hits = contender.trace(set);
                contender.seconds.push_back(cpuSeconds() - start);
            }
        std::vector<double> speed;
        for (const Contender& contender : contenders)
            speed.push_back(static_cast<double>(set.rays.size()) * 1e-6 / median(contender.seconds));
        const bool packed = contenders[1].hits != 0;
        TraversalCounts counts;
        for (const Ray& ray : set.rays)
            if (set.shadow)
                wide->occluded(ray, set.interval, &counts);
            else
                wide->nearest(ray, set.interval, &counts);
        const auto perRay = [&](std::uint64_t total) {
            return static_cast<double>(total) / static_cast<double>(counts.rays);
        };
        std::printf(
            "  %-8s  %8.2f %8.2f %8.2f %8.2f %8.2f %8.2f | %7.2fx %7.2fx %7.2fx | %.1f nodes, %.1f triangles "
            "a ray; %llu hits, "
            "Embree %llu\n",
            set.name.c_str(), speed[0], packed ? speed[1] : 0, speed[2], speed[3], speed[4], speed[5],
            speed[0] / speed[3], packed ? speed[1] / speed[5] : 0, speed[0] / speed[2], perRay(counts.nodes),
            perRay(counts.triangles), static_cast<unsigned long long>(contenders[0].hits),
            static_cast<unsigned long long>(contenders[3].hits));
        std::printf("            two threads, times one:");
        for (const Contender& contender : contenders)
            if (contender.hits != 0)
                std::printf("  %s %.2f", contender.name, gainOfTwoThreads(contender.trace, set, repeats));
        std::printf("\n");
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::string which = argc > 1 ? argv[1] : "all";
    const int repeats = argc > 2 ? std::atoi(argv[2]) : 7;
    const std::string only = argc > 3 ? argv[3] : "";
    if (which == "blob" || which == "all")
        measure(makeBlob(), repeats, only);
    if (which == "town" || which == "all")
        measure(makeTownModel(), repeats, only);
    if (which == "gaps" || which == "all")
        countGaps(which == "gaps" ? static_cast<std::size_t>(repeats) * 1000000 : 1000000);
    if (which == "waves" || which == "all")
        measure(makeWaves(), repeats, only);
}
