#include "trace/mirror.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "math/transform.h"

namespace quincunx {
namespace {

constexpr int width = 48;
constexpr int height = 36;

/// With white mirrors.
MirrorHall whiteHall() {
    MirrorHall hall = makeMirrorHall();
    hall.ballTint = hall.panelTint = glm::vec3(1);
    return hall;
}

glm::dvec3 panelNormal(const MirrorHall& hall) {
    return glm::normalize(glm::cross(glm::dvec3(hall.panel.edgeU), glm::dvec3(hall.panel.edgeV)));
}

/// What is seen in a plane, as a placement: x − 2 n (n · (x − p)).
glm::dmat4 mirrorIn(const glm::dvec3& point, const glm::dvec3& n) {
    const glm::dmat3 turn = glm::dmat3(1) - 2.0 * glm::outerProduct(n, n);
    glm::dmat4 mirror(turn);
    mirror[3] = glm::dvec4(2 * glm::dot(n, point) * n, 1);
    return mirror;
}

/// The unit direction through a pixel's centre.
glm::dvec3 directionThrough(const Camera& camera, int x, int y) {
    const double tangent = std::tan(0.5 * static_cast<double>(camera.fovYRadians));
    const double right = (2 * (x + 0.5) / width - 1) * tangent * width / height;
    const double up = (1 - 2 * (y + 0.5) / height) * tangent;
    return glm::normalize(glm::dmat3(camera.worldFromCamera) * glm::dvec3(right, up, -1));
}

template <typename Check>
void forPixelsOf(const Image& mirrors, int which, int atLeast, const Check& check) {
    int pixels = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            if (mirrors.pixel(x, y)[3] == static_cast<float>(which)) {
                check(x, y);
                ++pixels;
            }
    EXPECT_GE(pixels, atLeast);
}

double distance(const float* a, const float* b) {
    return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

TEST(Mirror, APlaneShowsWhatTheMirroredCameraSees) {
    // The hall without solids, so that nothing stands between the mirrored eye and the plane; walls are seen
    // from the front alone.
    const MirrorHall hall = emptied(whiteHall());
    const Camera& camera = hall.contents.camera;
    Camera mirrored = camera;
    mirrored.worldFromCamera = glm::mat4(mirrorIn(glm::dvec3(hall.panel.corner), panelNormal(hall)) *
                                         glm::dmat4(camera.worldFromCamera));
    const Image vectors = traceReflectionVectors(hall, camera, width, height);
    const Image picture = traceMirrors(hall, camera, width, height);
    const Image seen = traceMirrors(hall, mirrored, width, height, {false, false});
    int off = 0;
    forPixelsOf(vectors, 2, 30,
                [&](int x, int y) { off += distance(picture.pixel(x, y), seen.pixel(x, y)) > 1e-4; });
    // A ray at the very edge of a tile may fall to the other side: the mirrored camera is rounded to float.
    EXPECT_LE(off, 1);  // measured 0
}

TEST(Mirror, ReflectionVectorsAreThoseOfTheBallAndOfThePlane) {
    const MirrorHall hall = whiteHall();
    const Camera& camera = hall.contents.camera;
    const Image vectors = traceReflectionVectors(hall, camera, width, height);
    const glm::dvec3 eye(camera.worldFromCamera[3]);
    const auto expectVector = [&](int x, int y, const glm::dvec3& expected) {
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(vectors.pixel(x, y)[c], expected[c], 1e-6) << x << " " << y;
    };
    forPixelsOf(vectors, 1, 30, [&](int x, int y) {
        const glm::dvec3 d = directionThrough(camera, x, y);
        const glm::dvec3 m = eye - glm::dvec3(hall.ball.centre);
        const double radius = hall.ball.radius;
        const double b = glm::dot(m, d);
        const double t = -b - std::sqrt(b * b - (glm::dot(m, m) - radius * radius));
        const glm::dvec3 n = (m + t * d) / radius;
        expectVector(x, y, d - 2 * glm::dot(n, d) * n);
    });
    forPixelsOf(vectors, 2, 30, [&](int x, int y) {
        const glm::dvec3 d = directionThrough(camera, x, y);
        expectVector(x, y, d - 2 * glm::dot(panelNormal(hall), d) * panelNormal(hall));
    });
}

TEST(Mirror, TintsMultiplyAndWhatIsNoMirrorStaysAsItIs) {
    MirrorHall hall = whiteHall();
    const Camera& camera = hall.contents.camera;
    const Image vectors = traceReflectionVectors(hall, camera, width, height);
    const Image white = traceMirrors(hall, camera, width, height);
    const Image none = traceMirrors(hall, camera, width, height, {false, false});
    hall.ballTint = {0.5f, 0.25f, 1};
    hall.panelTint = {1, 0.5f, 0.25f};
    const Image tinted = traceMirrors(hall, camera, width, height);
    const auto expectTimes = [&](const Image& image, const glm::vec3& tint) {
        return [&image, &tinted, tint](int x, int y) {
            for (int c = 0; c < 3; ++c)
                ASSERT_EQ(tinted.pixel(x, y)[c], tint[c] * image.pixel(x, y)[c]) << x << " " << y;
        };
    };
    forPixelsOf(vectors, 0, 100, expectTimes(none, glm::vec3(1)));
    forPixelsOf(vectors, 1, 30, expectTimes(white, hall.ballTint));
    forPixelsOf(vectors, 2, 30, expectTimes(white, hall.panelTint));
}

TEST(Mirror, ALookupByDirectionAloneIsRightForWhatIsFarAway) {
    const MirrorHall hall = whiteHall();
    const Camera& camera = hall.contents.camera;
    const glm::vec3 at = hall.ball.centre;
    const auto worst = [&](const MirrorHall& seen) {
        const Image angles = traceLookupAngles(seen, camera, width, height, at, {true, false});
        double most = 0;
        forPixelsOf(angles, 1, 30,
                    [&](int x, int y) { most = std::max(most, static_cast<double>(angles.pixel(x, y)[0])); });
        return most;
    };
    // What the ball shows is seen from its surface, a radius from its centre: an angle of asin(r / distance)
    // at most. Things a thousand times as far away are off by a thousandth.
    const double near = worst(emptied(hall));
    const double far = worst(movedAway(emptied(hall), at, 1000));
    EXPECT_GT(near, 0.3);  // measured 0.58, and 4.8e-4 far away
    EXPECT_LT(far, 1e-2 * near);
}

TEST(Mirror, APanoramaShowsInEachDirectionWhatACameraSeesThere) {
    const MirrorHall hall = whiteHall();
    const glm::vec3 position = hall.ball.centre + glm::vec3(0, 1.5f * hall.ball.radius, 0);
    constexpr int wide = 16;
    constexpr int high = 8;
    const Image panorama = tracePanorama(hall, position, wide, high, 1);
    for (int y = 0; y < high; ++y)
        for (int x = 0; x < wide; ++x) {
            const double around = 2 * std::numbers::pi * ((x + 0.5) / wide - 0.5);
            const double down = std::numbers::pi * (y + 0.5) / high;
            const glm::vec3 direction(std::sin(down) * std::cos(around), std::cos(down),
                                      std::sin(down) * std::sin(around));
            Camera camera;
            camera.worldFromCamera = lookAt(position, position + direction, {0.1f, 1, 0.2f});
            const Image seen = traceMirrors(hall, camera, 1, 1, {false, false});
            EXPECT_LT(distance(panorama.pixel(x, y), seen.pixel(0, 0)), 1e-3) << x << " " << y;
        }
}

TEST(Mirror, AStopLeavesRowsAtZero) {
    const MirrorHall hall = whiteHall();
    const std::atomic<bool> stop = true;
    const Image picture = traceMirrors(hall, hall.contents.camera, width, height, {}, &stop);
    EXPECT_TRUE(std::all_of(picture.data.begin(), picture.data.end(), [](float x) { return x == 0; }));
}

}  // namespace
}  // namespace quincunx
