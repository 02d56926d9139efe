#include "trace/bsp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "trace/mailbox.h"
#include "trace/shown_triangles.h"
#include "trace/slabs.h"
#include "trace/triangle_items.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t leafTriangles = 4;
constexpr std::size_t entriesPerTriangle = 8;

}  // namespace

/// A triangle and the part of its box that is in the cell.
struct Bsp::Clipped {
    Bounds box;
    std::uint32_t index = 0;
};

Bsp::Bsp(TriangleView triangles) : triangles_(triangles) {
    std::vector<Clipped> all;
    for (const detail::BvhItem& item : detail::itemsOf(triangles)) {
        all.push_back({{item.min, item.max}, item.index});
        box_.extend(all.back().box);
    }
    if (all.empty())
        return;
    nodes_.emplace_back();
    const std::size_t budget = entriesPerTriangle * all.size() + 64;
    build(std::move(all), 0, budget, 0);
}

/// `budget` is how many entries there may be below.
void Bsp::build(std::vector<Clipped> triangles, std::size_t node, std::size_t budget, int depth) {
    depth_ = std::max(depth_, depth);
    Bounds box;
    for (const Clipped& triangle : triangles)
        box.extend(triangle.box);
    // In halves, so that no size of a finite box is infinite.
    const glm::vec3 size = 0.5f * box.max - 0.5f * box.min;
    std::array<int, 3> axes = {0, 1, 2};
    std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return size[a] > size[b]; });
    for (const int axis : axes) {
        const float plane = 0.5f * box.min[axis] + 0.5f * box.max[axis];
        std::size_t left = 0;
        std::size_t right = 0;
        for (const Clipped& triangle : triangles) {
            left += triangle.box.min[axis] <= plane ? 1 : 0;
            right += triangle.box.max[axis] >= plane ? 1 : 0;
        }
        const bool divides = left < triangles.size() || right < triangles.size();
        if (triangles.size() <= leafTriangles || depth >= maxDepth || !divides || left == 0 || right == 0 ||
            left + right > budget)
            continue;
        std::vector<Clipped> lower;
        std::vector<Clipped> upper;
        lower.reserve(left);
        upper.reserve(right);
        for (const Clipped& triangle : triangles) {
            if (triangle.box.min[axis] <= plane) {
                lower.push_back(triangle);
                lower.back().box.max[axis] = std::min(triangle.box.max[axis], plane);
            }
            if (triangle.box.max[axis] >= plane) {
                upper.push_back(triangle);
                upper.back().box.min[axis] = std::max(triangle.box.min[axis], plane);
            }
        }
        triangles = {};
        const auto first = static_cast<std::uint32_t>(nodes_.size());
        nodes_.resize(nodes_.size() + 2);
        nodes_[node] = {first, 0, plane, axis};
        const std::size_t spare = budget - left - right;
        const std::size_t spareLeft = static_cast<std::size_t>(
            static_cast<double>(spare) * static_cast<double>(left) / static_cast<double>(left + right));
        build(std::move(lower), first, left + spareLeft, depth + 1);
        build(std::move(upper), first + 1, right + (spare - spareLeft), depth + 1);
        return;
    }
    nodes_[node].first = static_cast<std::uint32_t>(entries_.size());
    nodes_[node].count = static_cast<std::uint32_t>(triangles.size());
    for (const Clipped& triangle : triangles)
        entries_.push_back(triangle.index);
}

/// Shows `test(triangle index)` what the ray may meet; it returns the t up to which to look on.
template <typename Test>
void Bsp::search(const Ray& ray, RayInterval interval, TraversalCounts* counts, const Test& test) const {
    struct Entry {
        std::uint32_t node;
        double enter;
        double leave;
    };
    std::uint64_t planes = 0;
    std::uint64_t tests = 0;
    if (!nodes_.empty() && isUsable(ray) && interval.tMin <= interval.tMax) {
        const glm::dvec3 o(ray.origin);
        const glm::dvec3 d(ray.direction);
        double limit = infinity;
        detail::RayMailbox mailbox;
        std::array<Entry, maxDepth + 1> stack;
        std::size_t size = 0;
        double enter = 0;
        if (SlabRay<double>(ray).meets(box_.min, box_.max, interval.tMin, interval.tMax, enter))
            stack[size++] = {0, interval.tMin, interval.tMax};
        while (size > 0) {
            Entry entry = stack[--size];
            if (entry.enter > limit)
                continue;
            while (nodes_[entry.node].axis >= 0) {
                ++planes;
                const Node& node = nodes_[entry.node];
                const double distance = node.plane - o[node.axis];
                const double along = d[node.axis];
                if (along == 0) {
                    if (distance == 0)  // in the plane
                        stack[size++] = {node.first + 1, entry.enter, entry.leave};
                    entry.node = node.first + (distance < 0 ? 1 : 0);
                    continue;
                }
                const double t = distance / along;
                const double margin = 0x1p-48 * std::abs(t);
                const std::uint32_t nearer = node.first + (along < 0 ? 1 : 0);
                const std::uint32_t farther = node.first + (along < 0 ? 0 : 1);
                if (t - margin > entry.leave) {
                    entry.node = nearer;
                } else if (t + margin < entry.enter) {
                    entry.node = farther;
                } else {
                    stack[size++] = {farther, std::max(entry.enter, t - margin), entry.leave};
                    entry = {nearer, entry.enter, std::min(entry.leave, t + margin)};
                }
            }
            const Node& leaf = nodes_[entry.node];
            for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count && limit != -infinity; ++i)
                if (mailbox.enter(entries_[i])) {
                    ++tests;
                    limit = test(entries_[i]);
                }
            if (limit == -infinity)
                break;
        }
    }
    if (counts)
        *counts += {1, planes, tests};
}

std::optional<AcceleratorHit> Bsp::nearest(const Ray& ray, RayInterval interval,
                                           TraversalCounts* counts) const {
    return detail::nearestShown(triangles_, box_, ray, interval,
                                [&](const auto& test) { search(ray, interval, counts, test); });
}

bool Bsp::occluded(const Ray& ray, RayInterval interval, TraversalCounts* counts) const {
    return detail::anyShown(triangles_, box_, ray, interval,
                            [&](const auto& test) { search(ray, interval, counts, test); });
}

std::size_t Bsp::memoryBytes() const {
    return nodes_.capacity() * sizeof(Node) + entries_.capacity() * sizeof(std::uint32_t);
}

}  // namespace quincunx
