#include "trace/bvh_build.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>
#include <oneapi/tbb/parallel_reduce.h>

#include "base/check.h"
#include "base/vector_units.h"
#include "trace/bvh_items.h"

namespace quincunx {
namespace {

using detail::BvhItem;
using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

constexpr int maxBins = 16;
constexpr int heuristicDepth = 40;
constexpr std::size_t taskItems = 4096;       // fewer are not worth a task
constexpr std::size_t parallelItems = 65536;  // fewer are binned by one thread
constexpr float infinity = std::numeric_limits<float>::infinity();

QUINCUNX_ALWAYS_INLINE Float4 smaller(Float4 a, Float4 b) {
    return a < b ? a : b;
}
QUINCUNX_ALWAYS_INLINE Float4 larger(Float4 a, Float4 b) {
    return a > b ? a : b;
}
QUINCUNX_ALWAYS_INLINE Float4 load(const glm::vec3& v) {
    return Float4{v.x, v.y, v.z, 0};
}

/// A box whose fourth coordinate means nothing.
struct Box {
    Float4 min = Float4{} + infinity;
    Float4 max = Float4{} - infinity;

    QUINCUNX_ALWAYS_INLINE void extend(const Box& other) {
        min = smaller(min, other.min);
        max = larger(max, other.max);
    }
    QUINCUNX_ALWAYS_INLINE void extend(Float4 point) {
        min = smaller(min, point);
        max = larger(max, point);
    }
};

QUINCUNX_ALWAYS_INLINE Box boxOf(const BvhItem& item) {
    return {load(item.min), load(item.max)};
}

/// A quarter of the box: its sizes, and the sum of its corners, which is half its centre, are finite for any
/// finite box. Sizes of cost and place are all taken from these.
QUINCUNX_ALWAYS_INLINE Box quarterOf(const Box& box) {
    return {0.25f * box.min, 0.25f * box.max};
}
QUINCUNX_ALWAYS_INLINE Float4 placeOf(const Box& box) {
    return 0.25f * box.min + 0.25f * box.max;
}

/// Items begin … end−1 and what holds them.
struct Range {
    std::size_t begin = 0;
    std::size_t end = 0;
    Box box;
    Box places;

    std::size_t size() const { return end - begin; }
    QUINCUNX_ALWAYS_INLINE void hold(const Box& item) {
        box.extend(item);
        places.extend(placeOf(item));
    }
    void join(const Range& other) {
        box.extend(other.box);
        places.extend(other.places);
    }
};

/// Which bin a place falls in, for each axis.
struct Binning {
    int count = maxBins;
    Float4 origin{};
    Float4 scale{};

    explicit Binning(const Range& range) : origin(range.places.min) {
        count = static_cast<int>(std::min<std::size_t>(maxBins, 4 + range.size() / 16));
        for (int axis = 0; axis < 3; ++axis) {
            // A little less than `count`, so that the largest place falls in the last bin. Extents that are
            // nearly nothing are taken for nothing: their reciprocal would overflow.
            const float extent = range.places.max[axis] - range.places.min[axis];
            scale[axis] = extent > 0x1p-100f ? static_cast<float>(count) * (1 - 0x1p-20f) / extent : 0;
        }
    }
    QUINCUNX_ALWAYS_INLINE Int4 binOf(Float4 place) const {
        return __builtin_convertvector((place - origin) * scale, Int4);
    }
};

struct Split {
    float cost = infinity;
    int axis = -1;
    int bin = 0;  ///< items of this bin and above go right
};

class Bins {
  public:
    explicit Bins(int count) : count_(count) {
        for (int axis = 0; axis < 3; ++axis)
            for (int i = 0; i < count; ++i) {
                boxes_[axis][i] = Box{};
                counts_[axis][i] = 0;
            }
    }

    void add(const BvhItem* begin, const BvhItem* end, const Binning& binning) {
        for (const BvhItem* item = begin; item != end; ++item) {
            const Box box = boxOf(*item);
            const Box quarter = quarterOf(box);
            const Int4 bin = binning.binOf(quarter.min + quarter.max);
            for (int axis = 0; axis < 3; ++axis) {
                boxes_[axis][bin[axis]].extend(quarter);
                ++counts_[axis][bin[axis]];
            }
        }
    }

    void join(const Bins& other) {
        for (int axis = 0; axis < 3; ++axis)
            for (int i = 0; i < count_; ++i) {
                boxes_[axis][i].extend(other.boxes_[axis][i]);
                counts_[axis][i] += other.counts_[axis][i];
            }
    }

