#include "geometry/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/check.h"

namespace quincunx {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double pi = std::numbers::pi;
constexpr double unitRoundoff = 0x1p-53;

/// How far a computed point may be off a surface, in units of the solid's size: carrying the ray to the
/// origin costs 6 roundings, solving 16, the point on the ray 4, its place in the half plane 4; doubled.
constexpr double onSurface = 64 * unitRoundoff;

ProfilePiece linePiece(dvec2 from, dvec2 to) {
    return {.kind = ProfilePiece::Kind::line, .from = from, .to = to};
}

ProfilePiece arcPiece(dvec2 centre, double radius, double startRadians, double endRadians) {
    return {.kind = ProfilePiece::Kind::arc,
            .centre = centre,
            .radius = radius,
            .startRadians = startRadians,
            .endRadians = endRadians};
}

dvec2 direction(double radians) {
    return {std::cos(radians), std::sin(radians)};
}

bool isFullTurn(const ProfilePiece& piece) {
    return piece.kind == ProfilePiece::Kind::arc &&
           std::abs(piece.endRadians - piece.startRadians) > 1.5 * pi;
}

bool isLoop(const std::vector<ProfilePiece>& profile) {
    return profile.size() == 1 && isFullTurn(profile.front());
}

double length(const ProfilePiece& piece) {
    return piece.kind == ProfilePiece::Kind::line
               ? glm::distance(piece.from, piece.to)
               : piece.radius * std::abs(piece.endRadians - piece.startRadians);
}

/// Point and outward normal of a piece, share 0 … 1 of its length after its start.
struct ProfilePoint {
    dvec2 position;
    dvec2 normal;
};

ProfilePoint pointAt(const ProfilePiece& piece, double share) {
    if (piece.kind == ProfilePiece::Kind::line) {
        const dvec2 along = piece.to - piece.from;
        const double norm = std::abs(along.x) + std::abs(along.y);
        return {share == 1 ? piece.to : piece.from + share * along, dvec2(along.y, -along.x) / norm};
    }
    const dvec2 radial = direction(piece.startRadians + share * (piece.endRadians - piece.startRadians));
    return {piece.centre + piece.radius * radial, piece.endRadians > piece.startRadians ? radial : -radial};
}

std::vector<ProfilePiece> profileOf(const Sphere& sphere) {
    QX_CHECK_GT(sphere.radius, 0.0);
    return {arcPiece({0, 0}, sphere.radius, -pi / 2, pi / 2)};
}

std::vector<ProfilePiece> profileOf(const Torus& torus) {
    QX_CHECK_GT(torus.minorRadius, 0.0);
    QX_CHECK_GT(torus.majorRadius, torus.minorRadius);
    return {arcPiece({torus.majorRadius, 0}, torus.minorRadius, 0, 2 * pi)};
}

std::vector<ProfilePiece> profileOf(const Capsule& capsule) {
    QX_CHECK_GT(capsule.radius, 0.0);
    QX_CHECK_GE(capsule.halfLength, 0.0);
    const double r = capsule.radius;
    const double h = capsule.halfLength;
    if (h == 0)
        return profileOf(Sphere{r});
    return {arcPiece({0, -h}, r, -pi / 2, 0), linePiece({r, -h}, {r, h}), arcPiece({0, h}, r, 0, pi / 2)};
}

std::vector<ProfilePiece> profileOf(const Drum& drum) {
    QX_CHECK_GT(drum.rimRadius, 0.0);
    QX_CHECK_LE(drum.rimRadius, drum.halfHeight);
    QX_CHECK_LT(drum.rimRadius, drum.radius);
    const double h = drum.halfHeight;
    const double rim = drum.rimRadius;
    const double flat = drum.radius - rim;
    std::vector<ProfilePiece> pieces = {linePiece({0, -h}, {flat, -h}),
                                        arcPiece({flat, rim - h}, rim, -pi / 2, 0)};
    if (h > rim)
        pieces.push_back(linePiece({drum.radius, rim - h}, {drum.radius, h - rim}));
    pieces.push_back(arcPiece({flat, h - rim}, rim, 0, pi / 2));
    pieces.push_back(linePiece({flat, h}, {0, h}));
    return pieces;
}

std::vector<ProfilePiece> profileOf(const Egg& egg) {
    QX_CHECK_GT(egg.radius, 0.0);
    const double r = egg.radius;
    return {arcPiece({0, 0}, r, -pi / 2, 0), arcPiece({-r, 0}, 2 * r, 0, pi / 4),
            arcPiece({0, r}, (2 - std::numbers::sqrt2) * r, pi / 4, pi / 2)};
}

std::vector<ProfilePiece> profileOf(const Turned& turned) {
    QX_CHECK(!turned.profile.empty());
    return turned.profile;
}

std::vector<ProfilePiece> profileOf(const Shape& shape) {
    return std::visit([](const auto& alternative) { return profileOf(alternative); }, shape);
}

/// a·b - c·d with at most 1.5 ulp of error, whatever cancels (Kahan; Jeannerod, Louvet, Muller 2013).
double differenceOfProducts(double a, double b, double c, double d) {
    const double cd = c * d;
    const double error = std::fma(-c, d, cd);
    return std::fma(a, b, -cd) + error;
}

dvec3 accurateCross(const dvec3& a, const dvec3& b) {
    return {differenceOfProducts(a.y, b.z, a.z, b.y), differenceOfProducts(a.z, b.x, a.x, b.z),
            differenceOfProducts(a.x, b.y, a.y, b.x)};
}

/// A ray through `origin` with a unit direction, `origin` being its point nearest to the frame's origin.
struct CentredRay {
    dvec3 origin;
    dvec3 direction;

