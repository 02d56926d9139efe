#include "trace/csg.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "base/error.h"
#include "math/expansion.h"
#include "math/vector.h"

namespace quincunx {
namespace {

constexpr double u = 0x1p-53;  // the unit roundoff of double
constexpr double infinity = std::numeric_limits<double>::infinity();

using Operator = Csg::Operator;

double sumOfMagnitudes(glm::dvec3 v) {
    return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}

struct Box {
    glm::dvec3 min{infinity};
    glm::dvec3 max{-infinity};

    bool empty() const { return min.x > max.x || min.y > max.y || min.z > max.z; }
};

Box united(const Box& a, const Box& b) {
    return {glm::min(a.min, b.min), glm::max(a.max, b.max)};
}

Box common(const Box& a, const Box& b) {
    return {glm::max(a.min, b.min), glm::min(a.max, b.max)};
}

/// Triangles of a closed mesh, and boxes around them in a binary tree, children side by side.
struct Hull {
    struct Node {
        Box box;
        std::uint32_t first = 0;  ///< of the triangles, or the left child
        std::uint32_t count = 0;  ///< of triangles; 0: an inner node
    };
    std::vector<Triangle> triangles;
    std::vector<Node> nodes;
};

using Shape = std::variant<Ball, Bounds, Cylinder, std::shared_ptr<const Hull>>;

}  // namespace

struct Csg::Node {
    // A part:
    Shape shape;
    std::uint32_t material = 0;
    // Or an operator, where both are set:
    std::shared_ptr<const Node> left;
    std::shared_ptr<const Node> right;
    Operator op = Operator::unite;

    int depth = 0;
};

namespace {

bool op(Operator which, bool inLeft, bool inRight) {
    switch (which) {
        case Operator::unite:
            return inLeft || inRight;
        case Operator::intersect:
            return inLeft && inRight;
        case Operator::subtract:
            return inLeft && !inRight;
    }
    return false;
}

[[noreturn]] void reject(const char* what, const char* shape) {
    throw InputError(what, fmt::format("a {} of a constructed solid", shape), "correct the solid's numbers");
}

// --- Building ------------------------------------------------------------------------------------------

Box boxOf(const Triangle& triangle) {
    return {glm::dvec3(glm::min(triangle.a, glm::min(triangle.b, triangle.c))),
            glm::dvec3(glm::max(triangle.a, glm::max(triangle.b, triangle.c)))};
}

Box boxOf(const Shape& shape) {
    if (const Ball* const ball = std::get_if<Ball>(&shape)) {
        // Rounded in double: a part in 2^50 wider is above that.
        const glm::dvec3 centre(ball->centre);
        const double radius = ball->radius;
        const glm::dvec3 reach = glm::dvec3(radius) + 0x1p-50 * (glm::dvec3(radius) + glm::abs(centre));
        return {centre - reach, centre + reach};
    }
    if (const Bounds* const box = std::get_if<Bounds>(&shape))
        return {glm::dvec3(box->min), glm::dvec3(box->max)};
    if (const Cylinder* const cylinder = std::get_if<Cylinder>(&shape)) {
        const glm::dvec3 base(cylinder->base);
        const glm::dvec3 top = base + glm::dvec3(cylinder->axis);
        const double radius = cylinder->radius;
        const glm::dvec3 reach =
            glm::dvec3(radius) + 0x1p-50 * (glm::dvec3(radius) + glm::abs(base) + glm::abs(top));
        return {glm::min(base, top) - reach, glm::max(base, top) + reach};
    }
    const Hull& hull = *std::get<std::shared_ptr<const Hull>>(shape);
    return hull.nodes.empty() ? Box{} : hull.nodes.front().box;
}

constexpr std::uint32_t trianglesInLeaf = 4;

void divide(Hull& hull, std::uint32_t node, std::uint32_t first, std::uint32_t count) {
    Box box;
    Box middles;
    const auto middleOf = [](const Triangle& triangle) {
        const Box around = boxOf(triangle);
        return 0.5 * (around.min + around.max);
    };
    for (std::uint32_t i = first; i < first + count; ++i) {
        box = united(box, boxOf(hull.triangles[i]));
        const glm::dvec3 middle = middleOf(hull.triangles[i]);
        middles = united(middles, {middle, middle});
    }
    hull.nodes[node].box = box;
    if (count <= trianglesInLeaf) {
        hull.nodes[node].first = first;
        hull.nodes[node].count = count;
        return;
    }
    const glm::dvec3 extent = middles.max - middles.min;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const std::uint32_t half = count / 2;
    // Halving by count keeps the tree's depth below 32, however the triangles lie.
    const auto begin = hull.triangles.begin() + first;
    std::nth_element(begin, begin + half, begin + count, [&](const Triangle& a, const Triangle& b) {
        return middleOf(a)[axis] < middleOf(b)[axis];
    });
    const auto children = static_cast<std::uint32_t>(hull.nodes.size());
    hull.nodes.resize(hull.nodes.size() + 2);
    hull.nodes[node].first = children;
    divide(hull, children, first, half);
    divide(hull, children + 1, first + half, count - half);
}

Hull makeHull(const Mesh& mesh) {
    Hull hull;
    std::map<std::tuple<float, float, float>, std::uint32_t> places;
    std::vector<std::uint32_t> place;
    place.reserve(mesh.positions.size());
    for (const glm::vec3& p : mesh.positions) {
        if (!isFinite(p))
            reject("a position is not finite", "mesh");
        // + 0 makes −0 and 0 the same place.
        place.push_back(
            places
                .try_emplace({p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}, static_cast<std::uint32_t>(places.size()))
                .first->second);
    }
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        std::array<std::uint32_t, 3> corner{};
        for (std::size_t k = 0; k < 3; ++k) {
            corner[k] = mesh.indices[i + k];
            if (corner[k] >= mesh.positions.size())
                reject("an index is out of range", "mesh");
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t from = place[corner[k]];
            const std::uint32_t to = place[corner[(k + 1) % 3]];
            if (from != to)
                ++edges[{std::min(from, to), std::max(from, to)}];
        }
        hull.triangles.push_back(
            {mesh.positions[corner[0]], mesh.positions[corner[1]], mesh.positions[corner[2]]});
    }
    for (const auto& [edge, count] : edges)
        if (count % 2 != 0)
            throw InputError(fmt::format("an edge belongs to {} triangles, so that it has no inside", count),
                             fmt::format("the mesh '{}'", printable(mesh.name)), "close the mesh");
    if (!hull.triangles.empty()) {
        hull.nodes.resize(1);
        divide(hull, 0, 0, static_cast<std::uint32_t>(hull.triangles.size()));
    }
    return hull;
}

std::shared_ptr<const Csg::Node> makeLeaf(Shape shape, std::uint32_t material) {
    auto node = std::make_shared<Csg::Node>();
    node->shape = std::move(shape);
    node->material = material;
    return node;
}

bool sameShape(const Shape& a, const Shape& b) {
    if (a.index() != b.index())
        return false;
    if (const Ball* const ball = std::get_if<Ball>(&a)) {
        const Ball& other = std::get<Ball>(b);
        return ball->centre == other.centre && ball->radius == other.radius;
    }
    if (const Bounds* const box = std::get_if<Bounds>(&a)) {
        const Bounds& other = std::get<Bounds>(b);
        return box->min == other.min && box->max == other.max;
    }
    if (const Cylinder* const cylinder = std::get_if<Cylinder>(&a)) {
        const Cylinder& other = std::get<Cylinder>(b);
        return cylinder->base == other.base && cylinder->axis == other.axis &&
               cylinder->radius == other.radius;
    }
    return std::get<std::shared_ptr<const Hull>>(a) == std::get<std::shared_ptr<const Hull>>(b);
}

}  // namespace

