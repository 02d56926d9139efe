// Rays against triangles: rays per second of each way, scalar and packed, beside Embree in the same run, and
// beside what the vector units allow for the packed forms' operations.

#include "geometry/ray_triangle.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <embree3/rtcore.h>

#include "base/vector_units.h"
#include "math/stress_inputs.h"

namespace {

using namespace quincunx;

constexpr std::size_t rayCount = 4096;  // with t, 112 KiB: in the second cache

/// Operations on vectors for a ray and a triangle.
struct Operations {
    int multiplications;
    int additions;  ///< and subtractions
    int divisions;
    int comparisons;  ///< also minima, maxima, selections, and their combinations
    int sizes;        ///< absolute values
};

// Counted in certainLane and naiveLane of geometry/ray_triangle_packed.cpp: two cross products (6 and 3
// each), four dot products (3 and 2 each), the difference of the origins (3).
constexpr Operations naiveOperations = {.multiplications = 2 * 6 + 4 * 3 + 3,
                                        .additions = 3 + 2 * 3 + 4 * 2 + 1,
                                        .divisions = 1,
                                        .comparisons = 5 + 4 + 1,
                                        .sizes = 0};
// Besides: w (1), the sums of sizes (4), the two limits of range (2 additions, 1 product), the bounds (5
// products).
constexpr Operations stableOperations = {.multiplications = 2 * 6 + 4 * 3 + 3 + 5,
                                         .additions = 3 + 2 * 3 + 4 * 2 + 2 + 4 + 2,
                                         .divisions = 1,
                                         .comparisons = 2 + 6 + 6 + 2,
                                         .sizes = 6 + 3};

/// As many operations of each kind on registers alone, in chains that do not wait for one another:
/// multiplications and additions in six each, so that four cycles of latency are covered, comparisons with
/// selections in three.
template <typename Lanes, int Multiplications, int Additions, int Divisions, int Others>
QUINCUNX_ALWAYS_INLINE float runMix(std::size_t repeats) {
    constexpr int steps = std::max(Multiplications, Additions);
    std::array<Lanes, 6> products;
    std::array<Lanes, 6> sums;
    std::array<Lanes, 3> others;
    for (std::size_t i = 0; i < 6; ++i) {
        products[i] = Lanes{} + static_cast<float>(i + 1);
        sums[i] = products[i];
        others[i % 3] = products[i];
    }
    Lanes quotient = Lanes{} + 3.0f;
    const Lanes factor = Lanes{} + 0.999f;
    const Lanes summand = Lanes{} + 0.001f;
    for (std::size_t r = 0; r < repeats; ++r) {
        for (int i = 0; i < Divisions; ++i)
            quotient = factor / quotient;
#pragma GCC unroll 64
        for (int i = 0; i < steps; ++i) {
            const auto chain = static_cast<std::size_t>(i % 6);
            if (i < Multiplications)
                products[chain] = products[chain] * factor;
            if (i < Additions)
                sums[chain] = sums[chain] + summand;
            // A comparison and a selection are two.
            if (i < Others / 2)
                others[chain % 3] = others[chain % 3] < sums[chain] ? products[chain] : others[chain % 3];
        }
    }
    float sum = quotient[0];
    for (std::size_t i = 0; i < 6; ++i)
        sum += products[i][0] + sums[i][0] + others[i % 3][0];
    return sum;
}

using FourLanes = float __attribute__((vector_size(16)));
using EightLanes = float __attribute__((vector_size(32)));
using SixteenLanes = float __attribute__((vector_size(64)));

template <typename Lanes, const Operations& count>
QUINCUNX_ALWAYS_INLINE float runMix(std::size_t repeats) {
    return runMix<Lanes, count.multiplications, count.additions, count.divisions,
                  count.comparisons + count.sizes>(repeats);
}

#if defined(__x86_64__)
template <const Operations& count>
__attribute__((target("avx512f"))) float runMix512(std::size_t lanes) {
    return runMix<SixteenLanes, count>(lanes / 16);
}
template <const Operations& count>
__attribute__((target("avx2"))) float runMix256(std::size_t lanes) {
    return runMix<EightLanes, count>(lanes / 8);
}
#endif

/// The same for so many floats, in the widest vectors of this machine.
template <const Operations& count>
float runMixOfMachine(std::size_t lanes) {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f"))
        return runMix512<count>(lanes);
    if (__builtin_cpu_supports("avx2"))
        return runMix256<count>(lanes);
#endif
    return runMix<FourLanes, count>(lanes / 4);
}

volatile float sink = 0;

/// The least time of several runs of `work`, in nanoseconds for each of `items`: what the machine can do when
/// nobody else takes its time.
double nanoseconds(std::size_t items, const std::function<void()>& work) {
    double best = std::numeric_limits<double>::infinity();
    for (int run = 0; run < 60; ++run) {
        const auto start = std::chrono::steady_clock::now();
        for (int repeat = 0; repeat < 4; ++repeat)
            work();
        const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
        best = std::min(best, time.count() / 4 / static_cast<double>(items));
    }
    return best;
}

struct Row {
    std::string name;
    double nanosecondsEach;
};

/// A scene of one triangle.
class EmbreeTriangle {
  public:
    EmbreeTriangle(const Triangle& triangle, RTCSceneFlags flags)
        : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
        rtcSetSceneFlags(scene_, flags);
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* corners = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                                    RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3));
        auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), 1));
        for (int i = 0; i < 3; ++i) {
            corners[i] = triangle.a[i];
            corners[3 + i] = triangle.b[i];
            corners[6 + i] = triangle.c[i];
            indices[i] = static_cast<unsigned>(i);
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
    }
    ~EmbreeTriangle() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    EmbreeTriangle(const EmbreeTriangle&) = delete;
    EmbreeTriangle& operator=(const EmbreeTriangle&) = delete;

    void one(const std::vector<Ray>& rays, std::vector<float>& t) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            RTCRayHit hit{};
            hit.ray.org_x = rays[i].origin.x;
            hit.ray.org_y = rays[i].origin.y;
            hit.ray.org_z = rays[i].origin.z;
            hit.ray.dir_x = rays[i].direction.x;
            hit.ray.dir_y = rays[i].direction.y;
            hit.ray.dir_z = rays[i].direction.z;
            hit.ray.tfar = std::numeric_limits<float>::infinity();
            hit.ray.mask = ~0u;
            hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(scene_, &context, &hit);
            t[i] = hit.ray.tfar;
        }
    }

    void sixteen(const RayArrays& rays, std::vector<float>& t) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        alignas(64) std::array<int, 16> valid;
        valid.fill(-1);
        RTCRayHit16 hit{};
        for (std::size_t i = 0; i < rays.size(); i += 16) {
            std::copy_n(&rays.origin[0][i], 16, hit.ray.org_x);
            std::copy_n(&rays.origin[1][i], 16, hit.ray.org_y);
            std::copy_n(&rays.origin[2][i], 16, hit.ray.org_z);
            std::copy_n(&rays.direction[0][i], 16, hit.ray.dir_x);
            std::copy_n(&rays.direction[1][i], 16, hit.ray.dir_y);
            std::copy_n(&rays.direction[2][i], 16, hit.ray.dir_z);
            std::fill_n(hit.ray.tnear, 16, 0.0f);
            std::fill_n(hit.ray.tfar, 16, std::numeric_limits<float>::infinity());
            std::fill_n(hit.ray.mask, 16, ~0u);
            std::fill_n(hit.hit.geomID, 16, RTC_INVALID_GEOMETRY_ID);
            rtcIntersect16(valid.data(), scene_, &context, &hit);
            std::copy_n(hit.ray.tfar, 16, &t[i]);
        }
    }

  private:
    RTCDevice device_;
    RTCScene scene_;
};

}  // namespace