    dvec3 at(double s) const { return origin + s * direction; }
};

/// Parameters where a ray may meet the surface that a piece is part of: three critical points and four roots
/// at most.
class Candidates {
  public:
    void add(double s) { values_[count_++] = s; }
    const double* begin() const { return values_.data(); }
    const double* end() const { return values_.data() + count_; }

  private:
    std::array<double, 8> values_;
    std::size_t count_ = 0;
};

/// A stretch of a ray. low ≤ high.
struct Span {
    double low;
    double high;
};

/// The stretch of `within` where the ray may be in the part's box turned about the axis, `margin` added.
std::optional<Span> spanInBox(const CentredRay& ray, const Solid::Part& part, Span within, double margin) {
    const double bottom = part.min.y - margin - ray.origin.y;
    const double top = part.max.y + margin - ray.origin.y;
    if (ray.direction.y != 0) {
        const auto [enter, leave] = std::minmax({bottom / ray.direction.y, top / ray.direction.y});
        within = {std::max(within.low, enter), std::min(within.high, leave)};
    } else if (bottom > 0 || top < 0) {
        return {};
    }
    if (!(within.low <= within.high))
        return {};
    // ρ² has no maximum between the ends.
    const double inner = part.min.x - margin;
    const auto rhoSquared = [&](double s) {
        const dvec3 x = ray.at(s);
        return x.x * x.x + x.z * x.z;
    };
    if (inner > 0 && std::max(rhoSquared(within.low), rhoSquared(within.high)) < inner * inner)
        return {};
    return within;
}

void meetDisc(const CentredRay& ray, double y, Candidates& candidates) {
    if (ray.direction.y != 0)
        candidates.add((y - ray.origin.y) / ray.direction.y);
}

void meetCylinder(const CentredRay& ray, double radius, Candidates& candidates) {
    const dvec2 o(ray.origin.x, ray.origin.z);
    const dvec2 d(ray.direction.x, ray.direction.z);
    const double a = glm::dot(d, d);
    if (a == 0)
        return;
    const double reach = radius * std::sqrt(a);
    const double offset = std::abs(differenceOfProducts(o.x, d.y, o.y, d.x));
    if (offset > reach + onSurface * radius * std::sqrt(a))
        return;
    const double root = std::sqrt(std::max(0.0, (reach - offset) * (reach + offset)));
    const double b = glm::dot(o, d);
    const double q = -(b + std::copysign(root, b));
    const double distance = glm::length(o);
    candidates.add(q / a);
    if (q != 0)
        candidates.add((distance - radius) * (distance + radius) / q);
}

void meetBall(const CentredRay& ray, double centreY, double radius, Candidates& candidates) {
    const dvec3 m = ray.origin - dvec3(0, centreY, 0);
    const double b = glm::dot(m, ray.direction);
    const double distance = glm::length(m - b * ray.direction);
    if (distance > radius * (1 + onSurface) + onSurface * std::abs(centreY))
        return;
    const double root = std::sqrt(std::max(0.0, (radius - distance) * (radius + distance)));
    candidates.add(-b - root);
    candidates.add(-b + root);
}

/// The zero between `low` and `high`, where `value` has opposite signs: Newton's steps while they stay
/// between the nearest points of either sign and halve fast enough, bisection otherwise.
template <typename Value, typename Slope>
double zeroBetween(double low, double high, double valueLow, const Value& value, const Slope& slope) {
    double s = 0.5 * (low + high);
    double lastStep = high - low;
    for (int i = 0; i < 128; ++i) {
        const double v = value(s);
        if (v == 0)
            return s;
        ((v < 0) == (valueLow < 0) ? low : high) = s;
        double next = s - v / slope(s);
        if (!(next > low && next < high) || std::abs(next - s) > 0.5 * lastStep)
            next = 0.5 * (low + high);
        lastStep = std::abs(next - s);
        if (next == s || lastStep <= 2 * unitRoundoff * std::abs(next))
            return next;
        s = next;
    }
    return s;
}

/// The torus with its centre at height centreY, majorRadius of either sign; what lies in `span` of the ray.
void meetTorus(const CentredRay& ray, double centreY, double majorRadius, double minorRadius,
               const Span& span, Candidates& candidates) {
    const double R = std::abs(majorRadius);
    const double r = minorRadius;
    const dvec3 shifted = ray.origin - dvec3(0, centreY, 0);
    const double nearest = -glm::dot(shifted, ray.direction);
    const dvec3 m = shifted + nearest * ray.direction;
    const dvec3& d = ray.direction;

    const double low = span.low - nearest;
    const double high = span.high - nearest;

    // With m·d = 0 the quartic is s⁴ + 2 p s² + q s + const.
    const double p = glm::dot(m, m) + (R - r) * (R + r) - 2 * R * R * (d.x * d.x + d.z * d.z);
    const double q = -8 * R * R * (m.x * d.x + m.z * d.z);
    const auto slope = [=](double s) { return (4 * s * s + 4 * p) * s + q; };
    const auto curvature = [=](double s) { return 12 * s * s + 4 * p; };
    const auto factored = [&](double s) {
        const dvec3 x = m + s * d;
        const double rho = std::sqrt(x.x * x.x + x.z * x.z);
        const double near = std::sqrt((rho - R) * (rho - R) + x.y * x.y);
        const double far = std::sqrt((rho + R) * (rho + R) + x.y * x.y);
        return (near - r) * (near + r) * (far - r) * (far + r);
    };

    // Between inflections the slope is monotone, between critical points the quartic is.
    std::array<double, 7> split{};
    std::size_t splits = 0;
    const auto addSplit = [&](double s) { split[splits++] = s; };
    const double inflection = p < 0 ? std::sqrt(-p / 3) : 0;
    const std::array<double, 4> ends = {low, std::clamp(-inflection, low, high),
                                        std::clamp(inflection, low, high), high};
    for (std::size_t i = 0; i < 4; ++i) {
        if (i == 0 || ends[i] > ends[i - 1])
            addSplit(ends[i]);
        if (i == 3 || !(ends[i + 1] > ends[i]))
            continue;
        const double slopeLow = slope(ends[i]);
        const double slopeHigh = slope(ends[i + 1]);
        if ((slopeLow < 0) != (slopeHigh < 0)) {
            const double critical = zeroBetween(ends[i], ends[i + 1], slopeLow, slope, curvature);
            addSplit(critical);
            candidates.add(critical + nearest);  // where a tangent touches without a change of sign
        }
    }
    double valueBefore = 0;
    for (std::size_t i = 0; i < splits; ++i) {
        const double value = factored(split[i]);
        if (i > 0 && (value < 0) != (valueBefore < 0))
            candidates.add(zeroBetween(split[i - 1], split[i], valueBefore, factored, slope) + nearest);
        valueBefore = value;
    }
}

/// The point of a piece next to `point`, if the two are no farther apart than `tolerance`.
std::optional<Hit> snap(const Solid::Part& part, const dvec3& point, double tolerance) {
    const ProfilePiece& piece = part.piece;
    const double rho = std::sqrt(point.x * point.x + point.z * point.z);
    Hit hit;
    if (piece.kind == ProfilePiece::Kind::line) {
        const dvec2 along = piece.to - piece.from;
        if (along.x != 0) {
            const auto [low, high] = std::minmax(piece.from.x, piece.to.x);
            if (rho < low - tolerance || rho > high + tolerance)
                return {};
            hit.position = {point.x, piece.from.y, point.z};
            hit.normal = {0, along.x > 0 ? -1 : 1, 0};
            return std::abs(point.y - piece.from.y) <= tolerance ? std::optional(hit) : std::nullopt;
        }
        if (std::abs(rho - piece.from.x) > tolerance)
            return {};
        const auto [low, high] = std::minmax(piece.from.y, piece.to.y);
        if (point.y < low - tolerance || point.y > high + tolerance)
            return {};
        const dvec2 out = dvec2(point.x, point.z) / rho;
        hit.position = {out.x * piece.from.x, point.y, out.y * piece.from.x};
        hit.normal = (along.y > 0 ? 1.0 : -1.0) * dvec3(out.x, 0, out.y);
        return hit;
    }

    const dvec2 offset = dvec2(rho, point.y) - piece.centre;
    const double distance = glm::length(offset);
    if (std::abs(distance - piece.radius) > tolerance)
        return {};
    const dvec2& a = part.first;
    const dvec2& b = part.last;
    if (!part.fullTurn &&
        (a.x * offset.y - a.y * offset.x < -tolerance || offset.x * b.y - offset.y * b.x < -tolerance))
        return {};
    const double sign = piece.endRadians > piece.startRadians ? 1 : -1;
    if (piece.centre.x == 0) {
        const dvec3 radial = (point - dvec3(0, piece.centre.y, 0)) / distance;
        hit.position = dvec3(0, piece.centre.y, 0) + piece.radius * radial;
        hit.normal = sign * radial;
        return hit;
    }
    if (rho == 0)
        return {};
    const dvec2 radial = offset / distance;
    const dvec2 out = dvec2(point.x, point.z) / rho;
    const dvec2 onProfile = piece.centre + piece.radius * radial;
    hit.position = {onProfile.x * out.x, onProfile.y, onProfile.x * out.y};
    hit.normal = sign * dvec3(radial.x * out.x, radial.y, radial.x * out.y);
    return hit;
}

/// The largest distance of a piece's points from `eye`.
double reachFrom(const dvec2& eye, const ProfilePiece& piece) {
    const double ends = std::max(glm::distance(eye, pointAt(piece, 0).position),
                                 glm::distance(eye, pointAt(piece, 1).position));
    if (piece.kind == ProfilePiece::Kind::line)
        return ends;
    // The circle's farthest point lies behind its centre; does the arc have it?
    const dvec2 away = piece.centre - eye;
    const double distance = glm::length(away);
    const dvec2 farthest = distance > 0 ? away / distance : dvec2(1, 0);
    const dvec2 middle = direction(0.5 * (piece.startRadians + piece.endRadians));
    const double halfTurn = 0.5 * std::abs(piece.endRadians - piece.startRadians);
    return distance == 0 || glm::dot(middle, farthest) >= std::cos(std::min(halfTurn, pi))
               ? distance + piece.radius
               : ends;
}

/// Steps along every piece of a profile, and their sum.
struct Steps {
    std::vector<int> ofPiece;
    std::size_t sum = 0;
};

Steps profileSteps(const std::vector<ProfilePiece>& profile, int segments) {
    QX_CHECK_GE(segments, 3);
    QX_CHECK_LE(segments, 4096);
    double widest = 0;
    for (const ProfilePiece& piece : profile)
        widest = std::max(widest, piece.kind == ProfilePiece::Kind::line ? std::max(piece.from.x, piece.to.x)
                                                                         : piece.centre.x + piece.radius);
    const double step = 2 * pi * widest / segments;
    Steps steps;
    for (const ProfilePiece& piece : profile) {
        // A length that is a whole number of steps but for rounding gets that number.
        const double wanted = std::ceil(length(piece) / step * (1 - 8 * unitRoundoff));
        QX_CHECK_LT(wanted, 1e6);
        int least = 1;
        if (piece.kind == ProfilePiece::Kind::arc) {
            const double thirds = std::abs(piece.endRadians - piece.startRadians) / (2 * pi / 3);
            least = std::max(least, static_cast<int>(std::ceil(thirds * (1 - 8 * unitRoundoff))));
        }
        steps.ofPiece.push_back(std::max(least, static_cast<int>(wanted)));
        steps.sum += static_cast<std::size_t>(steps.ofPiece.back());
    }
    if (!isLoop(profile) && steps.sum < 2) {
        steps.ofPiece.front() = 2;
        steps.sum = 2;
    }
    QX_CHECK_LT(static_cast<double>(steps.sum + 1) * (segments + 1), 0x1p31);
    return steps;
}

}  // namespace

