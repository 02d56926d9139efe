#include "labs/12_texture_filtering/floor.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include "base/random.h"

namespace quincunx {

FloorView::FloorView(const Camera& camera, int width, int height, double repeats)
    : repeats_(repeats), width_(width), height_(height) {
    const glm::dmat4 worldFromCamera(camera.worldFromCamera);
    const double halfHeight = std::tan(0.5 * static_cast<double>(camera.fovYRadians));
    const double perPixel = 2 * halfHeight / height;
    const glm::dmat3 cameraFromPixel(glm::dvec3(perPixel, 0, 0), glm::dvec3(0, perPixel, 0),
                                     glm::dvec3(-0.5 * width * perPixel, -halfHeight, -1));
    rayFromPixel_ = glm::dmat3(worldFromCamera) * cameraFromPixel;
    eye_ = glm::dvec3(worldFromCamera[3]);
}

FloorView::Place FloorView::at(glm::dvec2 pixel) const {
    const glm::dvec3 ray = rayFromPixel_ * glm::dvec3(pixel, 1);
    Place place;
    if (!(ray.y * eye_.y < 0))
        return place;
    const double reach = -eye_.y / ray.y;
    const double distance = reach * glm::length(ray);
    place.visibility = std::exp(-distance / hazeDistance);
    place.floor = place.visibility > 0;
    place.st = repeats_ * glm::dvec2(eye_.x + reach * ray.x, eye_.z + reach * ray.z);
    // The quotient rule, for (ray.x, ray.z) / ray.y.
    const auto derivative = [&](const glm::dvec3& d) {
        return repeats_ * reach / ray.y * glm::dvec2(d.x * ray.y - ray.x * d.y, d.z * ray.y - ray.z * d.y);
    };
    place.alongX = derivative(rayFromPixel_[0]);
    place.alongY = derivative(rayFromPixel_[1]);
    return place;
}

glm::dvec3 FloorView::color(const Place& place, glm::dvec2 pixel, glm::dvec3 texture) const {
    const glm::dvec3 ray = rayFromPixel_ * glm::dvec3(pixel, 1);
    const double up = std::abs(ray.y) / glm::length(ray);
    const glm::dvec3 sky = glm::mix(horizonColor, zenithColor, std::sqrt(up));
    return place.floor ? glm::mix(horizonColor, texture, place.visibility) : sky;
}

Image floorPicture(const MipTexture& texture, const SamplerSettings& settings, const FloorView& view) {
    Image image(view.width(), view.height(), 4, Encoding::linear);
    tbb::parallel_for(0, image.height, [&](int row) {
        for (int x = 0; x < image.width; ++x) {
            const glm::dvec2 pixel(x + 0.5, image.height - row - 0.5);
            const FloorView::Place place = view.at(pixel);
            glm::dvec3 color(0);
            if (place.floor)
                color = glm::dvec3(sampleTexture(texture, settings, place.point()).color);
            color = view.color(place, pixel, color);
            float* const to = image.pixel(x, row);
            for (int c = 0; c < 3; ++c)
                to[c] = static_cast<float>(color[c]);
            to[3] = 1;
        }
    });
    return image;
}

Image floorReference(const MipTexture& texture, TextureWrap wrap, const FloorView& view, int side,
                     const std::atomic<bool>& stop, std::uint64_t seed) {
    SamplerSettings settings;
    settings.wrapS = settings.wrapT = wrap;
    settings.minification = Minification::bilinear;
    Image image(view.width(), view.height(), 4, Encoding::linear);
    tbb::parallel_for(0, image.height, [&](int row) {
        if (stop)
            return;
        for (int x = 0; x < image.width; ++x) {
            Random random(seed +
                          0x1000193 *
                              (static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(image.width)) +
                          static_cast<std::uint64_t>(x));
            glm::dvec3 sum(0);
            for (int j = 0; j < side; ++j)
                for (int i = 0; i < side; ++i) {
                    const glm::dvec2 pixel(x + (i + random.uniformDouble()) / side,
                                           image.height - 1 - row + (j + random.uniformDouble()) / side);
                    const FloorView::Place place = view.at(pixel);
                    glm::dvec3 color(0);
                    if (place.floor)
                        color = glm::dvec3(sampleTextureLod(texture, settings, glm::vec2(place.st), 0).color);
                    sum += view.color(place, pixel, color);
                }
            float* const to = image.pixel(x, row);
            for (int c = 0; c < 3; ++c)
                to[c] = static_cast<float>(sum[c] / (side * side));
            to[3] = 1;
        }
    });
    return image;
}

FloorCounts countFloor(const MipTexture& texture, const SamplerSettings& settings, const FloorView& view) {
    // Probes of a pixel share their level, and so read as many texels as the first of them.
    const bool probes = settings.minification == Minification::anisotropic;
    SamplerSettings unbiased = settings;
    unbiased.lodBias = 0;
    const auto countRow = [&](int y) {
        FloorCounts counts;
        for (int x = 0; x < view.width(); ++x) {
            const FloorView::Place place = view.at({x + 0.5, y + 0.5});
            if (!place.floor)
                continue;
            const TexturePoint point = place.point();
            const Footprint footprint = footprintOf(point, texture.width(), texture.height(),
                                                    probes ? settings.maxAnisotropy : 1, settings.lodBias);
            const int texels =
                footprint.probes * sampleTextureLod(texture, unbiased, point.st, footprint.lambda).texels;
            ++counts.samples;
            counts.texels += static_cast<std::uint64_t>(texels);
            counts.probes += static_cast<std::uint64_t>(footprint.probes);
            counts.mostTexels = std::max(counts.mostTexels, texels);
        }
        return counts;
    };
    return tbb::parallel_reduce(
        tbb::blocked_range<int>(0, view.height()), FloorCounts{},
        [&](const tbb::blocked_range<int>& rows, FloorCounts sum) {
            for (int y = rows.begin(); y < rows.end(); ++y)
                sum += countRow(y);
            return sum;
        },
        [](FloorCounts a, const FloorCounts& b) { return a += b; });
}

}  // namespace quincunx
