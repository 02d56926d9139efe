#include "trace/grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trace/mailbox.h"
#include "trace/shown_triangles.h"
#include "trace/slabs.h"
#include "trace/triangle_items.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int maxResolution = 1 << 10;
constexpr double farthest = 0x1p30;     // sizes of the grid, from which rays are walked
constexpr double entryMargin = 0x1p-8;  // cells around a triangle
constexpr std::size_t entriesPerTriangle = 16;

}  // namespace

Grid::Grid(TriangleView triangles, const GridParams& params)
    : triangles_(triangles), mailboxes_(params.mailboxes) {
    detail::HugeVector<detail::BvhItem> items = detail::itemsOf(triangles);
    if (items.empty())
        return;
    for (const detail::BvhItem& item : items)
        box_.extend(Bounds{item.min, item.max});

    // Coarser until there are few enough entries, whatever the triangles overlap.
    double cells = params.cellsPerTriangle;
    for (;; cells /= 8) {
        chooseResolution(items.size(), cells);
        std::size_t entries = 0;
        for (const detail::BvhItem& item : items) {
            const CellRange range = cellsOf({item.min, item.max});
            const glm::ivec3 size = range.high - range.low + 1;
            entries += static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                       static_cast<std::size_t>(size.z);
        }
        if (entries <= entriesPerTriangle * items.size() + 64 || resolution_ == glm::ivec3(1))
            break;
    }

    const auto forEachCell = [&](const detail::BvhItem& item, const auto& visit) {
        const CellRange range = cellsOf({item.min, item.max});
        for (int z = range.low.z; z <= range.high.z; ++z)
            for (int y = range.low.y; y <= range.high.y; ++y)
                for (int x = range.low.x; x <= range.high.x; ++x)
                    visit(cellIndex({x, y, z}));
    };
    const glm::ivec3 last = resolution_ - 1;
    firstOfCell_.assign(cellIndex(last) + 2, 0);
    for (const detail::BvhItem& item : items)
        forEachCell(item, [&](std::size_t cell) { ++firstOfCell_[cell + 1]; });
    for (std::size_t cell = 1; cell < firstOfCell_.size(); ++cell)
        firstOfCell_[cell] += firstOfCell_[cell - 1];
    entries_.resize(firstOfCell_.back());
    std::vector<std::uint32_t> next(firstOfCell_.begin(), firstOfCell_.end() - 1);
    for (const detail::BvhItem& item : items)
        forEachCell(item, [&](std::size_t cell) { entries_[next[cell]++] = item.index; });
}

/// Cubes, as nearly as may be, `cellsPerTriangle` of them a triangle; axes along which the scene is thinner
/// than a cell are not cut.
void Grid::chooseResolution(std::size_t triangles, double cellsPerTriangle) {
    const glm::dvec3 min(box_.min);
    const glm::dvec3 max(box_.max);
    const glm::dvec3 extent = max - min;
    const double longest = std::max({extent.x, extent.y, extent.z});
    const double wanted = std::max(1.0, cellsPerTriangle * static_cast<double>(triangles));
    resolution_ = glm::ivec3(1);
    std::array<bool, 3> cut = {true, true, true};
    for (int round = 0; round < 3; ++round) {
        double logVolume = -std::log2(wanted);
        int axes = 0;
        for (int axis = 0; axis < 3; ++axis)
            if (cut[static_cast<std::size_t>(axis)] && extent[axis] > 0) {
                logVolume += std::log2(extent[axis]);
                ++axes;
            }
        if (axes == 0)
            break;
        const double size = std::exp2(logVolume / axes);
        for (int axis = 0; axis < 3; ++axis) {
            const bool thin = !(extent[axis] > size);
            if (thin)
                cut[static_cast<std::size_t>(axis)] = false;
            const double count = std::ceil(extent[axis] / size);
            resolution_[axis] = cut[static_cast<std::size_t>(axis)]
                                    ? static_cast<int>(std::min<double>(count, maxResolution))
                                    : 1;
        }
    }
    // Room around it for the margin of the entries, and so that no cell is without size: 2^-1000 is in reach
    // of double, and 2^-20 of the longest side is nothing among cells.
    const double room = std::max(longest * 0x1p-20, 0x1p-200);
    for (int axis = 0; axis < 3; ++axis) {
        origin_[axis] = min[axis] - room;
        cellSize_[axis] = (extent[axis] + 2 * room) / resolution_[axis];
    }
}

Grid::CellRange Grid::cellsOf(const Bounds& box) const {
    CellRange range;
    for (int axis = 0; axis < 3; ++axis) {
        const double low = (box.min[axis] - origin_[axis]) / cellSize_[axis] - entryMargin;
        const double high = (box.max[axis] - origin_[axis]) / cellSize_[axis] + entryMargin;
        const double last = resolution_[axis] - 1;
        range.low[axis] = static_cast<int>(std::clamp(std::floor(low), 0.0, last));
        range.high[axis] = static_cast<int>(std::clamp(std::floor(high), 0.0, last));
    }
    return range;
}

