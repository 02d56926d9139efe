#include "labs/26_ray_tracing/measure.h"

#include <algorithm>

#include "trace/trace_scene.h"

namespace quincunx {

WhittedSettings recursionSettings(RecursionEnd end, int maxDepth, float minWeight, std::uint64_t seed) {
    WhittedSettings settings;
    settings.end = end;
    settings.maxDepth = maxDepth;
    settings.minWeight = minWeight;
    settings.shadowRays = 1;
    settings.pattern = SamplePattern::regular;
    settings.seed = seed;
    return settings;
}

Image recursionReference(const WhittedScene& scene, const Camera& camera, int width, int height) {
    return renderWhitted(scene, camera, width, height, recursionSettings(RecursionEnd::weight, 0, 0x1p-16f));
}

double meanLuminance(const Image& image) {
    double sum = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const float* const p = image.pixel(x, y);
            sum += 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
        }
    return sum / static_cast<double>(image.pixelCount());
}

std::vector<Ray> raysOfPicture(const WhittedScene& scene, const Camera& camera, int width, int height) {
    std::vector<Ray> rays;
    CsgScratch scratch;
    const AreaLight& lamp = scene.contents().lights.front();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Ray ray = cameraRay(camera, width, height, glm::vec2(x, y) + 0.5f);
            rays.push_back(ray);
            const auto hit = scene.nearest(ray, scratch, nullptr);
            if (!hit || hit->light >= 0)
                continue;
            const glm::vec3 way = lamp.at({0.5f, 0.5f}) - hit->point;
            rays.push_back({leaveSurface(hit->point, hit->pointError, hit->normal, way), way});
        }
    return rays;
}

}  // namespace quincunx
