#include "labs/26_ray_tracing/measure.h"

#include <algorithm>
#include <memory>

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

MailingFigures walkGrid(const MailboxGrid& grid, const std::vector<Ray>& rays, Mailing mailing, int threads) {
    MailingFigures figures;
    std::vector<Mailboxes> boxes(static_cast<std::size_t>(mailing == Mailing::perThread ? threads : 1),
                                 grid.mailboxes());
    const auto boxesOf = [&](std::size_t thread) -> Mailboxes* {
        return mailing == Mailing::none ? nullptr : &boxes[thread % boxes.size()];
    };
    const auto count = static_cast<std::size_t>(threads);
    for (std::size_t first = 0; first < rays.size(); first += count) {
        std::vector<std::unique_ptr<MailboxGrid::Walk>> walks;
        for (std::size_t k = 0; k < std::min(count, rays.size() - first); ++k)
            walks.push_back(std::make_unique<MailboxGrid::Walk>(grid, rays[first + k], boxesOf(k)));
        for (bool some = true; some;) {
            some = false;
            for (const auto& walk : walks)
                some = walk->step() || some;
        }
        for (std::size_t k = 0; k < walks.size(); ++k) {
            figures.tests += walks[k]->counts().triangles;
            if (mailing == Mailing::none)
                continue;
            TraversalCounts counts;
            const auto exact = grid.nearest(rays[first + k], nullptr, counts);
            const auto& got = walks[k]->hit();
            figures.wrongHits += exact.has_value() != got.has_value() ||
                                 (exact && (exact->t != got->t || exact->triangle != got->triangle));
        }
    }
    return figures;
}

}  // namespace quincunx