Lathe& Lathe::line(double length) {
    QX_CHECK_GT(length, 0.0);
    const double quarters = headingDegrees_ / 90;
    QX_CHECK_EQ(quarters, std::round(quarters));
    const dvec2 heading = glm::round(direction(quarters * pi / 2));
    pieces_.push_back(linePiece(position_, position_ + length * heading));
    position_ = pieces_.back().to;
    return *this;
}

Lathe& Lathe::arc(double radius, double degrees) {
    QX_CHECK_GT(radius, 0.0);
    QX_CHECK_NE(degrees, 0.0);
    QX_CHECK_LE(std::abs(degrees), 180.0);
    const double side = degrees > 0 ? 1 : -1;
    // Seen from the centre, the start lies a quarter turn to the right of the heading, or to the left.
    const double startDegrees = headingDegrees_ - side * 90;
    const double start = startDegrees * pi / 180;
    const double end = (startDegrees + degrees) * pi / 180;
    dvec2 centre = position_ - radius * direction(start);
    // What is left of a centre meant for the axis after the roundings of a chain of moves.
    const double moved = std::abs(position_.x) + radius;
    if (std::abs(centre.x) <= 64 * unitRoundoff * moved)
        centre.x = 0;
    pieces_.push_back(arcPiece(centre, radius, start, end));
    position_ = centre + radius * direction(end);
    headingDegrees_ += degrees;
    return *this;
}

