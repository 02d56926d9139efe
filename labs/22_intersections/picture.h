#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "image/image.h"
#include "labs/22_intersections/exhibit.h"
#include "scene/scene.h"

namespace quincunx {

/// The camera of the lab: moved back by `distance` and narrowed by as much, so that what is seen around
/// `target` keeps its size.
struct Lens {
    glm::dvec3 eye{0};
    glm::dvec3 right{1, 0, 0};
    glm::dvec3 up{0, 1, 0};
    glm::dvec3 forward{0, 0, -1};
    double halfHeight = 1;  ///< of what is seen at `reach`
    double reach = 1;       ///< from the eye to the target
    double aspect = 1;

    /// The ray through a place of the picture, (0,0) at its top left, (1,1) at its bottom right: what a
    /// program has, rounded to float.
    Ray rayAt(double x, double y) const;
    /// Of the world less `place`.
    glm::dmat4 clipFromLocal(glm::dvec3 place) const;
};
Lens makeLens(const Camera& camera, glm::dvec3 target, double distance, glm::dvec3 place, double aspect);

/// How an answer about a ray differs from that of exact arithmetic.
/// A hit where there is none, or before the first one; no hit where there is one, or one behind it; or the
/// right shape, but t off.
enum class Verdict { right, falseHit, falseMiss, wrongT };

struct Judged {
    Verdict verdict = Verdict::right;
    double ulps = 0;  ///< of t as a float, for hits of the right shape
};

/// The nearest exhibit along a ray.
struct Seen {
    int exhibit = -1;  ///< −1: none
    RayHit hit;
};
Seen look(const std::vector<Exhibit>& exhibits, const Ray& ray, const Approach& approach);
/// An answer against that of exact arithmetic on the same ray; t is wrong from an error of 0.51 ulp. The
/// forms without a bound are judged by those with one, which decide exactly and whose t is within 0.004 ulp;
/// these, by exact arithmetic itself.
Judged judge(const std::vector<Exhibit>& exhibits, const Ray& ray, const Approach& approach);

struct Cast {
    Image color;  ///< RGBA, linear; alpha is OpenGL's window depth, for what is drawn over it
    std::map<std::string, std::uint64_t> counts;
};

/// What a picture of `samples`² rays a pixel shows by a method: lit, with shadows. When `stop` becomes true,
/// the remaining rows are left at zero.
Cast castScene(const std::vector<Exhibit>& exhibits, const Lens& lens, const glm::dmat4& clipFromWorld,
               int width, int height, const Approach& approach, int samples,
               const std::atomic<bool>* stop = nullptr);

/// The same in grey and darkened, one ray a pixel, with the pixels where the method is wrong in colours.
Cast castMap(const std::vector<Exhibit>& exhibits, const Lens& lens, const glm::dmat4& clipFromWorld,
             int width, int height, const Approach& approach);

/// The colours of the map, linear.
glm::vec3 colorOf(const Judged& judged);

}  // namespace quincunx