    /// The least of: area left · tests left + area right · tests right, areas in `1/scale²`.
    Split best(float scale, std::uint32_t itemsATest) const {
        Split split;
        for (int axis = 0; axis < 3; ++axis) {
            std::array<float, maxBins> rightCost;
            Box box;
            std::uint32_t count = 0;
            for (int i = count_ - 1; i > 0; --i) {
                box.extend(boxes_[axis][i]);
                count += counts_[axis][i];
                rightCost[i] = count == 0 ? infinity : halfArea(box, scale) * tests(count, itemsATest);
            }
            box = Box{};
            count = 0;
            for (int i = 1; i < count_; ++i) {
                box.extend(boxes_[axis][i - 1]);
                count += counts_[axis][i - 1];
                if (count == 0)
                    continue;
                const float cost = halfArea(box, scale) * tests(count, itemsATest) + rightCost[i];
                if (cost < split.cost)
                    split = {cost, axis, i};
            }
        }
        return split;
    }

    static float tests(std::uint32_t items, std::uint32_t itemsATest) {
        return static_cast<float>((items + itemsATest - 1) / itemsATest);
    }
    static float halfArea(const Box& quarter, float scale) {
        const Float4 size = (quarter.max - quarter.min) * scale;
        return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
    }

  private:
    int count_;
    Box boxes_[3][maxBins];
    std::uint32_t counts_[3][maxBins];
};

class Builder {
  public:
    Builder(std::span<BvhItem> items, const BvhBuildParams& params)
        : items_(items), params_(params), nodes_(items.empty() ? 0 : 2 * items.size() - 1) {}

    BvhTree build() {
        BvhTree tree;
        if (items_.empty())
            return tree;
        const Range all = oneapi::tbb::parallel_reduce(
            oneapi::tbb::blocked_range<std::size_t>(0, items_.size(), taskItems), Range{},
            [&](const auto& part, Range range) {
                for (std::size_t i = part.begin(); i != part.end(); ++i)
                    range.hold(boxOf(items_[i]));
                return range;
            },
            [](Range a, const Range& b) {
                a.join(b);
                return a;
            });
        build({0, items_.size(), all.box, all.places}, 0, 1, 0);

        tree.order.resize(items_.size());
        for (std::size_t i = 0; i < items_.size(); ++i)
            tree.order[i] = items_[i].index;
        pack(tree);
        return tree;
    }

  private:
    /// Below a node of n items there are 2 n − 2 others at most; they get the places from `free` on, so that
    /// no part of the tree needs to know of the others.
    void build(const Range& range, std::size_t node, std::size_t free, int depth) {
        BvhNode& self = nodes_[node];
        self.min = {range.box.min[0], range.box.min[1], range.box.min[2]};
        self.max = {range.box.max[0], range.box.max[1], range.box.max[2]};
        Range left;
        Range right;
        if (!cut(range, depth, left, right)) {
            self.first = static_cast<std::uint32_t>(range.begin);
            self.count = static_cast<std::uint32_t>(range.size());
            return;
        }
        self.first = static_cast<std::uint32_t>(free);
        const std::size_t freeRight = free + 2 * left.size();
        const auto buildLeft = [&] { build(left, free, free + 2, depth + 1); };
        const auto buildRight = [&] { build(right, free + 1, freeRight, depth + 1); };
        if (range.size() > taskItems) {
            oneapi::tbb::parallel_invoke(buildLeft, buildRight);
        } else {
            buildLeft();
            buildRight();
        }
    }

    /// False where the items are to be a leaf.
    bool cut(const Range& range, int depth, Range& left, Range& right) {
        if (range.size() == 1)
            return false;
        const Box whole = quarterOf(range.box);
        const Float4 size = whole.max - whole.min;
        // Costs are compared within a node only, so in units of its longest side nothing overflows.
        const float longest = std::max({size[0], size[1], size[2], 0x1p-120f});
        const float scale = 1 / longest;
        Split split;
        const Binning binning(range);
        if (depth < heuristicDepth)
            split = fill(range, binning).best(scale, params_.itemsATest);
        if (range.size() <= params_.maxLeafItems) {
            const float area = Bins::halfArea(whole, scale);
            const float leafCost =
                area * Bins::tests(static_cast<std::uint32_t>(range.size()), params_.itemsATest);
            if (split.axis < 0 || leafCost <= area * params_.nodeCost + split.cost)
                return false;
        }
        if (split.axis >= 0)
            divide(range, binning, split, left, right);
        else
            halve(range, left, right);
        return true;
    }

    Bins fill(const Range& range, const Binning& binning) const {
        Bins bins(binning.count);
        if (range.size() < parallelItems) {
            bins.add(&items_[range.begin], items_.data() + range.end, binning);
            return bins;
        }
        return oneapi::tbb::parallel_reduce(
            oneapi::tbb::blocked_range<std::size_t>(range.begin, range.end, parallelItems / 4), bins,
            [&](const auto& part, Bins sum) {
                sum.add(&items_[part.begin()], items_.data() + part.end(), binning);
                return sum;
            },
            [](Bins a, const Bins& b) {
                a.join(b);
                return a;
            });
    }