Turned Lathe::finish() const {
    QX_CHECK(!pieces_.empty());
    QX_CHECK_EQ(std::fmod(headingDegrees_ - 180, 360.0), 0.0);
    Turned turned{pieces_};
    double size = 0;
    for (const ProfilePiece& piece : pieces_)
        size += length(piece);
    QX_CHECK_LE(std::abs(position_.x), 64 * unitRoundoff * size);
    ProfilePiece& last = turned.profile.back();
    if (last.kind == ProfilePiece::Kind::line)
        last.to.x = 0;
    else
        QX_CHECK_EQ(last.centre.x, 0.0);
    return turned;
}

Solid::Solid(const Shape& shape) {
    double bottom = std::numeric_limits<double>::infinity();
    double top = -bottom;
    for (const ProfilePiece& piece : profileOf(shape)) {
        Part part{.piece = piece};
        const auto [first, last] = std::minmax(piece.startRadians, piece.endRadians);
        part.first = direction(first);
        part.last = direction(last);
        part.fullTurn = isFullTurn(piece);
        part.min = glm::min(pointAt(piece, 0).position, pointAt(piece, 1).position);
        part.max = glm::max(pointAt(piece, 0).position, pointAt(piece, 1).position);
        if (piece.kind == ProfilePiece::Kind::arc)
            for (double quarter = std::ceil(first / (pi / 2)); quarter <= last / (pi / 2); ++quarter) {
                const dvec2 extreme = piece.centre + piece.radius * direction(quarter * (pi / 2));
                part.min = glm::min(part.min, extreme);
                part.max = glm::max(part.max, extreme);
            }
        parts_.push_back(part);
        bottom = std::min(bottom, part.min.y);
        top = std::max(top, part.max.y);
    }
    boundingCentreY_ = 0.5 * (bottom + top);
    for (const Part& part : parts_)
        boundingRadius_ = std::max(boundingRadius_, reachFrom({0, boundingCentreY_}, part.piece));
    boundingRadius_ *= 1 + 16 * unitRoundoff;
}

