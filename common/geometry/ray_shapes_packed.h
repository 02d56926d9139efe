#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "geometry/ray_shapes.h"
#include "geometry/ray_triangle.h"

/// Many rays against a ball or a box, and a ray against many: arrays of coordinates, so that a vector unit
/// does as many at a time as it has lanes. `t` has an entry for each pair: infinity where there is no hit.
///
/// Hit or miss is decided exactly, as `raySphere` and `rayBox` do: float arithmetic with a bound on its
/// rounding errors settles nearly all pairs, and the scalar routines those that it leaves open. t is within
/// 2^-14 of its value, relative, as far as float's range lets. Held by PackedRayShapes.*.
/// They take 0.9 to 1.15 times what the machine's vector units need for the operations, and 1.6 to 2.1 times
/// the textbook's form (bench_intersect).
namespace quincunx {

struct BallArrays {
    std::array<std::vector<float>, 3> centre;
    std::vector<float> radius;

    std::size_t size() const { return radius.size(); }
    void add(const Ball& ball);
    Ball at(std::size_t index) const;
};

struct BoxArrays {
    std::array<std::vector<float>, 3> min;
    std::array<std::vector<float>, 3> max;

    std::size_t size() const { return min[0].size(); }
    void add(const Bounds& box);
    Bounds at(std::size_t index) const;
};

/// The nearest t ≥ 0 on the sphere. Returns how many pairs were left to the scalar routine.
std::size_t intersectPacked(const RayArrays& rays, const Ball& ball, std::span<float> t);
std::size_t intersectPacked(const Ray& ray, const BallArrays& balls, std::span<float> t);

/// Where the ray enters the box: 0 from inside. Returns how many pairs were left to the scalar routine.
std::size_t intersectPacked(const RayArrays& rays, const Bounds& box, std::span<float> t);
std::size_t intersectPacked(const Ray& ray, const BoxArrays& boxes, std::span<float> t);

/// The textbook's quadratic and the flashcard's slabs (tmin < tmax, tmax ≥ 0), in float alone.
void intersectPackedNaive(const RayArrays& rays, const Ball& ball, std::span<float> t);
void intersectPackedNaive(const Ray& ray, const BallArrays& balls, std::span<float> t);
void intersectPackedNaive(const RayArrays& rays, const Bounds& box, std::span<float> t);
void intersectPackedNaive(const Ray& ray, const BoxArrays& boxes, std::span<float> t);

}  // namespace quincunx