std::size_t Grid::cellIndex(glm::ivec3 cell) const {
    const glm::uvec3 c(cell);
    const glm::uvec3 size(resolution_);
    return (static_cast<std::size_t>(c.z) * size.y + c.y) * size.x + c.x;
}

/// Calls `visit(cell, t)` for the cells that the ray passes from tMin to tMax, t being where it leaves the
/// cell; goes on while that returns true. False where the ray starts too far away.
template <typename VisitCell>
bool Grid::walk(const Ray& ray, RayInterval interval, const VisitCell& visit) const {
    const glm::dvec3 o = glm::dvec3(ray.origin) - origin_;
    const glm::dvec3 d(ray.direction);
    const glm::dvec3 size = cellSize_ * glm::dvec3(resolution_);
    const double longest = std::max({size.x, size.y, size.z});
    if (std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)}) > farthest * longest)
        return false;
    double t = interval.tMin;
    double end = interval.tMax;
    for (int axis = 0; axis < 3; ++axis) {
        if (d[axis] == 0) {
            if (o[axis] < 0 || o[axis] > size[axis])
                return true;
            continue;
        }
        const double first = (d[axis] > 0 ? -o[axis] : size[axis] - o[axis]) / d[axis];
        const double second = (d[axis] > 0 ? size[axis] - o[axis] : -o[axis]) / d[axis];
        t = std::max(t, first);
        end = std::min(end, second);
    }
    // The grid reaches beyond all triangles by far more than these are off.
    if (!(t <= end))
        return true;

    glm::ivec3 cell;
    for (int axis = 0; axis < 3; ++axis) {
        const double place = d[axis] == 0 ? o[axis] : o[axis] + t * d[axis];
        cell[axis] =
            static_cast<int>(std::clamp(std::floor(place / cellSize_[axis]), 0.0, resolution_[axis] - 1.0));
    }
    const auto leaves = [&](int axis) {
        if (d[axis] == 0)
            return infinity;
        return ((cell[axis] + (d[axis] > 0 ? 1 : 0)) * cellSize_[axis] - o[axis]) / d[axis];
    };
    glm::dvec3 next(leaves(0), leaves(1), leaves(2));
    for (;;) {
        const int axis = next.x <= next.y ? (next.x <= next.z ? 0 : 2) : (next.y <= next.z ? 1 : 2);
        if (!visit(cell, next[axis]) || next[axis] > end)
            return true;
        cell[axis] += d[axis] > 0 ? 1 : -1;
        if (cell[axis] < 0 || cell[axis] >= resolution_[axis])
            return true;
        next[axis] = leaves(axis);
    }
}

std::vector<glm::ivec3> Grid::cellsAlong(const Ray& ray) const {
    std::vector<glm::ivec3> cells;
    if (!entries_.empty() && isUsable(ray))
        walk(ray, {}, [&](glm::ivec3 cell, double) {
            cells.push_back(cell);
            return true;
        });
    return cells;
}

/// Shows `test(triangle index)` what the ray may meet; it returns the t up to which to look on.
template <typename Test>
void Grid::search(const Ray& ray, RayInterval interval, TraversalCounts* counts, const Test& test) const {
    std::uint64_t cells = 0;
    std::uint64_t tests = 0;
    if (!entries_.empty() && isUsable(ray) && interval.tMin <= interval.tMax) {
        double limit = infinity;
        detail::RayMailbox mailbox;
        detail::ThreadMailboxes& mailboxes = detail::ThreadMailboxes::ofThisThread();
        if (mailboxes_ == Mailboxes::ofThread)
            mailboxes.startRay(triangles_.size());
        const auto isNew = [&](std::uint32_t triangle) {
            return mailboxes_ == Mailboxes::none ||
                   (mailboxes_ == Mailboxes::ofRay ? mailbox.enter(triangle) : mailboxes.enter(triangle));
        };
        const bool walked = walk(ray, interval, [&](glm::ivec3 cell, double leave) {
            ++cells;
            const std::size_t index = cellIndex(cell);
            for (std::uint32_t i = firstOfCell_[index]; i < firstOfCell_[index + 1]; ++i)
                if (isNew(entries_[i])) {
                    ++tests;
                    limit = test(entries_[i]);
                    if (limit == -infinity)
                        return false;
                }
            return !(limit < leave);
        });
        if (!walked)
            for (std::size_t i = 0; i < triangles_.size() && limit != -infinity; ++i) {
                ++tests;
                limit = test(static_cast<std::uint32_t>(i));
            }
    }
    if (counts)
        *counts += {1, cells, tests};
}

std::optional<AcceleratorHit> Grid::nearest(const Ray& ray, RayInterval interval,
                                            TraversalCounts* counts) const {
    return detail::nearestShown(triangles_, box_, ray, interval,
                                [&](const auto& test) { search(ray, interval, counts, test); });
}

bool Grid::occluded(const Ray& ray, RayInterval interval, TraversalCounts* counts) const {
    return detail::anyShown(triangles_, box_, ray, interval,
                            [&](const auto& test) { search(ray, interval, counts, test); });
}

std::size_t Grid::memoryBytes() const {
    return (firstOfCell_.capacity() + entries_.capacity()) * sizeof(std::uint32_t);
}

}  // namespace quincunx