Csg Csg::ball(const Ball& ball, std::uint32_t material) {
    if (!isFinite(ball.centre) || !std::isfinite(ball.radius) || ball.radius < 0)
        reject("the centre or the radius is not finite, or the radius is below 0", "ball");
    return Csg(makeLeaf(ball, material));
}

Csg Csg::box(const Bounds& box, std::uint32_t material) {
    if (!isFinite(box.min) || !isFinite(box.max))
        reject("a corner is not finite", "box");
    return Csg(makeLeaf(box, material));
}

Csg Csg::cylinder(const Cylinder& cylinder, std::uint32_t material) {
    if (!isFinite(cylinder.base) || !isFinite(cylinder.axis) || !std::isfinite(cylinder.radius) ||
        cylinder.radius < 0 || cylinder.axis == glm::vec3(0))
        reject("a number is not finite, the radius is below 0, or the axis is zero", "cylinder");
    return Csg(makeLeaf(cylinder, material));
}

Csg Csg::mesh(const Mesh& mesh, std::uint32_t material) {
    return Csg(makeLeaf(std::make_shared<const Hull>(makeHull(mesh)), material));
}

Csg Csg::combine(Operator op, const Csg& left, const Csg& right) {
    auto node = std::make_shared<Node>();
    node->left = left.node_;
    node->right = right.node_;
    node->op = op;
    node->depth = 1 + std::max(left.node_->depth, right.node_->depth);
    if (node->depth > deepest)
        throw InputError(fmt::format("operators are nested {} deep", node->depth), "a constructed solid",
                         fmt::format("nest them {} deep at most", deepest));
    return Csg(std::move(node));
}

struct CsgSolid::Parts {
    struct Leaf {
        Shape shape;
        std::uint32_t material = 0;
        std::uint32_t firstAlike = 0;  ///< the first leaf of the same shape
    };
    struct Item {
        Box box;
        Operator op = Operator::unite;
        std::int32_t left = -1;  ///< index into items; −1: a leaf
        std::int32_t right = -1;
        std::uint32_t leaf = 0;
    };
    std::vector<Leaf> leaves;
    std::vector<Item> items;
    double largest = 0;  ///< magnitude of a coordinate

    std::int32_t add(const Csg::Node& node) {
        Item item;
        if (!node.left) {
            item.box = boxOf(node.shape);
            item.leaf = static_cast<std::uint32_t>(leaves.size());
            Leaf leaf{node.shape, node.material, item.leaf};
            for (std::uint32_t i = 0; i < item.leaf; ++i)
                if (sameShape(leaves[i].shape, leaf.shape)) {
                    leaf.firstAlike = i;
                    break;
                }
            leaves.push_back(std::move(leaf));
            if (!item.box.empty())
                for (int axis = 0; axis < 3; ++axis)
                    largest = std::max({largest, std::abs(item.box.min[axis]), std::abs(item.box.max[axis])});
        } else {
            item.op = node.op;
            item.left = add(*node.left);
            item.right = add(*node.right);
            const Box& left = items[static_cast<std::size_t>(item.left)].box;
            const Box& right = items[static_cast<std::size_t>(item.right)].box;
            item.box = node.op == Operator::unite       ? united(left, right)
                       : node.op == Operator::intersect ? common(left, right)
                                                        : left;
        }
        items.push_back(item);
        return static_cast<std::int32_t>(items.size()) - 1;
    }
};