int main() {
    // A camera in front of a triangle that fills half of its picture.
    const Triangle triangle{{-1, -1, -3}, {1, -1, -3.5f}, {0, 1, -2.5f}};
    StressInputs draw(1);
    RayArrays packed;
    std::vector<Ray> rays;
    TriangleArrays triangles;
    std::vector<Triangle> triangleList;
    for (std::size_t i = 0; i < rayCount; ++i) {
        const Ray ray{{0.1f, 0.2f, 0.3f},
                      glm::vec3(draw.random().uniform(-0.35, 0.35), draw.random().uniform(-0.35, 0.35), -1)};
        rays.push_back(ray);
        packed.add(ray);
        const glm::vec3 shift(draw.random().uniform(-1, 1), draw.random().uniform(-1, 1),
                              draw.random().uniform(-1, 1));
        const Triangle moved{triangle.a + shift, triangle.b + shift, triangle.c + shift};
        triangleList.push_back(moved);
        triangles.add(moved);
    }
    std::vector<float> t(rayCount);

    std::vector<Row> rows;
    const auto scalar = [&](const char* name, const auto& intersect) {
        rows.push_back({name, nanoseconds(rayCount, [&] {
                            for (std::size_t i = 0; i < rayCount; ++i) {
                                const auto hit = intersect(rays[i], triangle);
                                t[i] =
                                    hit ? static_cast<float>(hit->t) : std::numeric_limits<float>::infinity();
                            }
                            sink = t[rayCount / 2];
                        })});
    };
    std::printf("One ray at a time\n");
    scalar("Moeller-Trumbore, naive", intersectMollerTrumboreNaive);
    scalar("Pluecker, naive", intersectPlueckerNaive);
    scalar("Woop et al., naive", intersectWoopNaive);
    const char* const names[] = {"plane + crossings, naive",   "plane + angle sum, naive",
                                 "plane + areas, naive",       "plane + triangle fan, naive",
                                 "plane + Pluecker 2D, naive", "plane + cross products, naive"};
    for (const InsideMethod method : insideMethods)
        scalar(names[static_cast<int>(method)],
               [method](const Ray& ray, const Triangle& t1) { return intersectPlaneNaive(ray, t1, method); });
    scalar("intersectTriangle, exact",
           [](const Ray& ray, const Triangle& one) { return intersectTriangle(ray, one); });
    std::vector<Ray> atEdges;
    for (const Ray& ray : rays) {
        const glm::dvec3 target =
            glm::mix(glm::dvec3(triangle.a), glm::dvec3(triangle.b), draw.random().uniform(0, 1));
        atEdges.push_back({ray.origin, glm::vec3(target - glm::dvec3(ray.origin))});
    }
    rows.push_back({"intersectTriangle, rays at an edge", nanoseconds(rayCount, [&] {
                        for (std::size_t i = 0; i < rayCount; ++i) {
                            const auto hit = intersectTriangle(atEdges[i], triangle);
                            t[i] = hit ? static_cast<float>(hit->t) : std::numeric_limits<float>::infinity();
                        }
                        sink = t[rayCount / 2];
                    })});
    const ShearedRay sheared(rays[0]);
    rows.push_back({"ShearedRay of many triangles, exact", nanoseconds(rayCount, [&] {
                        for (std::size_t i = 0; i < rayCount; ++i) {
                            const auto hit = sheared.intersect(triangleList[i]);
                            t[i] = hit ? static_cast<float>(hit->t) : std::numeric_limits<float>::infinity();
                        }
                        sink = t[rayCount / 2];
                    })});
    const EmbreeTriangle fast(triangle, RTC_SCENE_FLAG_NONE);
    const EmbreeTriangle robust(triangle, RTC_SCENE_FLAG_ROBUST);
    rows.push_back({"Embree, rtcIntersect1", nanoseconds(rayCount, [&] { fast.one(rays, t); })});
    rows.push_back({"Embree robust, rtcIntersect1", nanoseconds(rayCount, [&] { robust.one(rays, t); })});
    const double naiveScalar = rows[0].nanosecondsEach;
    for (const Row& row : rows)
        std::printf("  %-38s %8.2f ns  %8.1f M rays/s  %6.2fx\n", row.name.c_str(), row.nanosecondsEach,
                    1e3 / row.nanosecondsEach, row.nanosecondsEach / naiveScalar);

    std::size_t doubtful = 0;
    const double naiveRays =
        nanoseconds(rayCount, [&] { intersectMollerTrumborePackedNaive(packed, triangle, t); });
    const double stableRays = nanoseconds(rayCount, [&] { doubtful = intersectPacked(packed, triangle, t); });
    const double hits = static_cast<double>(std::count_if(
        t.begin(), t.end(), [](float x) { return x < std::numeric_limits<float>::infinity(); }));
    const double naiveTriangles =
        nanoseconds(rayCount, [&] { intersectMollerTrumborePackedNaive(rays[0], triangles, t); });
    std::size_t doubtfulTriangles = 0;
    const double stableTriangles =
        nanoseconds(rayCount, [&] { doubtfulTriangles = intersectPacked(rays[0], triangles, t); });
    const double embreeFast = nanoseconds(rayCount, [&] { fast.sixteen(packed, t); });
    const double embreeRobust = nanoseconds(rayCount, [&] { robust.sixteen(packed, t); });
    const double naiveLimit =
        nanoseconds(rayCount, [&] { sink = runMixOfMachine<naiveOperations>(rayCount); });
    const double stableLimit =
        nanoseconds(rayCount, [&] { sink = runMixOfMachine<stableOperations>(rayCount); });
    const auto print = [](const char* name, double time, double reference) {
        std::printf("  %-38s %8.3f ns  %8.1f M rays/s  %6.2fx\n", name, time, 1e3 / time, time / reference);
    };
    std::printf("\nPacked, %.0f %% hits; times those of packed Moeller-Trumbore\n",
                100 * hits / static_cast<double>(rayCount));
    print("rays, Moeller-Trumbore, naive", naiveRays, naiveRays);
    print("rays, exact decisions", stableRays, naiveRays);
    print("triangles, Moeller-Trumbore, naive", naiveTriangles, naiveRays);
    print("triangles, exact decisions", stableTriangles, naiveRays);
    print("Embree, rtcIntersect16", embreeFast, naiveRays);
    print("Embree robust, rtcIntersect16", embreeRobust, naiveRays);
    std::printf("  left to the scalar routine: %zu and %zu of %zu\n", doubtful, doubtfulTriangles, rayCount);

    const auto printLimit = [](const char* name, const Operations& count, double limit, double time) {
        std::printf(
            "  %-16s %d mul, %d add, %d div, %d compare/select, %d abs: %.3f ns on registers; "
            "measured %.3f ns, %.2fx\n",
            name, count.multiplications, count.additions, count.divisions, count.comparisons, count.sizes,
            limit, time, time / limit);
    };
    std::printf("\nOperations for a ray, and what the vector units allow\n");
    printLimit("naive", naiveOperations, naiveLimit, naiveRays);
    printLimit("exact decisions", stableOperations, stableLimit, stableRays);
    return 0;
}