std::optional<Hit> Solid::intersect(const DRay& ray) const {
    const double squared = glm::dot(ray.direction, ray.direction);
    QX_CHECK_GT(squared, 0.0);
    const double speed = std::sqrt(squared);
    const double toCentre = -glm::dot(ray.origin, ray.direction) / squared;
    CentredRay centred;
    centred.direction = ray.direction / speed;
    centred.origin = accurateCross(ray.direction, accurateCross(ray.origin, ray.direction)) / squared;

    const double tolerance = onSurface * size();
    const dvec3 fromBall = centred.origin - dvec3(0, boundingCentreY_, 0);
    const double alongBall = glm::dot(fromBall, centred.direction);
    const double reach = boundingRadius_ + 2 * tolerance;
    // Both squares are below 4 size², and their rounding errors below 32 ε size².
    const double halfChordSquared = reach * reach + 32 * unitRoundoff * size() * size() -
                                    (glm::dot(fromBall, fromBall) - alongBall * alongBall);
    if (halfChordSquared < 0)
        return {};
    const double halfChord = std::sqrt(halfChordSquared);
    const Span inBall{-alongBall - halfChord, -alongBall + halfChord};

    std::optional<Hit> nearest;
    for (const Part& part : parts_) {
        const std::optional<Span> span = spanInBox(centred, part, inBall, 2 * tolerance);
        if (!span)
            continue;
        const ProfilePiece& piece = part.piece;
        Candidates candidates;
        if (piece.kind == ProfilePiece::Kind::arc) {
            if (piece.centre.x == 0)
                meetBall(centred, piece.centre.y, piece.radius, candidates);
            else
                meetTorus(centred, piece.centre.y, piece.centre.x, piece.radius, *span, candidates);
        } else if (piece.from.y == piece.to.y) {
            meetDisc(centred, piece.from.y, candidates);
        } else {
            meetCylinder(centred, piece.from.x, candidates);
        }
        for (const double s : candidates) {
            const double t = toCentre + s / speed;
            if (!(t >= 0) || (nearest && t >= nearest->t))
                continue;
            if (std::optional<Hit> hit = snap(part, centred.at(s), tolerance)) {
                hit->t = t;
                nearest = hit;
            }
        }
    }
    return nearest;
}