CsgSolid::CsgSolid(const Csg& expression) {
    auto parts = std::make_unique<Parts>();
    parts->add(*expression.node());
    parts_ = std::move(parts);
}
CsgSolid::~CsgSolid() = default;
CsgSolid::CsgSolid(CsgSolid&&) noexcept = default;
CsgSolid& CsgSolid::operator=(CsgSolid&&) noexcept = default;

std::size_t CsgSolid::leafCount() const {
    return parts_->leaves.size();
}

std::uint32_t CsgSolid::material(std::uint32_t leaf) const {
    return parts_->leaves[leaf].material;
}

std::vector<std::uint32_t> CsgSolid::materials() const {
    std::vector<std::uint32_t> used;
    for (const Parts::Leaf& leaf : parts_->leaves)
        if (std::find(used.begin(), used.end(), leaf.material) == used.end())
            used.push_back(leaf.material);
    return used;
}

Bounds CsgSolid::bounds() const {
    const Box& box = parts_->items.back().box;
    if (box.empty())
        return {};
    const auto outwards = [](glm::dvec3 v, float limit) {
        glm::vec3 rounded(v);
        for (int axis = 0; axis < 3; ++axis)
            rounded[axis] = std::nextafter(rounded[axis], limit);
        return rounded;
    };
    constexpr float far = std::numeric_limits<float>::infinity();
    return {outwards(box.min, -far), outwards(box.max, far)};
}

// --- Exact places on a line ----------------------------------------------------------------------------

