#include "labs/18_environment_mapping/mirror_figures.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <vector>

#include <glm/glm.hpp>

#include "base/check.h"
#include "trace/environment_glsl.h"

namespace quincunx {
namespace {

int mirrorAt(const Image& vectors, int x, int y) {
    return static_cast<int>(vectors.pixel(x, y)[3]);
}

bool isInside(const Image& vectors, int x, int y, int mirror) {
    for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, vectors.height - 1); ++ny)
        for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, vectors.width - 1); ++nx)
            if (mirrorAt(vectors, nx, ny) != mirror)
                return false;
    return true;
}

glm::dvec3 rgb(const Image& image, int x, int y) {
    const float* const pixel = image.pixel(x, y);
    return {pixel[0], pixel[1], pixel[2]};
}

/// The unit direction of a texel's middle, and the angle that the texel takes up.
struct Texel {
    glm::dvec3 direction;
    double steradians;
};

Texel texelOf(int face, int x, int y, int size) {
    const glm::dvec2 xy((2 * x + 1.0) / size - 1, (2 * y + 1.0) / size - 1);
    const glm::dmat3 axes(glsl::cubeFaceAxes(face));
    const double squared = 1 + glm::dot(xy, xy);
    return {(axes[2] + xy.x * axes[0] + xy.y * axes[1]) / std::sqrt(squared),
            4 / (static_cast<double>(size) * size * squared * std::sqrt(squared))};
}

}  // namespace

MirrorFigures compareMirrors(const Image& drawn, const Image& traced, const Image& vectors, int mirror) {
    QX_CHECK_EQ(drawn.width, traced.width);
    QX_CHECK_EQ(drawn.height, traced.height);
    QX_CHECK_EQ(drawn.width, vectors.width);
    QX_CHECK_EQ(drawn.height, vectors.height);
    MirrorFigures figures;
    double sum = 0;
    for (int y = 0; y < drawn.height; ++y)
        for (int x = 0; x < drawn.width; ++x) {
            if (!isInside(vectors, x, y, mirror))
                continue;
            const glm::dvec3 off = glm::abs(rgb(drawn, x, y) - rgb(traced, x, y));
            sum += (off.x + off.y + off.z) / 3;
            ++figures.pixels;
        }
    if (figures.pixels > 0)
        figures.meanError = sum / static_cast<double>(figures.pixels);
    return figures;
}

double vectorSpread(const Image& vectors, int mirror) {
    glm::dvec3 sum(0);
    for (int y = 0; y < vectors.height; ++y)
        for (int x = 0; x < vectors.width; ++x)
            if (mirrorAt(vectors, x, y) == mirror)
                sum += rgb(vectors, x, y);
    if (sum == glm::dvec3(0))
        return 0;
    const glm::dvec3 mean = glm::normalize(sum);
    double squares = 0;
    std::size_t count = 0;
    for (int y = 0; y < vectors.height; ++y)
        for (int x = 0; x < vectors.width; ++x)
            if (mirrorAt(vectors, x, y) == mirror) {
                const glm::dvec3 d = rgb(vectors, x, y);
                const double angle = std::atan2(glm::length(glm::cross(d, mean)), glm::dot(d, mean));
                squares += angle * angle;
                ++count;
            }
    return std::sqrt(squares / static_cast<double>(count));
}

double meanAngle(const Image& angles, int mirror) {
    double sum = 0;
    std::size_t count = 0;
    for (int y = 0; y < angles.height; ++y)
        for (int x = 0; x < angles.width; ++x)
            if (mirrorAt(angles, x, y) == mirror) {
                sum += angles.pixel(x, y)[0];
                ++count;
            }
    return count > 0 ? sum / static_cast<double>(count) : 0;
}

double shareOfMap(const Image& vectors, int mirror, int size) {
    std::set<std::tuple<int, int, int>> texels;
    for (int y = 0; y < vectors.height; ++y)
        for (int x = 0; x < vectors.width; ++x)
            if (mirrorAt(vectors, x, y) == mirror) {
                const glm::vec3 place = glsl::cubePlace(glm::vec3(rgb(vectors, x, y)));
                const auto index = [&](float s) {
                    return std::min(static_cast<int>(s * static_cast<float>(size)), size - 1);
                };
                texels.emplace(static_cast<int>(place.z), index(place.x), index(place.y));
            }
    return static_cast<double>(texels.size()) / (6.0 * size * size);
}

double prefilterError(const std::vector<Image>& source, const std::vector<Image>& level, double alpha,
                      int stride) {
    QX_CHECK_EQ(source.size(), 6u);
    QX_CHECK_EQ(level.size(), 6u);
    struct Lit {
        Texel texel;
        glm::dvec3 light;
    };
    std::vector<Lit> lights;
    const int sourceSize = source.front().width;
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < sourceSize; ++y)
            for (int x = 0; x < sourceSize; ++x)
                lights.push_back(
                    {texelOf(face, x, y, sourceSize), rgb(source[static_cast<std::size_t>(face)], x, y)});
    const int size = level.front().width;
    double squares = 0;
    double mean = 0;
    int count = 0;
    const double a2 = alpha * alpha;
    for (int i = 0; i < 6 * size * size; i += stride) {
        const int face = i / (size * size);
        const int x = i % size;
        const int y = i / size % size;
        const glm::dvec3 n = texelOf(face, x, y, size).direction;
        glm::dvec3 sum(0);
        double weight = 0;
        for (const Lit& lit : lights) {
            const double cosine = glm::dot(n, lit.texel.direction);
            if (cosine <= 0)
                continue;
            // The half vector's cosine, squared: (1 + n·l) / 2. Directions by D/4, weighted with the cosine.
            const double c2 = 0.5 * (1 + cosine);
            const double root = (1 - c2) + a2 * c2;
            const double share = cosine / (root * root) * lit.texel.steradians;
            sum += share * lit.light;
            weight += share;
        }
        const glm::dvec3 exact = sum / weight;
        const glm::dvec3 off = rgb(level[static_cast<std::size_t>(face)], x, y) - exact;
        squares += glm::dot(off, off) / 3;
        mean += (exact.x + exact.y + exact.z) / 3;
        ++count;
    }
    return std::sqrt(squares / count) / (mean / count);
}

}  // namespace quincunx