std::optional<Hit> intersect(const Shape& shape, const DRay& ray) {
    return Solid(shape).intersect(ray);
}

std::size_t triangleCount(const Shape& shape, int segments) {
    const std::vector<ProfilePiece> profile = profileOf(shape);
    const std::size_t steps = profileSteps(profile, segments).sum;
    return 2 * static_cast<std::size_t>(segments) * (isLoop(profile) ? steps : steps - 1);
}

Mesh tessellate(const Shape& shape, int segments, std::string name) {
    const std::vector<ProfilePiece> profile = profileOf(shape);
    const Steps steps = profileSteps(profile, segments);
    const bool loop = isLoop(profile);

    struct Row {
        ProfilePoint point;
        double v;
    };
    double total = 0;
    for (const ProfilePiece& piece : profile)
        total += length(piece);
    std::vector<Row> rows;
    rows.reserve(steps.sum + 1);
    rows.push_back({pointAt(profile.front(), 0), 1});
    double before = 0;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        for (int j = 1; j <= steps.ofPiece[i]; ++j) {
            const double share = static_cast<double>(j) / steps.ofPiece[i];
            rows.push_back({pointAt(profile[i], share), 1 - (before + share * length(profile[i])) / total});
        }
        before += length(profile[i]);
    }
    rows.back().v = 0;
    if (loop) {
        rows.back().point = rows.front().point;
    } else {
        rows.front().point = {{0, rows.front().point.position.y}, {0, -1}};
        rows.back().point.position.x = 0;
        rows.back().point.normal = {0, 1};
    }

    std::vector<dvec2> turn(static_cast<std::size_t>(segments) + 1);
    for (std::size_t j = 0; j < turn.size() - 1; ++j)
        turn[j] = direction(2 * pi * static_cast<double>(j) / segments);
    turn.back() = turn.front();

    Mesh mesh;
    mesh.name = std::move(name);
    const std::size_t columns = turn.size();
    mesh.positions.reserve(rows.size() * columns);
    mesh.normals.reserve(rows.size() * columns);
    mesh.texcoords.reserve(rows.size() * columns);
    const std::size_t lastRow = rows.size() - 1;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto& [position, normal] = rows[i].point;
        // At the ends of the axis there is a vertex for each triangle, in the middle of its texture.
        const bool pole = !loop && (i == 0 || i == lastRow);
        for (std::size_t j = 0; j < (pole ? columns - 1 : columns); ++j) {
            const dvec2 around(turn[j].y, turn[j].x);
            mesh.positions.emplace_back(position.x * around.x, position.y, position.x * around.y);
            mesh.normals.emplace_back(normal.x * around.x, normal.y, normal.x * around.y);
            mesh.texcoords.emplace_back((static_cast<double>(j) + (pole ? 0.5 : 0.0)) / segments, rows[i].v);
        }
    }

    mesh.indices.reserve(3 * triangleCount(shape, segments));
    std::size_t below = 0;
    for (std::size_t i = 0; i < lastRow; ++i) {
        const bool fromPole = !loop && i == 0;
        const bool toPole = !loop && i + 1 == lastRow;
        const std::size_t above = below + (fromPole ? columns - 1 : columns);
        for (std::size_t j = 0; j + 1 < columns; ++j) {
            const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
                for (const std::size_t index : {a, b, c})
                    mesh.indices.push_back(static_cast<std::uint32_t>(index));
            };
            if (!fromPole)
                add(below + j, below + j + 1, above + j + (toPole ? 0 : 1));
            if (!toPole)
                add(below + j, above + j + 1, above + j);
        }
        below = above;
    }
    return mesh;
}

}  // namespace quincunx