namespace {

struct ExactVector {
    Expansion x;
    Expansion y;
    Expansion z;
};

Expansion dot(const ExactVector& a, const ExactVector& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

ExactVector cross(const ExactVector& a, const ExactVector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A root of a t² − 2 b t + c, a > 0, the smaller for `which` −1 and the larger for 1; for 0, b / a.
struct Place {
    Expansion a = 1.0;
    Expansion b;
    Expansion c;
    int which = 0;

    static Place quotient(const Expansion& numerator, const Expansion& denominator) {
        Place place;
        const bool negative = denominator.sign() < 0;
        place.a = negative ? -denominator : denominator;
        place.b = negative ? -numerator : numerator;
        return place;
    }
};

/// The sign of a root less n / m, m > 0.
int compareRootToQuotient(const Place& root, const Expansion& n, const Expansion& m) {
    const int fromVertex = (root.a * n - root.b * m).sign();
    const int inside = (root.a * n.squared() - 2.0 * (root.b * n * m) + root.c * m.squared()).sign();
    if (inside < 0)
        return root.which;
    if (inside == 0 && fromVertex == root.which)
        return 0;
    if (inside == 0)
        return root.which;  // on the other root
    return -fromVertex;
}

/// The sign of p − q. Degree 24 in float data at most, for two cylinders.
int compare(const Place& p, const Place& q) {
    if (p.which == 0 && q.which == 0)
        return (p.b * q.a - q.b * p.a).sign();
    if (q.which == 0)
        return compareRootToQuotient(p, q.b, q.a);
    if (p.which == 0)
        return -compareRootToQuotient(q, p.b, p.a);
    // q's polynomial at p is linear in p, as p² can be written by p's own: a_p² Q(p) = v + w √D.
    const Expansion slope = 2.0 * (q.a * p.b - p.a * q.b);
    const Expansion v = slope * p.b + p.a * (p.a * q.c - q.a * p.c);
    const Expansion w = static_cast<double>(p.which) * slope;
    int sign = v.sign();
    if (const int other = w.sign(); other != 0) {
        if (sign == 0)
            sign = other;
        else if (sign != other)
            sign *= (v.squared() - w.squared() * (p.b.squared() - p.a * p.c)).sign();
    }
    if (sign < 0)
        return -q.which;  // between q's roots
    const int fromVertex = compareRootToQuotient(p, q.b, q.a);
    if (sign == 0)
        return fromVertex == q.which ? 0 : -q.which;  // one of the two
    return fromVertex;
}

/// The sign of the first component that is not zero.
int firstSign(glm::vec3 v) {
    for (int axis = 0; axis < 3; ++axis)
        if (v[axis] != 0)
            return v[axis] > 0 ? 1 : -1;
    return 0;
}

enum CylinderFeature : std::uint32_t { sideEntered, sideLeft, baseCap, topCap };

}  // namespace

// --- Along a ray ---------------------------------------------------------------------------------------

/// One ray through one solid.
class CsgSolid::Walk {
  public:
    Walk(const Parts& parts, const Ray& ray, CsgScratch& scratch)
        : parts_(parts),
          ray_(ray),
          scratch_(scratch),
          list_(scratch.crossings),
          o_(ray.origin),
          d_(ray.direction),
          sumD_(sumOfMagnitudes(d_)) {
        list_.clear();
        finite_ = isFinite(ray.origin) && isFinite(ray.direction) && ray.direction != glm::vec3(0);
        for (int axis = 0; axis < 3; ++axis)
            inverse_[axis] = 1 / d_[axis];
    }

    void run() {
        if (finite_)
            evaluate(static_cast<std::int32_t>(parts_.items.size()) - 1);
    }

    /// The sign of a crossing's t less a number.
    int compareTo(const CsgCrossing& crossing, double t) {
        if (std::isinf(t))
            return t > 0 ? -1 : 1;
        if (std::abs(crossing.t - t) > crossing.error)
            return crossing.t < t ? -1 : 1;
        ++scratch_.exact;
        // In the units of the exact forms.
        const double scaled = t * (lengthScale() / directionScale_);
        return quincunx::compare(placeOf(crossing), Place::quotient(Expansion(scaled), Expansion(1.0)));
    }

    CsgHit hit(const CsgCrossing& crossing, bool enters) const;

  private:
    using List = std::vector<CsgCrossing>;

    void evaluate(std::int32_t index) {
        const Parts::Item& item = parts_.items[static_cast<std::size_t>(index)];
        if (!mayMeet(item.box))
            return;
        if (item.left < 0) {
            meetLeaf(item.leaf);
            return;
        }
        const std::size_t begin = list_.size();
        evaluate(item.left);
        const std::size_t middle = list_.size();
        if (middle == begin && item.op != Operator::unite)
            return;
        evaluate(item.right);
        if (middle == begin)
            return;
        if (list_.size() == middle) {
            if (item.op == Operator::intersect)
                list_.resize(begin);
            return;
        }
        merge(item.op, begin, middle);
    }

    /// Merges the lists [begin, middle) and [middle, end) into one at `begin`.
    void merge(Operator which, std::size_t begin, std::size_t middle) {
        const std::size_t end = list_.size();
        std::size_t i = begin;
        std::size_t j = middle;
        bool inside = false;
        while (i < end && (i < middle || j < end)) {
            const int order = i >= middle ? 1 : j >= end ? -1 : compare(list_[i], list_[j]);
            CsgCrossing crossing = list_[order <= 0 ? i : j];
            crossing.inverted ^= order > 0 && which == Operator::subtract;
            i += order <= 0;
            j += order >= 0;
            const bool now = op(which, (i - begin) % 2 != 0, (j - middle) % 2 != 0);
            if (now != inside)
                list_.push_back(crossing);
            inside = now;
        }
        list_.erase(list_.begin() + static_cast<std::ptrdiff_t>(begin),
                    list_.begin() + static_cast<std::ptrdiff_t>(end));
    }

    /// Whether the line may meet a box, never wrongly denied: quotients are off by 3u of themselves.
    bool mayMeet(const Box& box) const {
        double enter = -infinity;
        double exit = infinity;
        for (int axis = 0; axis < 3; ++axis) {
            if (d_[axis] == 0) {
                if (o_[axis] < box.min[axis] || o_[axis] > box.max[axis])
                    return false;
                continue;
            }
            const double first = (box.min[axis] - o_[axis]) * inverse_[axis];
            const double second = (box.max[axis] - o_[axis]) * inverse_[axis];
            enter = std::max(enter, std::min(first, second));
            exit = std::min(exit, std::max(first, second));
        }
        return !(enter - exit > 8 * u * (std::abs(enter) + std::abs(exit))) && !box.empty();
    }

    void meetLeaf(std::uint32_t leaf) {
        ++scratch_.leaves;
        const Shape& shape = parts_.leaves[leaf].shape;
        if (const Ball* const ball = std::get_if<Ball>(&shape))
            meetBall(leaf, *ball);
        else if (const Bounds* const box = std::get_if<Bounds>(&shape))
            meetBox(leaf, *box);
        else if (const Cylinder* const cylinder = std::get_if<Cylinder>(&shape))
            meetCylinder(leaf, *cylinder);
        else
            meetHull(leaf, *std::get<std::shared_ptr<const Hull>>(shape));
    }

    void meetBall(std::uint32_t leaf, const Ball& ball);
    void meetBox(std::uint32_t leaf, const Bounds& box);
    void meetCylinder(std::uint32_t leaf, const Cylinder& cylinder);
    void meetHull(std::uint32_t leaf, const Hull& hull);
    /// −1, 1: all three edges have the triangle on the same side of the line; 0: they have not.
    int sideOfTriangle(const Triangle& triangle);
    int sideOfEdge(glm::vec3 a, glm::vec3 b);
    void meetTriangle(std::uint32_t leaf, std::uint32_t index, const Triangle& triangle);

    /// The sign of p.t − q.t.
    int compare(const CsgCrossing& p, const CsgCrossing& q) {
        if (std::abs(p.t - q.t) > p.error + q.error)
            return p.t < q.t ? -1 : 1;
        const std::uint32_t first = parts_.leaves[p.leaf].firstAlike;
        if (first == parts_.leaves[q.leaf].firstAlike) {
            if (p.feature == q.feature)
                return 0;
        }
        ++scratch_.exact;
        return quincunx::compare(placeOf(p), placeOf(q));
    }

    /// Exact forms are in lengths and directions scaled by powers of two to about 1, the same for the ray.
    double lengthScale() {
        if (lengthScale_ == 0) {
            const double largest = std::max({parts_.largest, std::abs(o_.x), std::abs(o_.y), std::abs(o_.z)});
            lengthScale_ = largest > 0 ? std::scalbn(1.0, -std::ilogb(largest)) : 1;
            directionScale_ =
                std::scalbn(1.0, -std::ilogb(std::max({std::abs(d_.x), std::abs(d_.y), std::abs(d_.z)})));
        }
        return lengthScale_;
    }
    ExactVector fromOrigin(glm::vec3 p) {
        const double s = lengthScale();
        return {Expansion::difference(s * p.x, s * o_.x), Expansion::difference(s * p.y, s * o_.y),
                Expansion::difference(s * p.z, s * o_.z)};
    }
    ExactVector difference(glm::vec3 a, glm::vec3 b) {
        const double s = lengthScale();
        return {Expansion::difference(s * a.x, s * b.x), Expansion::difference(s * a.y, s * b.y),
                Expansion::difference(s * a.z, s * b.z)};
    }
    ExactVector length(glm::vec3 v) {
        const double s = lengthScale();
        return {s * v.x, s * v.y, s * v.z};
    }
    ExactVector direction() {
        lengthScale();
        return {directionScale_ * d_.x, directionScale_ * d_.y, directionScale_ * d_.z};
    }

    Place ballPlace(const Ball& ball, int which) {
        const ExactVector f = fromOrigin(ball.centre);
        const ExactVector d = direction();
        const double r = lengthScale() * ball.radius;
        return {dot(d, d), dot(d, f), dot(f, f) - Expansion::product(r, r), which};
    }
    Place sidePlace(const Cylinder& cylinder, int which) {
        const ExactVector f = fromOrigin(cylinder.base);
        const ExactVector axis = length(cylinder.axis);
        const ExactVector across = cross(direction(), axis);
        const ExactVector away = cross(f, axis);
        const double r = lengthScale() * cylinder.radius;
        return {dot(across, across), dot(away, across),
                dot(away, away) - Expansion::product(r, r) * dot(axis, axis), which};
    }
    Place placeOf(const CsgCrossing& crossing);

    /// Both roots, by the exact form, where the polynomial has two.
    bool rootsOf(const Place& place, CsgCrossing& nearer, CsgCrossing& farther) {
        ++scratch_.exact;
        const Expansion discriminant = place.b.squared() - place.a * place.c;
        if (discriminant.sign() <= 0)
            return false;
        const double scale = directionScale_ / lengthScale();
        const double a = place.a.approximate();
        const double b = place.b.approximate();
        const double root = std::sqrt(discriminant.approximate());
        nearer.t = (b - root) / a * scale;
        farther.t = (b + root) / a * scale;
        // Each number within 2u of itself, the root 2u, sum and quotient u each.
        nearer.error = farther.error = 8 * u * (std::abs(b) + root) / a * scale;
        return std::isfinite(nearer.t) && std::isfinite(farther.t);
    }

    const Parts& parts_;
    const Ray& ray_;
    CsgScratch& scratch_;
    List& list_;
    glm::dvec3 o_;
    glm::dvec3 d_;
    glm::dvec3 inverse_{0};
    double sumD_;
    bool finite_ = false;
    double lengthScale_ = 0;
    double directionScale_ = 1;
};

Place CsgSolid::Walk::placeOf(const CsgCrossing& crossing) {
    const Shape& shape = parts_.leaves[crossing.leaf].shape;
    if (const Ball* const ball = std::get_if<Ball>(&shape))
        return ballPlace(*ball, crossing.feature == 0 ? -1 : 1);
    if (const Bounds* const box = std::get_if<Bounds>(&shape)) {
        const int axis = static_cast<int>(crossing.feature / 2);
        const double face = crossing.feature % 2 == 0 ? box->min[axis] : box->max[axis];
        const double s = lengthScale();
        return Place::quotient(Expansion::difference(s * face, s * o_[axis]),
                               Expansion(directionScale_ * d_[axis]));
    }
    if (const Cylinder* const cylinder = std::get_if<Cylinder>(&shape)) {
        if (crossing.feature == sideEntered || crossing.feature == sideLeft)
            return sidePlace(*cylinder, crossing.feature == sideEntered ? -1 : 1);
        const ExactVector axis = length(cylinder->axis);
        Expansion height = dot(fromOrigin(cylinder->base), axis);
        if (crossing.feature == topCap)
            height = height + dot(axis, axis);
        return Place::quotient(height, dot(direction(), axis));
    }
    const Triangle& triangle = std::get<std::shared_ptr<const Hull>>(shape)->triangles[crossing.feature];
    const ExactVector normal = cross(difference(triangle.b, triangle.a), difference(triangle.c, triangle.a));
    return Place::quotient(dot(normal, fromOrigin(triangle.a)), dot(normal, direction()));
}

/// Bounds as of raySphere in geometry/ray_shapes.cpp, to first order in u: the middle is off by
/// 7u |f|/|d|; r² − |l|² by 6u |l||f| + 3u |l|² + 2u r² + (10u |f|)²; half by half · gapError / gap + 3u
/// half.
void CsgSolid::Walk::meetBall(std::uint32_t leaf, const Ball& ball) {
    const glm::dvec3 f = glm::dvec3(ball.centre) - o_;
    const double r = ball.radius;
    const double inverse = 1 / glm::dot(d_, d_);
    const double middle = glm::dot(d_, f) * inverse;
    const glm::dvec3 l = f - middle * d_;
    const double gap = r * r - glm::dot(l, l);
    const double far = sumOfMagnitudes(f);
    const double gapError = u * ((12 * sumOfMagnitudes(l) + 0x1p-44 * far) * far + 4 * r * r);
    if (gap < -gapError)
        return;
    CsgCrossing enter{.leaf = leaf, .feature = 0};
    CsgCrossing leave{.leaf = leaf, .feature = 1};
    const double half = std::sqrt(gap * inverse);
    const double error =
        half * (gapError / gap) + u * (8 * half + 10 * (far * sumD_ * inverse + std::abs(middle)));
    if (gap > gapError && error < infinity) {
        enter.t = middle - half;
        leave.t = middle + half;
        enter.error = leave.error = error;
    } else if (!rootsOf(ballPlace(ball, 0), enter, leave)) {
        return;
    }
    list_.push_back(enter);
    list_.push_back(leave);
}

void CsgSolid::Walk::meetBox(std::uint32_t leaf, const Bounds& box) {
    CsgCrossing enter;
    CsgCrossing leave;
    bool some = false;
    for (int axis = 0; axis < 3; ++axis) {
        if (d_[axis] == 0) {
            // In the lower face the moved origin is inside, in the upper one outside.
            if (!(o_[axis] >= box.min[axis] && o_[axis] < box.max[axis]))
                return;
            continue;
        }
        if (!(box.min[axis] < box.max[axis]))
            return;
        const auto crossingAt = [&](bool max) {
            const double t = ((max ? box.max : box.min)[axis] - o_[axis]) * inverse_[axis];
            return CsgCrossing{.t = t,
                               .error = 4 * u * std::abs(t),
                               .leaf = leaf,
                               .feature = static_cast<std::uint32_t>(2 * axis + (max ? 1 : 0))};
        };
        const bool upwards = d_[axis] > 0;
        const CsgCrossing in = crossingAt(!upwards);
        const CsgCrossing out = crossingAt(upwards);
        if (!some || compare(in, enter) > 0)
            enter = in;
        if (!some || compare(out, leave) < 0)
            leave = out;
        some = true;
    }
    // An overflowing quotient is beyond what t can be.
    if (compare(enter, leave) >= 0 || !std::isfinite(enter.t) || !std::isfinite(leave.t))
        return;
    list_.push_back(enter);
    list_.push_back(leave);
}

/// Bounds as of rayCylinder in geometry/ray_shapes.cpp, to first order in u: e = d × axis by u |e|; m = f·e
/// by 5u |f||e|; r² e·e − m² by 6u r² e·e + 2u m² + 10u |m||f||e|; (f × axis)·e by 12u |f||axis||e|. A cap's
/// quotient: f·axis by 4u |f||axis|, the sum by 3u |axis|² more, d·axis by u of itself.
void CsgSolid::Walk::meetCylinder(std::uint32_t leaf, const Cylinder& cylinder) {
    const glm::dvec3 axis(cylinder.axis);
    const glm::dvec3 f = glm::dvec3(cylinder.base) - o_;
    const glm::dvec3 e = crossInDouble(ray_.direction, cylinder.axis);
    const double r = cylinder.radius;
    const double ee = glm::dot(e, e);
    const double aa = glm::dot(axis, axis);
    const double far = sumOfMagnitudes(f);
    const double farAxis = far * sumOfMagnitudes(axis);

    CsgCrossing enter{.leaf = leaf, .feature = sideEntered};
    CsgCrossing leave{.leaf = leaf, .feature = sideLeft};
    const bool parallel = e == glm::dvec3(0);
    if (parallel) {
        const Place side = sidePlace(cylinder, 0);
        int outside = side.c.sign();
        if (outside == 0) {
            // Moving the origin changes its distance from the axis by the way's part across the axis.
            const ExactVector a = length(cylinder.axis);
            const ExactVector away = cross(cross(fromOrigin(cylinder.base), a), a);
            for (const Expansion* part : {&away.x, &away.y, &away.z})
                if (outside == 0)
                    outside = part->sign();
        }
        if (outside >= 0)
            return;
    } else {
        const double m = glm::dot(f, e);
        const double sumE = sumOfMagnitudes(e);
        const double gap = r * r * ee - m * m;
        const double gapError = u * (8 * r * r * ee + (4 * std::abs(m) + 12 * far * sumE) * std::abs(m));
        if (gap < -gapError)
            return;
        const double inverse = 1 / ee;
        constexpr double least = 0x1p-900;
        if (gap > gapError && ee > least && gap * aa > least && gap * aa < infinity) {
            const glm::dvec3 g(f.y * axis.z - f.z * axis.y, f.z * axis.x - f.x * axis.z,
                               f.x * axis.y - f.y * axis.x);
            const double middle = glm::dot(g, e) * inverse;
            const double half = std::sqrt(gap * aa) * inverse;
            enter.t = middle - half;
            leave.t = middle + half;
            enter.error = leave.error =
                half * (gapError / gap + 12 * u) + 20 * u * (farAxis * sumE * inverse + std::abs(middle));
        } else if (!rootsOf(sidePlace(cylinder, 0), enter, leave)) {
            return;
        }
    }

    const double along = dotInDouble(ray_.direction, cylinder.axis);
    if (along == 0) {
        // Between the caps' planes, or in the one that the moved origin is above or below of.
        const ExactVector a = length(cylinder.axis);
        const Expansion below = dot(fromOrigin(cylinder.base), a);
        const Expansion above = below + dot(a, a);
        const int moved = firstSign(cylinder.axis);
        if (!(below.sign() < 0 || (below.sign() == 0 && moved > 0)) ||
            !(above.sign() > 0 || (above.sign() == 0 && moved < 0)))
            return;
    } else {
        const double inverse = 1 / along;
        const double below = glm::dot(f, axis);
        const double error = u * (8 * (farAxis + aa) * std::abs(inverse));
        CsgCrossing base{.t = below * inverse, .error = error, .leaf = leaf, .feature = baseCap};
        CsgCrossing top{.t = (below + aa) * inverse, .error = error, .leaf = leaf, .feature = topCap};
        const CsgCrossing& in = along > 0 ? base : top;
        const CsgCrossing& out = along > 0 ? top : base;
        if (!std::isfinite(in.t) || !std::isfinite(out.t))
            return;
        if (parallel || compare(in, enter) > 0)
            enter = in;
        if (parallel || compare(out, leave) < 0)
            leave = out;
    }
    if (compare(enter, leave) >= 0)
        return;
    list_.push_back(enter);
    list_.push_back(leave);
}

/// The sign of d · ((a − o) × (b − o)) after the origin's move, 0 only for a = b or an edge along the ray.
/// Differences are off by u, products by 3u, the sum by 5u of the product of the sums of magnitudes.
int CsgSolid::Walk::sideOfEdge(glm::vec3 a, glm::vec3 b) {
    const glm::dvec3 p = glm::dvec3(a) - o_;
    const glm::dvec3 q = glm::dvec3(b) - o_;
    const double side =
        glm::dot(d_, glm::dvec3(p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x));
    const double error = 16 * u * sumD_ * sumOfMagnitudes(p) * sumOfMagnitudes(q);
    if (side > error)
        return 1;
    if (side < -error)
        return -1;
    ++scratch_.exact;
    const ExactVector d = direction();
    if (const int sign = dot(d, cross(fromOrigin(a), fromOrigin(b))).sign())
        return sign;
    // Linear in the origin: moving it by m changes it by m · (d × (b − a)).
    const ExactVector change = cross(d, difference(b, a));
    for (const Expansion* part : {&change.x, &change.y, &change.z})
        if (part->sign() != 0)
            return part->sign();
    return 0;
}

int CsgSolid::Walk::sideOfTriangle(const Triangle& triangle) {
    const int side = sideOfEdge(triangle.a, triangle.b);
    if (side == 0 || sideOfEdge(triangle.b, triangle.c) != side || sideOfEdge(triangle.c, triangle.a) != side)
        return 0;
    return side;
}

/// t = n·(a − o) / n·d: the normal's components are off by 5u |e₁||e₂|, the products by 8u of theirs.
void CsgSolid::Walk::meetTriangle(std::uint32_t leaf, std::uint32_t index, const Triangle& triangle) {
    const int side = sideOfTriangle(triangle);
    if (side == 0)
        return;
    const glm::dvec3 e1 = glm::dvec3(triangle.b) - glm::dvec3(triangle.a);
    const glm::dvec3 e2 = glm::dvec3(triangle.c) - glm::dvec3(triangle.a);
    const glm::dvec3 way = glm::dvec3(triangle.a) - o_;
    const glm::dvec3 n = glm::cross(e1, e2);
    const double area = sumOfMagnitudes(e1) * sumOfMagnitudes(e2);
    const double above = glm::dot(n, way);
    const double slope = glm::dot(n, d_);
    const double slopeError = 16 * u * area * sumD_;
    CsgCrossing crossing{.leaf = leaf, .feature = index, .front = side < 0};
    if (std::abs(slope) > 2 * slopeError) {
        crossing.t = above / slope;
        crossing.error = (16 * u * area * sumOfMagnitudes(way) + std::abs(crossing.t) * slopeError) /
                             (std::abs(slope) - slopeError) +
                         2 * u * std::abs(crossing.t);
    } else {
        ++scratch_.exact;
        const Place place = placeOf(crossing);
        crossing.t = place.b.approximate() / place.a.approximate() * (directionScale_ / lengthScale());
        crossing.error = 8 * u * std::abs(crossing.t);
    }
    if (std::isfinite(crossing.t))
        list_.push_back(crossing);
}

void CsgSolid::Walk::meetHull(std::uint32_t leaf, const Hull& hull) {
    const std::size_t begin = list_.size();
    std::array<std::uint32_t, 64> waiting{};
    std::size_t count = hull.nodes.empty() ? 0 : 1;
    while (count > 0) {
        const Hull::Node& node = hull.nodes[waiting[--count]];
        if (!mayMeet(node.box))
            continue;
        if (node.count == 0) {
            waiting[count++] = node.first;
            waiting[count++] = node.first + 1;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
            meetTriangle(leaf, i, hull.triangles[i]);
    }
    std::sort(list_.begin() + static_cast<std::ptrdiff_t>(begin), list_.end(),
              [this](const CsgCrossing& a, const CsgCrossing& b) { return compare(a, b) < 0; });
    // Of crossings at one place an odd number is one, an even number none.
    std::size_t kept = begin;
    for (std::size_t i = begin; i < list_.size();) {
        std::size_t next = i + 1;
        while (next < list_.size() && compare(list_[i], list_[next]) == 0)
            ++next;
        if ((next - i) % 2 != 0) {
            const bool enters = (kept - begin) % 2 == 0;
            std::size_t shown = i;
            while (shown + 1 < next && list_[shown].front != enters)
                ++shown;
            list_[kept++] = list_[shown];
        }
        i = next;
    }
    list_.resize(kept);
}

CsgHit CsgSolid::Walk::hit(const CsgCrossing& crossing, bool enters) const {
    const Parts::Leaf& leaf = parts_.leaves[crossing.leaf];
    CsgHit result;
    result.t = crossing.t;
    result.leaf = crossing.leaf;
    result.material = leaf.material;
    result.front = enters;
    glm::dvec3 point = o_ + crossing.t * d_;
    glm::dvec3 normal(0, 0, 1);
    if (const Ball* const ball = std::get_if<Ball>(&leaf.shape)) {
        const glm::dvec3 centre(ball->centre);
        normal = normalize(point - centre).value_or(-d_ / glm::length(d_));
        point = centre + static_cast<double>(ball->radius) * normal;
    } else if (const Bounds* const box = std::get_if<Bounds>(&leaf.shape)) {
        const int axis = static_cast<int>(crossing.feature / 2);
        const bool max = crossing.feature % 2 != 0;
        normal = glm::dvec3(0);
        normal[axis] = max ? 1 : -1;
        point[axis] = (max ? box->max : box->min)[axis];
    } else if (const Cylinder* const cylinder = std::get_if<Cylinder>(&leaf.shape)) {
        const glm::dvec3 axis = normalize(glm::dvec3(cylinder->axis)).value_or(glm::dvec3(0, 0, 1));
        const glm::dvec3 base(cylinder->base);
        if (crossing.feature == baseCap || crossing.feature == topCap) {
            const bool top = crossing.feature == topCap;
            normal = top ? axis : -axis;
            const glm::dvec3 onCap = top ? base + glm::dvec3(cylinder->axis) : base;
            point -= glm::dot(point - onCap, axis) * axis;
        } else {
            const glm::dvec3 from = point - base;
            const glm::dvec3 foot = base + glm::dot(from, axis) * axis;
            normal = normalize(point - foot).value_or(-d_ / glm::length(d_));
            point = foot + static_cast<double>(cylinder->radius) * normal;
        }
    } else {
        const Triangle& triangle =
            std::get<std::shared_ptr<const Hull>>(leaf.shape)->triangles[crossing.feature];
        const glm::dvec3 a(triangle.a);
        normal = normalize(cross(glm::dvec3(triangle.b) - a, glm::dvec3(triangle.c) - a))
                     .value_or(-d_ / glm::length(d_));
        point -= glm::dot(point - a, normal) * normal;
    }
    result.normal = crossing.inverted ? -normal : normal;
    result.point = glm::vec3(point);
    // Projected onto the surface in double, a handful of roundings of numbers up to |p| and |o|, then rounded
    // to float: 2^-24 |p|, and 2^-48 of the sums of magnitudes is above what double leaves.
    const double inDouble = 0x1p-48 * (sumOfMagnitudes(point) + parts_.largest);
    for (int axis = 0; axis < 3; ++axis)
        result.pointError[axis] =
            static_cast<float>(1.0000001 * (0x1p-24 * std::abs(point[axis]) + inDouble) + 0x1p-149);
    return result;
}

std::span<const CsgCrossing> CsgSolid::crossings(const Ray& ray, CsgScratch& scratch) const {
    Walk(*parts_, ray, scratch).run();
    return scratch.crossings;
}

std::optional<CsgHit> CsgSolid::nearest(const Ray& ray, RayInterval interval, CsgScratch& scratch) const {
    Walk walk(*parts_, ray, scratch);
    walk.run();
    for (std::size_t i = 0; i < scratch.crossings.size(); ++i) {
        const CsgCrossing& crossing = scratch.crossings[i];
        if (walk.compareTo(crossing, interval.tMin) < 0)
            continue;
        if (walk.compareTo(crossing, interval.tMax) > 0)
            return std::nullopt;
        return walk.hit(crossing, i % 2 == 0);
    }
    return std::nullopt;
}

bool CsgSolid::occluded(const Ray& ray, RayInterval interval, CsgScratch& scratch) const {
    Walk walk(*parts_, ray, scratch);
    walk.run();
    for (const CsgCrossing& crossing : scratch.crossings)
        if (walk.compareTo(crossing, interval.tMin) >= 0)
            return walk.compareTo(crossing, interval.tMax) <= 0;
    return false;
}

// --- The textbook --------------------------------------------------------------------------------------

namespace {

using Ends = std::vector<float>;

Ends endsNaive(const Shape& shape, const Ray& ray) {
    const glm::vec3& o = ray.origin;
    const glm::vec3& d = ray.direction;
    const auto roots = [](float a, float b, float c) -> Ends {
        const float discriminant = b * b - 4 * a * c;
        if (!(discriminant > 0))
            return {};
        const float root = std::sqrt(discriminant);
        return {(-b - root) / (2 * a), (-b + root) / (2 * a)};
    };
    if (const Ball* const ball = std::get_if<Ball>(&shape)) {
        const glm::vec3 f = o - ball->centre;
        return roots(glm::dot(d, d), 2 * glm::dot(f, d), glm::dot(f, f) - ball->radius * ball->radius);
    }
    float enter = -std::numeric_limits<float>::infinity();
    float exit = std::numeric_limits<float>::infinity();
    const auto slab = [&](float low, float high, int axis) {
        const float first = (low - o[axis]) / d[axis];
        const float second = (high - o[axis]) / d[axis];
        enter = std::max(enter, std::min(first, second));
        exit = std::min(exit, std::max(first, second));
    };
    if (const Bounds* const box = std::get_if<Bounds>(&shape)) {
        for (int axis = 0; axis < 3; ++axis)
            slab(box->min[axis], box->max[axis], axis);
    } else if (const Cylinder* const cylinder = std::get_if<Cylinder>(&shape)) {
        const glm::vec3 f = o - cylinder->base;
        const Ends sides = roots(d.x * d.x + d.y * d.y, 2 * (f.x * d.x + f.y * d.y),
                                 f.x * f.x + f.y * f.y - cylinder->radius * cylinder->radius);
        if (sides.empty())
            return {};
        enter = sides[0];
        exit = sides[1];
        slab(cylinder->base.z, cylinder->base.z + cylinder->axis.z, 2);
    }
    return enter < exit ? Ends{enter, exit} : Ends{};
}

Ends crossingsNaive(const Csg::Node& node, const Ray& ray, float epsilon) {
    if (!node.left)
        return endsNaive(node.shape, ray);
    const Ends left = crossingsNaive(*node.left, ray, epsilon);
    const Ends right = crossingsNaive(*node.right, ray, epsilon);
    Ends merged;
    std::size_t i = 0;
    std::size_t j = 0;
    bool inside = false;
    while (i < left.size() || j < right.size()) {
        const bool both = i < left.size() && j < right.size() && std::abs(left[i] - right[j]) < epsilon;
        const bool fromLeft = both || j >= right.size() || (i < left.size() && left[i] < right[j]);
        const float t = fromLeft ? left[i] : right[j];
        i += fromLeft;
        j += both || !fromLeft;
        const bool now = op(node.op, i % 2 != 0, j % 2 != 0);
        if (now != inside)
            merged.push_back(t);
        inside = now;
    }
    return merged;
}

}  // namespace

std::vector<float> csgCrossingsNaive(const Csg& expression, const Ray& ray, float epsilon) {
    return crossingsNaive(*expression.node(), ray, epsilon);
}

}  // namespace quincunx