    void divide(const Range& range, const Binning& binning, const Split& split, Range& left, Range& right) {
        std::size_t low = range.begin;
        std::size_t high = range.end;
        for (;;) {
            Box box;
            const auto goesLeft = [&](const BvhItem& item) {
                box = boxOf(item);
                return binning.binOf(placeOf(box))[split.axis] < split.bin;
            };
            while (low < high && goesLeft(items_[low])) {
                left.hold(box);
                ++low;
            }
            if (low == high)
                break;
            right.hold(box);  // items_[low]
            while (low < high - 1 && !goesLeft(items_[high - 1])) {
                right.hold(box);
                --high;
            }
            --high;
            if (low == high)
                break;
            left.hold(box);  // items_[high]
            std::swap(items_[low], items_[high]);
            ++low;
        }
        left.begin = range.begin;
        left.end = right.begin = low;
        right.end = range.end;
    }

    /// Half the items each, along the axis where their centres spread most.
    void halve(const Range& range, Range& left, Range& right) {
        const Float4 spread = range.places.max - range.places.min;
        const int axis = spread[0] >= spread[1] && spread[0] >= spread[2] ? 0
                         : spread[1] >= spread[2]                         ? 1
                                                                          : 2;
        const std::size_t middle = range.begin + range.size() / 2;
        const auto at = [&](std::size_t i) { return items_.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(at(range.begin), at(middle), at(range.end),
                         [axis](const BvhItem& a, const BvhItem& b) {
                             const float placeA = 0.25f * a.min[axis] + 0.25f * a.max[axis];
                             const float placeB = 0.25f * b.min[axis] + 0.25f * b.max[axis];
                             return placeA != placeB ? placeA < placeB : a.index < b.index;
                         });
        left.begin = range.begin;
        left.end = right.begin = middle;
        right.end = range.end;
        for (std::size_t i = left.begin; i < left.end; ++i)
            left.hold(boxOf(items_[i]));
        for (std::size_t i = right.begin; i < right.end; ++i)
            right.hold(boxOf(items_[i]));
    }

    /// Moves the nodes together, a subtree's one after the other.
    void pack(BvhTree& tree) const {
        std::size_t count = 1;
        walk([&](std::size_t) { count += 2; });
        tree.nodes.reserve(count);
        tree.nodes.push_back(nodes_[0]);
        if (nodes_[0].isLeaf())
            return;
        // Places in the packed array whose children are still to come; a node's own children come before
        // those of its right sibling.
        std::array<std::size_t, maxBvhDepth + 1> pending;
        std::size_t size = 0;
        pending[size++] = 0;
        while (size > 0) {
            const std::size_t node = pending[--size];
            const std::size_t children = tree.nodes[node].first;
            const std::size_t packed = tree.nodes.size();
            tree.nodes[node].first = static_cast<std::uint32_t>(packed);
            tree.nodes.push_back(nodes_[children]);
            tree.nodes.push_back(nodes_[children + 1]);
            for (const std::size_t child : {packed + 1, packed})
                if (!tree.nodes[child].isLeaf())
                    pending[size++] = child;
        }
    }

    /// Calls `visit` for every node that is no leaf.
    template <typename Visit>
    void walk(const Visit& visit) const {
        std::array<std::size_t, maxBvhDepth + 1> pending;
        std::size_t size = 0;
        pending[size++] = 0;
        while (size > 0) {
            const BvhNode& node = nodes_[pending[--size]];
            if (node.isLeaf())
                continue;
            visit(node.first);
            pending[size++] = node.first + 1;
            pending[size++] = node.first;
        }
    }

    std::span<BvhItem> items_;
    BvhBuildParams params_;
    std::vector<BvhNode> nodes_;
};

bool isFinite(const Bounds& box) {
    const glm::vec3 zero = (box.min - box.min) + (box.max - box.max);
    return zero == glm::vec3(0);
}

}  // namespace

BvhTree detail::buildBvh(std::span<BvhItem> items, const BvhBuildParams& params) {
    QX_CHECK_GE(params.maxLeafItems, 1u);
    QX_CHECK_GE(params.itemsATest, 1u);
    QX_CHECK_LT(items.size(), std::size_t{1} << 31);
    return Builder(items, params).build();
}

BvhTree buildBvh(std::span<const Bounds> boxes, const BvhBuildParams& params) {
    std::vector<BvhItem> items;
    items.reserve(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i)
        if (!boxes[i].empty() && isFinite(boxes[i]))
            items.push_back({boxes[i].min, static_cast<std::uint32_t>(i), boxes[i].max, 0});
    return detail::buildBvh(items, params);
}

}  // namespace quincunx
