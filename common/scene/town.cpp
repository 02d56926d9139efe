#include "scene/town.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string>

#include <glm/gtc/matrix_transform.hpp>

#include "base/random.h"
#include "geometry/mesh_builder.h"
#include "geometry/normals.h"
#include "geometry/polygon.h"
#include "geometry/shapes.h"
#include "math/vector.h"
#include "scene/finish.h"

namespace quincunx {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr float degree = pi / 180;

// ---- the plan ----

constexpr float ringStreet = 72;       ///< distance of the outer street's middle from the centre
constexpr float streetHalfWidth = 4;   ///< two lanes
constexpr float pavementWidth = 2.6f;  ///< on both sides
constexpr float pavementHeight = 0.12f;
constexpr float roundaboutRadius = 18;
constexpr float islandRadius = 8;
constexpr float roadEnd = 290;  ///< the four roads that leave
constexpr float lane = 2;       ///< from the middle of the street to that of a lane
constexpr float markingHeight = 0.015f;
constexpr float frontGarden = 2.6f;  ///< from the pavement to a house

// ---- materials ----

/// As most of the town is.
struct MattFinish {
    glm::vec3 diffuse;
    glm::vec3 specular{0};
    float shininess = 10;
    float roughness = 0.9f;
    glm::vec3 emission{0};
};

Material material(std::string name, const MattFinish& finish) {
    return makeMaterial(std::move(name), {.diffuse = finish.diffuse,
                                          .specular = finish.specular,
                                          .shininess = finish.shininess,
                                          .roughness = finish.roughness,
                                          .emission = finish.emission});
}

constexpr std::array<glm::vec3, 9> wallColors = {{{0.72f, 0.60f, 0.40f},
                                                  {0.66f, 0.36f, 0.32f},
                                                  {0.42f, 0.58f, 0.45f},
                                                  {0.38f, 0.51f, 0.64f},
                                                  {0.70f, 0.44f, 0.27f},
                                                  {0.50f, 0.42f, 0.60f},
                                                  {0.72f, 0.58f, 0.24f},
                                                  {0.70f, 0.68f, 0.62f},
                                                  {0.68f, 0.50f, 0.46f}}};
constexpr std::array<glm::vec3, 4> roofColors = {
    {{0.42f, 0.125f, 0.07f}, {0.34f, 0.10f, 0.06f}, {0.47f, 0.18f, 0.09f}, {0.12f, 0.145f, 0.185f}}};
constexpr std::array<glm::vec3, 5> doorColors = {{{0.30f, 0.05f, 0.045f},
                                                  {0.04f, 0.16f, 0.11f},
                                                  {0.05f, 0.11f, 0.26f},
                                                  {0.22f, 0.11f, 0.045f},
                                                  {0.09f, 0.20f, 0.24f}}};

/// Adds meshes, materials and instances to the scene under construction.
class Site {
  public:
    explicit Site(std::uint64_t seed) : random(seed) {}

    std::size_t add(Material made) {
        town.scene.materials.push_back(std::move(made));
        return town.scene.materials.size() - 1;
    }
    std::size_t add(Mesh mesh) {
        town.scene.meshes.push_back(std::move(mesh));
        return town.scene.meshes.size() - 1;
    }
    void place(std::size_t mesh, std::size_t materialIndex, const glm::mat4& where = glm::mat4(1)) {
        town.scene.instances.push_back({town.scene.meshes[mesh].name, mesh, materialIndex, where});
    }
    void placeGround(Mesh mesh, std::size_t materialIndex) {
        town.ground.push_back(town.scene.instances.size());
        place(add(std::move(mesh)), materialIndex);
    }
    float uniform(float low, float high) { return low + (high - low) * random.uniform(); }
    std::size_t pick(std::size_t count) { return static_cast<std::size_t>(random.below(count)); }

    Town town;
    Random random;
};

glm::mat4 at(float x, float y, float z) {
    return glm::translate(glm::mat4(1), {x, y, z});
}
glm::mat4 at(glm::vec3 p) {
    return glm::translate(glm::mat4(1), p);
}
glm::mat4 turnedLeft(float radians) {
    return glm::rotate(glm::mat4(1), radians, {0, 1, 0});
}
glm::mat4 scaled(float x, float y, float z) {
    return glm::scale(glm::mat4(1), glm::vec3(x, y, z));
}

// ---- ground ----

float smoothStep(float low, float high, float x) {
    const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
}

/// The land around: flat in the town and along the roads that leave it, hills outside.
float landHeight(float x, float z) {
    const float radius = std::sqrt(x * x + z * z);
    const float waves = std::sin(x * 0.021f + 1.3f) * std::cos(z * 0.017f - 0.4f) +
                        0.5f * std::sin(x * 0.041f - z * 0.033f + 2.1f);
    const float near = smoothStep(118, 240, radius) * (7 + 5 * waves);
    const float far = smoothStep(270, 520, radius) * (34 + 17 * waves);
    const float valley = radius > roadEnd ? 1 : smoothStep(12, 58, std::min(std::abs(x), std::abs(z)));
    return -0.05f + near * std::max(valley, smoothStep(255, roadEnd, radius)) + far;
}

Mesh land(float innerRadius, float outerRadius, int rings, std::string name) {
    constexpr int sectors = 72;
    std::vector<std::vector<glm::vec3>> all;
    // Outermost first, so that the skin's outside is up.
    for (int i = rings; i >= 0; --i) {
        const float t = static_cast<float>(i) / static_cast<float>(rings);
        const float radius = innerRadius + (outerRadius - innerRadius) * t;
        std::vector<glm::vec3> ring;
        for (int k = 0; k < sectors; ++k) {
            const float angle = 2 * pi * static_cast<float>(k) / sectors;
            const float x = radius * std::sin(angle);
            const float z = radius * std::cos(angle);
            ring.emplace_back(x, landHeight(x, z), z);
        }
        all.push_back(std::move(ring));
    }
    return loft(all, false, innerRadius < 100, std::move(name));
}

/// A flat sheet over an outline (x, z) of any simple shape, seen from above, with a rim down to `bottom`.
void slab(MeshBuilder& builder, std::vector<glm::vec2> outline, float top, float bottom) {
    float area = 0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const glm::vec2 a = outline[i];
        const glm::vec2 b = outline[(i + 1) % outline.size()];
        area += a.y * b.x - a.x * b.y;
    }
    if (area < 0)
        std::reverse(outline.begin(), outline.end());
    std::vector<glm::vec3> corners;
    corners.reserve(outline.size());
    for (const glm::vec2 p : outline)
        corners.emplace_back(p.x, top, p.y);
    std::vector<std::uint32_t> triangles(3 * (corners.size() - 2));
    triangulatePolygon(corners, triangles);
    for (std::size_t i = 0; i < triangles.size(); i += 3)
        builder.triangle(corners[triangles[i]], corners[triangles[i + 1]], corners[triangles[i + 2]]);
    if (bottom >= top)
        return;
    const glm::vec3 down(0, bottom - top, 0);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::vec3 a = corners[i];
        const glm::vec3 b = corners[(i + 1) % corners.size()];
        builder.quad(a + down, b + down, b, a);
    }
}

void arc(std::vector<glm::vec2>& outline, glm::vec2 centre, float radius, float fromDegrees, float toDegrees,
         int steps) {
    for (int i = 0; i <= steps; ++i) {
        const float angle =
            (fromDegrees + (toDegrees - fromDegrees) * static_cast<float>(i) / static_cast<float>(steps)) *
            degree;
        outline.push_back(centre + radius * glm::vec2(std::cos(angle), std::sin(angle)));
    }
}

/// The block of a quarter, `inset` from the kerb: a square whose corner at the roundabout is cut out.
std::vector<glm::vec2> blockOutline(glm::vec2 quarter, float inset) {
    const float low = streetHalfWidth + inset;
    const float high = ringStreet - streetHalfWidth - inset;
    const float corner = 4;
    const float cut = roundaboutRadius + inset;
    const float start = std::asin(low / cut) / degree;
    std::vector<glm::vec2> outline;
    arc(outline, {0, 0}, cut, 90 - start, start, 10);
    arc(outline, {high - corner, low + corner}, corner, 270, 360, 5);
    arc(outline, {high - corner, high - corner}, corner, 0, 90, 5);
    arc(outline, {low + corner, high - corner}, corner, 90, 180, 5);
    for (glm::vec2& p : outline)
        p *= quarter;
    return outline;
}

constexpr std::array<glm::vec2, 4> quarters = {{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};

void strip(MeshBuilder& builder, float x0, float x1, float z0, float z1, float height) {
    builder.quad({x0, height, z1}, {x1, height, z1}, {x1, height, z0}, {x0, height, z0});
}

/// `strip`, along z or, with `across`, the same along x.
void along(MeshBuilder& builder, bool across, float middle, float halfWidth, float from, float to,
           float height) {
    if (across)
        strip(builder, from, to, middle - halfWidth, middle + halfWidth, height);
    else
        strip(builder, middle - halfWidth, middle + halfWidth, from, to, height);
}

void layStreets(Site& site) {
    const std::size_t grass = site.add(material("meadow", {.diffuse = {0.165f, 0.30f, 0.075f}}));
    const std::size_t hills = site.add(material("hills", {.diffuse = {0.15f, 0.285f, 0.13f}}));
    const std::size_t mountains = site.add(material("far hills", {.diffuse = {0.20f, 0.32f, 0.30f}}));
    const std::size_t asphalt =
        site.add(material("asphalt", {.diffuse = {0.115f, 0.115f, 0.125f}, .specular = glm::vec3(0.02f)}));
    const std::size_t paint = site.add(material("road paint", {.diffuse = {0.70f, 0.69f, 0.64f}}));
    const std::size_t pavement = site.add(material("pavement", {.diffuse = {0.43f, 0.39f, 0.345f}}));
    const std::size_t lawn = site.add(material("lawn", {.diffuse = {0.19f, 0.365f, 0.085f}}));

    site.placeGround(land(30, 130, 8, "meadow"), grass);
    site.placeGround(land(130, 300, 16, "hills"), hills);
    site.placeGround(land(300, 640, 10, "far hills"), mountains);

    MeshBuilder street;
    MeshBuilder lines;
    for (const bool across : {false, true}) {
        for (const float middle : {-ringStreet, ringStreet})
            along(street, across, middle, streetHalfWidth, -ringStreet - streetHalfWidth,
                  ringStreet + streetHalfWidth, 0);
        for (const float side : {-1.0f, 1.0f}) {
            // In pieces, so that the far end does not blur the near one.
            for (const float from : {15.0f, 60.0f, 110.0f, 170.0f, 230.0f}) {
                const float to = from < 50    ? 60
                                 : from < 100 ? 110
                                 : from < 170 ? 170
                                 : from < 230 ? 230
                                              : roadEnd;
                along(street, across, 0, streetHalfWidth, std::min(side * from, side * to),
                      std::max(side * from, side * to), 0);
            }
        }
        // Dashes in the middle, and zebras before the roundabout.
        const auto dashes = [&](float middle, float from, float to) {
            for (float p = from; p + 2 <= to; p += 4.4f)
                along(lines, across, middle, 0.09f, p, p + 2, markingHeight);
        };
        const float clear = ringStreet - streetHalfWidth - 2;
        for (const float side : {-1.0f, 1.0f}) {
            for (const float half : {-1.0f, 1.0f})
                dashes(side * ringStreet, half > 0 ? 7 : -clear, half > 0 ? clear : -7);
            dashes(0, side > 0 ? 28 : -clear, side > 0 ? clear : -28);
            dashes(0, side > 0 ? ringStreet + 7 : -180, side > 0 ? 180 : -ringStreet - 7);
            const float zebra = side * 23.5f;
            for (int bar = -3; bar <= 3; ++bar)
                along(lines, !across, zebra, 1.6f, static_cast<float>(bar) * 1.1f - 0.27f,
                      static_cast<float>(bar) * 1.1f + 0.27f, markingHeight);
        }
    }
    street.disc({0, 0.004f, 0}, roundaboutRadius, 48);
    // The dashed edge where streets meet the roundabout, and its inner line.
    for (int i = 0; i < 48; ++i) {
        const float a = 2 * pi * static_cast<float>(i) / 48;
        const float b = a + pi / 48;
        const auto on = [](float radius, float angle) {
            return glm::vec3(radius * std::sin(angle), markingHeight + 0.004f, radius * std::cos(angle));
        };
        const float offStreet = std::abs(std::sin(2 * (a + b) / 2));
        if (offStreet < 0.5f)
            lines.quad(on(roundaboutRadius - 0.2f, a), on(roundaboutRadius, a), on(roundaboutRadius, b),
                       on(roundaboutRadius - 0.2f, b));
        lines.quad(on(islandRadius + 0.5f, a), on(islandRadius + 0.65f, a), on(islandRadius + 0.65f, b),
                   on(islandRadius + 0.5f, b));
    }
    site.placeGround(street.take("streets"), asphalt);
    site.placeGround(lines.take("road markings"), paint);

    MeshBuilder pavements;
    MeshBuilder lawns;
    for (const glm::vec2 quarter : quarters) {
        slab(pavements, blockOutline(quarter, 0), pavementHeight, 0);
        slab(lawns, blockOutline(quarter, pavementWidth), pavementHeight + 0.03f, pavementHeight);
    }
    const float outer = ringStreet + streetHalfWidth;
    for (const float side : {-1.0f, 1.0f})
        for (const float half : {-1.0f, 1.0f}) {
            const float from = half > 0 ? streetHalfWidth : -outer - pavementWidth;
            const float to = half > 0 ? outer + pavementWidth : -streetHalfWidth;
            const float near = side > 0 ? outer : -outer - pavementWidth;
            pavements.box({near, -0.1f, from}, {near + pavementWidth, pavementHeight, to}, {.bottom = false});
            // Without the corners, which are there already.
            const float innerFrom = half > 0 ? from : -outer;
            const float innerTo = half > 0 ? outer : to;
            pavements.box({innerFrom, -0.1f, near}, {innerTo, pavementHeight, near + pavementWidth},
                          {.bottom = false});
        }
    site.placeGround(pavements.take("pavements"), pavement);
    site.placeGround(lawns.take("lawns"), lawn);
}

// ---- houses ----

/// The meshes of one kind of house, by what they are made of.
struct HouseKind {
    std::size_t walls = 0;
    std::size_t roof = 0;
    std::size_t trim = 0;
    std::size_t glass = 0;
    std::size_t door = 0;
    std::size_t stone = 0;
    float width = 0;
    float depth = 0;
};

struct HouseParts {
    MeshBuilder walls;
    MeshBuilder roof;
    MeshBuilder trim;
    MeshBuilder glass;
    MeshBuilder door;  ///< and shutters
    MeshBuilder stone;
};

/// A plane wall's own axes: `right` and `out` level and perpendicular.
struct Wall {
    glm::vec3 origin;  ///< middle of its foot
    glm::vec3 right;
    glm::vec3 out;

    glm::vec3 at(float x, float y, float depth) const {
        return origin + x * right + glm::vec3(0, y, 0) + depth * out;
    }
};

/// A board on a wall, without its back.
void board(MeshBuilder& builder, const Wall& wall, glm::vec2 middle, glm::vec2 half, float from, float to) {
    const auto p = [&](float x, float y, float depth) {
        return wall.at(middle.x + x * half.x, middle.y + y * half.y, depth);
    };
    builder.quad(p(-1, -1, to), p(1, -1, to), p(1, 1, to), p(-1, 1, to));
    builder.quad(p(-1, 1, to), p(1, 1, to), p(1, 1, from), p(-1, 1, from));
    builder.quad(p(-1, -1, from), p(1, -1, from), p(1, -1, to), p(-1, -1, to));
    builder.quad(p(1, -1, to), p(1, -1, from), p(1, 1, from), p(1, 1, to));
    builder.quad(p(-1, -1, from), p(-1, -1, to), p(-1, 1, to), p(-1, 1, from));
}

void sheet(MeshBuilder& builder, const Wall& wall, glm::vec2 middle, glm::vec2 half, float depth) {
    const auto p = [&](float x, float y) {
        return wall.at(middle.x + x * half.x, middle.y + y * half.y, depth);
    };
    builder.quad(p(-1, -1), p(1, -1), p(1, 1), p(-1, 1));
}

/// One for the sides that the street does not see well.
void plainWindow(HouseParts& parts, const Wall& wall, glm::vec2 middle, glm::vec2 half) {
    sheet(parts.trim, wall, middle, half, 0.04f);
    sheet(parts.glass, wall, middle, half - glm::vec2(0.09f), 0.055f);
    sheet(parts.trim, wall, middle, {0.028f, half.y - 0.05f}, 0.07f);
    sheet(parts.trim, wall, middle + glm::vec2(0, half.y * 0.25f), {half.x - 0.05f, 0.028f}, 0.07f);
}

void window(HouseParts& parts, const Wall& wall, glm::vec2 middle, glm::vec2 half, bool shutters) {
    board(parts.trim, wall, middle, half, 0, 0.07f);
    sheet(parts.glass, wall, middle, half - glm::vec2(0.09f), 0.085f);
    sheet(parts.trim, wall, middle, {0.028f, half.y - 0.05f}, 0.1f);
    sheet(parts.trim, wall, middle + glm::vec2(0, half.y * 0.25f), {half.x - 0.05f, 0.028f}, 0.1f);
    board(parts.trim, wall, middle - glm::vec2(0, half.y + 0.06f), {half.x + 0.1f, 0.06f}, 0, 0.17f);
    if (shutters)
        for (const float side : {-1.0f, 1.0f})
            sheet(parts.door, wall, middle + glm::vec2(side * (1.52f * half.x + 0.03f), 0),
                  {half.x * 0.5f, half.y + 0.03f}, 0.05f);
}

void doorway(HouseParts& parts, const Wall& wall, float x, float foot) {
    board(parts.trim, wall, {x, foot + 1.15f}, {0.66f, 1.15f}, 0, 0.09f);
    board(parts.door, wall, {x, foot + 1.05f}, {0.5f, 1.05f}, 0, 0.12f);
    sheet(parts.glass, wall, {x, foot + 1.62f}, {0.3f, 0.24f}, 0.13f);
    board(parts.stone, wall, {x, foot * 0.5f}, {0.85f, foot * 0.5f}, 0, 0.8f);
    // A little roof over it.
    const glm::vec3 a = wall.at(x - 0.95f, foot + 2.5f, 0);
    const glm::vec3 b = wall.at(x + 0.95f, foot + 2.5f, 0);
    const glm::vec3 c = wall.at(x + 0.95f, foot + 2.34f, 0.85f);
    const glm::vec3 d = wall.at(x - 0.95f, foot + 2.34f, 0.85f);
    const glm::vec3 thick(0, 0.1f, 0);
    parts.roof.quad(d + thick, c + thick, b + thick, a + thick);
    parts.roof.quad(d, c, c + thick, d + thick);
    parts.roof.quad(a, b, c, d);
    parts.roof.quad(c, b, b + thick, c + thick);
    parts.roof.quad(a, d, d + thick, a + thick);
}

/// A ridged roof over the box ±x, ±z; the ridge runs along x. Gables are walls.
void gableRoof(HouseParts& parts, float halfX, float halfZ, float eaves, float rise, float overhang) {
    const float slope = rise / halfZ;
    const float low = eaves - slope * overhang;
    const float ridge = eaves + rise;
    const float x = halfX + overhang * 0.7f;
    const float z = halfZ + overhang;
    const glm::vec3 thick(0, 0.2f, 0);
    for (const float side : {-1.0f, 1.0f}) {
        const glm::vec3 a(-x * side, low, z * side);
        const glm::vec3 b(x * side, low, z * side);
        const glm::vec3 c(x * side, ridge, 0);
        const glm::vec3 d(-x * side, ridge, 0);
        parts.roof.quad(a + thick, b + thick, c + thick, d + thick);
        parts.trim.quad(d, c, b, a);
        parts.trim.quad(a, b, b + thick, a + thick);
        // Barge boards.
        parts.trim.quad(b, c, c + thick, b + thick);
        parts.trim.quad(d, a, a + thick, d + thick);
        parts.walls.triangle({side * halfX, eaves, side * halfZ}, {side * halfX, eaves, -side * halfZ},
                             {side * halfX, ridge, 0});
    }
}

void hipRoof(HouseParts& parts, float halfX, float halfZ, float eaves, float rise, float overhang) {
    const float low = eaves - rise / halfZ * overhang;
    const float x = halfX + overhang;
    const float z = halfZ + overhang;
    const float ridgeHalf = std::max(x - z, 0.0f);
    const glm::vec3 thick(0, 0.18f, 0);
    const std::array<glm::vec3, 4> foot = {{{-x, low, z}, {x, low, z}, {x, low, -z}, {-x, low, -z}}};
    const glm::vec3 right(ridgeHalf, eaves + rise, 0);
    const glm::vec3 left(-ridgeHalf, eaves + rise, 0);
    parts.roof.quad(foot[0] + thick, foot[1] + thick, right + thick, left + thick);
    parts.roof.quad(foot[2] + thick, foot[3] + thick, left + thick, right + thick);
    parts.roof.triangle(foot[1] + thick, foot[2] + thick, right + thick);
    parts.roof.triangle(foot[3] + thick, foot[0] + thick, left + thick);
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::vec3 a = foot[i];
        const glm::vec3 b = foot[(i + 1) % 4];
        parts.trim.quad(a, b, b + thick, a + thick);
    }
    parts.trim.quad(foot[3], foot[2], foot[1], foot[0]);
}

enum class RoofKind { eavesToStreet, gableToStreet, hip };

struct HousePlan {
    float width;
    float depth;
    int storeys;
    RoofKind roof;
    bool shutters;
    bool shop;
    float rise;
};

/// Front towards +z, middle of the foot at the origin.
HouseKind buildHouse(Site& site, const HousePlan& plan) {
    constexpr float storey = 2.9f;
    constexpr float plinth = 0.45f;
    HouseParts parts;
    const float x = plan.width / 2;
    const float z = plan.depth / 2;
    const float eaves = plinth + storey * static_cast<float>(plan.storeys);
    parts.walls.box({-x, 0, -z}, {x, eaves, z}, {.bottom = false});
    parts.stone.box({-x - 0.06f, -0.2f, -z - 0.06f}, {x + 0.06f, plinth, z + 0.06f}, {.bottom = false});
    constexpr float overhang = 0.55f;
    if (plan.roof == RoofKind::hip) {
        hipRoof(parts, x, z, eaves, plan.rise, overhang);
    } else if (plan.roof == RoofKind::eavesToStreet) {
        gableRoof(parts, x, z, eaves, plan.rise, overhang);
    } else {
        HouseParts turned;
        gableRoof(turned, z, x, eaves, plan.rise, overhang);
        const glm::mat4 quarter = turnedLeft(pi / 2);
        parts.roof.append(turned.roof.take({}), quarter);
        parts.trim.append(turned.trim.take({}), quarter);
        parts.walls.append(turned.walls.take({}), quarter);
    }
    // The chimney stands beside the ridge.
    const bool ridgeAlongX = plan.roof != RoofKind::gableToStreet;
    const glm::vec3 stack =
        ridgeAlongX ? glm::vec3(x * 0.45f, eaves, -z * 0.3f) : glm::vec3(x * 0.35f, eaves, -z * 0.4f);
    parts.stone.box(stack - glm::vec3(0.33f, 0, 0.33f), stack + glm::vec3(0.33f, plan.rise + 0.75f, 0.33f),
                    {.bottom = false});
    parts.roof.box(stack + glm::vec3(-0.42f, plan.rise + 0.75f, -0.42f),
                   stack + glm::vec3(0.42f, plan.rise + 0.9f, 0.42f));

    const Wall front{{0, 0, z}, {1, 0, 0}, {0, 0, 1}};
    const Wall back{{0, 0, -z}, {-1, 0, 0}, {0, 0, -1}};
    const Wall left{{-x, 0, 0}, {0, 0, 1}, {-1, 0, 0}};
    const Wall right{{x, 0, 0}, {0, 0, -1}, {1, 0, 0}};
    const int columns = std::max(2, static_cast<int>(plan.width / 2.7f));
    const glm::vec2 pane(0.52f, 0.74f);
    const int doorColumn = columns / 2;
    for (int level = 0; level < plan.storeys; ++level) {
        const float height = plinth + storey * static_cast<float>(level) + 1.5f;
        for (int column = 0; column < columns; ++column) {
            const float place =
                plan.width * ((static_cast<float>(column) + 0.5f) / static_cast<float>(columns) - 0.5f);
            const bool isDoor = level == 0 && column == doorColumn;
            if (isDoor)
                doorway(parts, front, place, plinth);
            else if (level == 0 && plan.shop)
                window(parts, front, {place, height - 0.05f}, {1.05f, 0.95f}, false);
            else
                window(parts, front, {place, height}, pane, plan.shutters);
            if (column % 2 == 0)
                plainWindow(parts, back, {place, height}, pane);
        }
        for (const Wall& side : {left, right})
            for (const float place : {-0.24f, 0.24f})
                plainWindow(parts, side, {plan.depth * place, height}, pane);
    }
    if (plan.shop) {
        // An awning over the windows.
        const float top = plinth + 2.75f;
        const glm::vec3 a(-x + 0.3f, top, z);
        const glm::vec3 b(x - 0.3f, top, z);
        const glm::vec3 out(0, -0.55f, 1.25f);
        parts.door.quad(a + out, b + out, b, a);
        parts.door.quad(a, b, b + out, a + out);
        parts.trim.quad(a + out - glm::vec3(0, 0.22f, 0), b + out - glm::vec3(0, 0.22f, 0), b + out, a + out);
    }
    if (plan.roof == RoofKind::gableToStreet)
        window(parts, front, {0, eaves + plan.rise * 0.34f}, {0.45f, 0.55f}, false);
    return {site.add(parts.walls.take("walls")),
            site.add(parts.roof.take("roof")),
            site.add(parts.trim.take("trim")),
            site.add(parts.glass.take("windows")),
            site.add(parts.door.take("door")),
            site.add(parts.stone.take("plinth")),
            plan.width,
            plan.depth};
}

struct Finishes {
    std::vector<std::size_t> walls;
    std::vector<std::size_t> roofs;
    std::vector<std::size_t> doors;
    std::size_t trim = 0;
    std::size_t glass = 0;
    std::size_t stone = 0;
    std::size_t gold = 0;
    std::size_t water = 0;
    std::size_t bark = 0;
    std::size_t iron = 0;
    std::size_t lamp = 0;
    std::size_t hedge = 0;
    std::size_t path = 0;
    std::size_t wood = 0;
    std::vector<std::size_t> leaves;
};

Finishes makeFinishes(Site& site) {
    Finishes all;
    for (const glm::vec3 color : wallColors)
        all.walls.push_back(site.add(material("plaster", {.diffuse = color})));
    for (const glm::vec3 color : roofColors)
        all.roofs.push_back(
            site.add(material("roof tiles", {.diffuse = color, .specular = glm::vec3(0.03f)})));
    for (const glm::vec3 color : doorColors)
        all.doors.push_back(site.add(
            material("painted wood", {.diffuse = color, .specular = glm::vec3(0.06f), .shininess = 30})));
    all.trim = site.add(material("white trim", {.diffuse = {0.72f, 0.70f, 0.65f}}));
    all.glass = site.add(material("window glass", {.diffuse = {0.06f, 0.10f, 0.14f},
                                                   .specular = {0.6f, 0.6f, 0.55f},
                                                   .shininess = 120,
                                                   .roughness = 0.08f}));
    all.stone = site.add(material("stone", {.diffuse = {0.38f, 0.35f, 0.31f}}));
    all.gold = site.add(material("gilding", {.diffuse = {0.55f, 0.36f, 0.07f},
                                             .specular = {0.9f, 0.7f, 0.3f},
                                             .shininess = 40,
                                             .roughness = 0.3f}));
    all.water = site.add(material(
        "water",
        {.diffuse = {0.09f, 0.27f, 0.36f}, .specular = glm::vec3(0.5f), .shininess = 60, .roughness = 0.1f}));
    all.bark = site.add(material("bark", {.diffuse = {0.16f, 0.095f, 0.05f}}));
    all.iron = site.add(material(
        "cast iron", {.diffuse = {0.035f, 0.05f, 0.05f}, .specular = glm::vec3(0.1f), .shininess = 30}));
    all.lamp = site.add(material("lamp glass", {.diffuse = {0.7f, 0.66f, 0.5f},
                                                .specular = glm::vec3(0.4f),
                                                .shininess = 60,
                                                .emission = {0.12f, 0.1f, 0.05f}}));
    all.hedge = site.add(material("hedge", {.diffuse = {0.07f, 0.19f, 0.05f}}));
    all.path = site.add(material("gravel", {.diffuse = {0.52f, 0.43f, 0.29f}}));
    all.wood = site.add(material("bench wood", {.diffuse = {0.34f, 0.17f, 0.07f}}));
    for (const glm::vec3 color :
         {glm::vec3(0.10f, 0.26f, 0.05f), glm::vec3(0.17f, 0.33f, 0.06f), glm::vec3(0.25f, 0.36f, 0.07f),
          glm::vec3(0.06f, 0.20f, 0.08f), glm::vec3(0.55f, 0.30f, 0.36f)})
        all.leaves.push_back(site.add(material("leaves", {.diffuse = color})));
    return all;
}

void placeHouse(Site& site, const HouseKind& kind, const Finishes& finishes, const glm::mat4& where) {
    site.place(kind.walls, finishes.walls[site.pick(finishes.walls.size())], where);
    // Slate is rarer than tiles.
    site.place(kind.roof, finishes.roofs[std::min(site.pick(7) / 2, finishes.roofs.size() - 1)], where);
    site.place(kind.trim, finishes.trim, where);
    site.place(kind.glass, finishes.glass, where);
    site.place(kind.door, finishes.doors[site.pick(finishes.doors.size())], where);
    site.place(kind.stone, finishes.stone, where);
}

/// A row of houses along a line of the plan, their fronts on it.
struct Row {
    glm::vec2 from;
    glm::vec2 to;
    glm::vec2 front;  ///< unit: the way the houses face
    bool tall = false;
};

void buildRows(Site& site, const Finishes& finishes) {
    const std::array<HousePlan, 6> townhouses = {{
        {9.2f, 9.0f, 2, RoofKind::eavesToStreet, true, false, 3.4f},
        {8.2f, 9.6f, 3, RoofKind::gableToStreet, false, true, 3.6f},
        {10.4f, 9.0f, 2, RoofKind::hip, true, false, 3.2f},
        {8.6f, 9.2f, 3, RoofKind::eavesToStreet, false, true, 3.0f},
        {7.6f, 9.4f, 2, RoofKind::gableToStreet, true, false, 4.2f},
        {9.8f, 9.6f, 3, RoofKind::hip, true, true, 3.0f},
    }};
    const std::array<HousePlan, 4> cottages = {{
        {9.6f, 8.4f, 1, RoofKind::eavesToStreet, true, false, 3.6f},
        {8.2f, 9.2f, 1, RoofKind::gableToStreet, true, false, 4.0f},
        {10.6f, 8.6f, 2, RoofKind::eavesToStreet, true, false, 3.2f},
        {9.0f, 9.0f, 2, RoofKind::hip, false, false, 2.9f},
    }};
    std::vector<HouseKind> tall;
    std::vector<HouseKind> low;
    tall.reserve(townhouses.size());
    low.reserve(cottages.size());
    for (const HousePlan& plan : townhouses)
        tall.push_back(buildHouse(site, plan));
    for (const HousePlan& plan : cottages)
        low.push_back(buildHouse(site, plan));

    const float inner = streetHalfWidth + pavementWidth + frontGarden;
    const float ringInner = ringStreet - inner;
    const float ringOuter = ringStreet + inner;
    std::vector<Row> rows;
    for (std::size_t i = 0; i < quarters.size(); ++i) {
        const glm::vec2 q = quarters[i];
        const bool built = i == 1 || i == 3;
        if (built) {
            rows.push_back({q * glm::vec2(inner, 27), q * glm::vec2(inner, 61), {-q.x, 0}, true});
            rows.push_back({q * glm::vec2(27, inner), q * glm::vec2(49, inner), {0, -q.y}, true});
        }
        if (i != 2) {
            rows.push_back({q * glm::vec2(ringInner, 10), q * glm::vec2(ringInner, 62), {q.x, 0}, built});
            rows.push_back(
                {q * glm::vec2(i == 0 ? 12 : 23, ringInner), q * glm::vec2(49, ringInner), {0, q.y}, built});
        }
        rows.push_back({q * glm::vec2(ringOuter, 9), q * glm::vec2(ringOuter, 80), {-q.x, 0}, false});
        rows.push_back({q * glm::vec2(9, ringOuter), q * glm::vec2(68, ringOuter), {0, -q.y}, false});
    }
    MeshBuilder hedges;
    for (const Row& row : rows) {
        const std::vector<HouseKind>& kinds = row.tall ? tall : low;
        const float length = glm::length(row.to - row.from);
        const glm::vec2 direction = (row.to - row.from) / length;
        float used = 0;
        std::size_t last = kinds.size();
        for (;;) {
            std::size_t choice = site.pick(kinds.size());
            if (choice == last)
                choice = (choice + 1) % kinds.size();
            const HouseKind& kind = kinds[choice];
            if (used + kind.width > length)
                break;
            last = choice;
            const float setBack = site.uniform(0, 0.9f) + kind.depth / 2;
            const glm::vec2 middle = row.from + direction * (used + kind.width / 2) - row.front * setBack;
            placeHouse(site, kind, finishes,
                       at(middle.x, pavementHeight + 0.02f, middle.y) *
                           turnedLeft(std::atan2(row.front.x, row.front.y)));
            const float gap = row.tall ? site.uniform(0.6f, 2.2f) : site.uniform(3.2f, 5.5f);
            if (!row.tall) {
                // A hedge between neighbours.
                const glm::vec2 start = row.from + direction * (used + kind.width + gap / 2);
                const glm::vec2 end = start - row.front * 9.0f;
                const glm::vec2 low2 = glm::min(start, end) - glm::vec2(0.35f);
                const glm::vec2 high2 = glm::max(start, end) + glm::vec2(0.35f);
                hedges.box({low2.x, 0, low2.y}, {high2.x, 1.15f, high2.y}, {.bottom = false});
            }
            used += kind.width + gap;
        }
    }
    site.place(site.add(hedges.take("hedges")), finishes.hedge);
}

// ---- church, fountain, park ----

void buildChurch(Site& site, const Finishes& finishes) {
    HouseParts parts;
    constexpr float plinth = 0.6f;
    // The nave: its tower faces −z of its own frame's front, +z.
    constexpr float x = 5.2f;
    constexpr float z = 10;
    constexpr float eaves = 7.5f;
    constexpr float rise = 5.4f;
    parts.walls.box({-x, 0, -z}, {x, eaves, z}, {.bottom = false});
    HouseParts roof;
    gableRoof(roof, z, x, eaves, rise, 0.5f);
    const glm::mat4 quarter = turnedLeft(pi / 2);
    parts.roof.append(roof.roof.take({}), quarter);
    parts.trim.append(roof.trim.take({}), quarter);
    parts.walls.append(roof.walls.take({}), quarter);
    parts.stone.box({-x - 0.1f, -0.2f, -z - 0.1f}, {x + 0.1f, plinth, z + 0.1f}, {.bottom = false});
    // The apse behind.
    parts.walls.column({0, 0, -z}, 6, 3.6f, 3.6f, 20);
    parts.roof.column({0, 6, -z}, 3, 4.0f, 0, 20, true);
    // The tower before.
    constexpr float t = 2.7f;
    constexpr float towerZ = z + 1.6f;
    constexpr float towerTop = 17;
    parts.walls.box({-t, 0, towerZ - t}, {t, towerTop, towerZ + t}, {.bottom = false});
    parts.stone.box({-t - 0.12f, -0.2f, towerZ - t - 0.12f}, {t + 0.12f, plinth, towerZ + t + 0.12f},
                    {.bottom = false});
    for (const float height : {6.6f, 12.0f, towerTop - 0.15f})
        parts.trim.box({-t - 0.16f, height, towerZ - t - 0.16f},
                       {t + 0.16f, height + 0.3f, towerZ + t + 0.16f});
    const auto arched = [&](const Wall& wall, glm::vec2 foot, float half, float height) {
        const auto leaf = [&](MeshBuilder& builder, float grow, float depth) {
            std::vector<glm::vec3> outline = {wall.at(foot.x - half - grow, foot.y - grow, depth),
                                              wall.at(foot.x + half + grow, foot.y - grow, depth)};
            constexpr int steps = 8;
            for (int i = 0; i <= steps; ++i) {
                const float angle = pi * static_cast<float>(i) / steps;
                outline.push_back(wall.at(foot.x + (half + grow) * std::cos(angle),
                                          foot.y + height + (half + grow) * std::sin(angle), depth));
            }
            builder.polygon(outline);
        };
        leaf(parts.trim, 0.14f, 0.05f);
        leaf(parts.glass, 0, 0.09f);
    };
    for (const float side : {-1.0f, 1.0f}) {
        const Wall flank{{side * x, 0, 0}, {0, 0, -side}, {side, 0, 0}};
        for (int i = 0; i < 4; ++i)
            arched(flank, {-6.6f + 4.4f * static_cast<float>(i), 2.2f}, 0.6f, 2.8f);
        for (int i = 0; i < 5; ++i) {
            const float buttress = -8.8f + 4.4f * static_cast<float>(i);
            parts.stone.box({side > 0 ? x : -x - 0.6f, 0, buttress - 0.35f},
                            {side > 0 ? x + 0.6f : -x, 5.2f, buttress + 0.35f}, {.bottom = false});
        }
    }
    const std::array<Wall, 4> faces = {{{{0, 0, towerZ + t}, {1, 0, 0}, {0, 0, 1}},
                                        {{0, 0, towerZ - t}, {-1, 0, 0}, {0, 0, -1}},
                                        {{t, 0, towerZ}, {0, 0, -1}, {1, 0, 0}},
                                        {{-t, 0, towerZ}, {0, 0, 1}, {-1, 0, 0}}}};
    MeshBuilder gold;
    for (const Wall& face : faces) {
        for (const float side : {-0.9f, 0.9f})
            arched(face, {side, 12.9f}, 0.42f, 1.6f);
        // The clock: a white face in a golden ring, and its hands at ten past ten.
        const glm::vec3 middle = face.at(0, 9.6f, 0.05f);
        const glm::mat4 upright = at(middle) * glm::mat4(glm::vec4(face.right, 0), glm::vec4(face.out, 0),
                                                         glm::vec4(0, -1, 0, 0), glm::vec4(0, 0, 0, 1));
        gold.append(tessellate(Torus{1.15, 0.08}, 24), upright);
        MeshBuilder dial;
        dial.disc({0, 0.02f, 0}, 1.15f, 24);
        parts.trim.append(dial.take({}), upright);
        const auto hand = [&](float hours, float length, float half) {
            const float angle = pi / 2 - 2 * pi * hours / 12;
            const glm::vec2 way(std::cos(angle), std::sin(angle));
            const glm::vec2 across(-way.y, way.x);
            const auto p = [&](float l, float w) {
                const glm::vec2 q = way * l + across * w;
                return face.at(q.x, 9.6f + q.y, 0.1f);
            };
            parts.door.quad(p(-0.1f, half), p(-0.1f, -half), p(length, -half), p(length, half));
        };
        hand(10.17f, 0.6f, 0.06f);
        hand(2, 0.92f, 0.045f);
    }
    arched(faces[0], {0, 0.5f}, 1.1f, 2.2f);
    parts.stone.box({-1.9f, -0.2f, towerZ + t}, {1.9f, 0.25f, towerZ + t + 1.2f}, {.bottom = false});
    // The spire: four sides, broad at the eaves, with a ball and a cross.
    {
        constexpr float half = 2.25f;
        const glm::vec3 top(0, towerTop + 12, towerZ);
        const float foot = towerTop + 0.3f;
        const std::array<glm::vec3, 4> corners = {{{-t - 0.3f, foot, towerZ + t + 0.3f},
                                                   {t + 0.3f, foot, towerZ + t + 0.3f},
                                                   {t + 0.3f, foot, towerZ - t - 0.3f},
                                                   {-t - 0.3f, foot, towerZ - t - 0.3f}}};
        std::array<glm::vec3, 4> waist = corners;
        for (glm::vec3& p : waist)
            p = {p.x / (t + 0.3f) * half * 0.82f, foot + 2.0f,
                 towerZ + (p.z - towerZ) / (t + 0.3f) * half * 0.82f};
        for (std::size_t i = 0; i < 4; ++i) {
            parts.roof.quad(corners[i], corners[(i + 1) % 4], waist[(i + 1) % 4], waist[i]);
            parts.roof.triangle(waist[i], waist[(i + 1) % 4], top);
        }
    }
    gold.append(tessellate(Sphere{0.32}, 14), at(0, towerTop + 12.1f, towerZ));
    gold.box({-0.07f, towerTop + 12.3f, towerZ - 0.07f}, {0.07f, towerTop + 14.2f, towerZ + 0.07f});
    gold.box({-0.5f, towerTop + 13.4f, towerZ - 0.07f}, {0.5f, towerTop + 13.54f, towerZ + 0.07f});

    // Beyond the corner of the north-east block, its door towards the roundabout.
    const glm::mat4 where = at(33, pavementHeight, 33) * turnedLeft(-135 * degree) * at(0, 0, -4);
    site.place(site.add(parts.walls.take("church walls")), finishes.walls[7], where);
    site.place(site.add(parts.roof.take("church roof")), finishes.roofs[3], where);
    site.place(site.add(parts.trim.take("church trim")), finishes.trim, where);
    site.place(site.add(parts.glass.take("church windows")), finishes.glass, where);
    site.place(site.add(parts.door.take("church hands")), finishes.iron, where);
    site.place(site.add(parts.stone.take("church stone")), finishes.stone, where);
    site.place(site.add(gold.take("church gold")), finishes.gold, where);
    // The way to its door.
    MeshBuilder way;
    slab(way, {{15.6f, 12.4f}, {12.4f, 15.6f}, {25.5f, 28.7f}, {28.7f, 25.5f}}, pavementHeight + 0.05f, 0);
    site.placeGround(way.take("church way"), finishes.path);
}

void buildFountain(Site& site, const Finishes& finishes) {
    MeshBuilder stone;
    MeshBuilder grass;
    std::vector<glm::vec2> rim;
    arc(rim, {0, 0}, islandRadius, 0, 352.5f, 47);
    slab(stone, rim, 0.16f, 0);
    rim.clear();
    arc(rim, {0, 0}, islandRadius - 0.4f, 0, 352.5f, 47);
    slab(grass, rim, 0.2f, 0.16f);
    site.placeGround(stone.take("island kerb"), finishes.stone);
    site.placeGround(grass.take("island"),
                     site.add(material("island lawn", {.diffuse = {0.2f, 0.38f, 0.09f}})));

    const auto basin = [](double radius, double height, double wall) {
        // From the axis out, up a rounded wall, and down to the floor inside.
        Lathe lathe(0);
        lathe.line(radius).arc(wall, 90).line(height - 2 * wall).arc(wall, 180);
        lathe.line(height * 0.4).arc(wall, -90).line(radius - 2 * wall);
        return tessellate(lathe.finish(), 20, "basin");
    };
    MeshBuilder bowls;
    bowls.append(basin(3.9, 0.8, 0.14), at(0, 0.2f, 0));
    bowls.append(tessellate(Drum{0.42, 0.85, 0.1}, 12), at(0, 1.0f, 0));
    bowls.append(basin(1.5, 0.45, 0.09), at(0, 1.75f, 0));
    bowls.append(tessellate(Drum{0.2, 0.55, 0.06}, 10), at(0, 2.5f, 0));
    bowls.append(basin(0.62, 0.3, 0.06), at(0, 2.95f, 0));
    site.place(site.add(bowls.take("fountain")), finishes.stone);
    MeshBuilder water;
    water.disc({0, 0.82f, 0}, 3.95f, 36);
    water.disc({0, 2.09f, 0}, 1.52f, 28);
    water.disc({0, 3.2f, 0}, 0.6f, 20);
    site.place(site.add(water.take("fountain water")), finishes.water);
    MeshBuilder jets;
    const auto jet = [&](glm::vec3 from, glm::vec3 to, float height, float radius) {
        std::vector<glm::vec3> points;
        for (int i = 0; i <= 6; ++i) {
            const float s = static_cast<float>(i) / 6;
            points.push_back(glm::mix(from, to, s) + glm::vec3(0, 4 * height * s * (1 - s), 0));
        }
        jets.tube(points, radius, 4);
    };
    for (int i = 0; i < 10; ++i) {
        const float angle = 2 * pi * static_cast<float>(i) / 10;
        const glm::vec3 out(std::sin(angle), 0, std::cos(angle));
        jet(glm::vec3(0, 3.2f, 0) + 0.1f * out, glm::vec3(0, 2.1f, 0) + 1.1f * out, 0.75f, 0.03f);
        jet(glm::vec3(0, 2.1f, 0) + 1.4f * out, glm::vec3(0, 0.82f, 0) + 2.9f * out, 0.7f, 0.035f);
    }
    site.place(
        site.add(jets.take("fountain jets")),
        site.add(material("falling water",
                          {.diffuse = {0.62f, 0.72f, 0.78f}, .specular = glm::vec3(0.5f), .shininess = 40})));
    // Flower beds around it.
    for (int colour = 0; colour < 3; ++colour) {
        static constexpr std::array<glm::vec3, 3> petals = {
            {{0.72f, 0.12f, 0.16f}, {0.78f, 0.55f, 0.08f}, {0.55f, 0.22f, 0.55f}}};
        MeshBuilder flowers;
        const Mesh blossom = tessellate(Sphere{0.3}, 7);
        for (int i = colour; i < 36; i += 3) {
            const float angle = 2 * pi * static_cast<float>(i) / 36;
            flowers.append(blossom, at(6.1f * std::sin(angle), 0.28f, 6.1f * std::cos(angle)) *
                                        scaled(1, site.uniform(0.7f, 1.1f), 1));
        }
        site.place(site.add(flowers.take("flowers")),
                   site.add(material("flowers", {.diffuse = petals[static_cast<std::size_t>(colour)]})));
    }
}

// ---- trees, lamps, clouds ----

struct TreeKind {
    std::size_t trunk = 0;
    std::size_t crown = 0;
};

std::vector<TreeKind> buildTrees(Site& site) {
    std::vector<TreeKind> kinds;
    const Mesh ball = tessellate(Sphere{1}, 9);
    const auto broad = [&](std::span<const glm::vec4> balls, float trunkHeight) {
        MeshBuilder trunk;
        trunk.column({0, -0.3f, 0}, trunkHeight, 0.24f, 0.15f, 5);
        MeshBuilder crown;
        for (const glm::vec4 b : balls)
            crown.append(ball, at(b.x, b.y, b.z) * scaled(b.w, b.w * 0.88f, b.w));
        kinds.push_back({site.add(trunk.take("trunk")), site.add(crown.take("crown"))});
    };
    broad(
        std::array<glm::vec4, 3>{
            {{0, 3.9f, 0, 1.75f}, {0.95f, 3.2f, 0.4f, 1.25f}, {-0.8f, 3.3f, -0.5f, 1.3f}}},
        2.7f);
    broad(std::array<glm::vec4, 4>{{{0, 5.2f, 0, 1.7f},
                                    {0.9f, 4.2f, 0.7f, 1.45f},
                                    {-1.0f, 4.3f, 0.2f, 1.4f},
                                    {0.2f, 4.0f, -1.0f, 1.4f}}},
          3.4f);
    // Round, on a short stem.
    broad(std::array<glm::vec4, 1>{{{0, 2.7f, 0, 1.35f}}}, 1.9f);
    MeshBuilder trunk;
    trunk.column({0, -0.3f, 0}, 1.6f, 0.2f, 0.16f, 5);
    MeshBuilder fir;
    fir.column({0, 0.9f, 0}, 2.5f, 1.75f, 0, 9, true);
    fir.column({0, 2.3f, 0}, 2.2f, 1.4f, 0, 9, true);
    fir.column({0, 3.7f, 0}, 2.1f, 1.0f, 0, 9, true);
    kinds.push_back({site.add(trunk.take("trunk")), site.add(fir.take("crown"))});
    trunk.column({0, -0.3f, 0}, 1.6f, 0.2f, 0.16f, 5);
    MeshBuilder poplar;
    poplar.append(ball, at(0, 4.3f, 0) * scaled(0.95f, 3.4f, 0.95f));
    kinds.push_back({site.add(trunk.take("trunk")), site.add(poplar.take("crown"))});
    return kinds;
}

constexpr std::size_t tallTree = 1;
constexpr std::size_t roundTree = 2;
constexpr std::size_t fir = 3;
constexpr std::size_t poplar = 4;

void plant(Site& site, const std::vector<TreeKind>& kinds, const Finishes& finishes, std::size_t kind,
           glm::vec2 place, float size) {
    const float ground = std::max(landHeight(place.x, place.y), 0.0f);
    const glm::mat4 where = at(place.x, ground, place.y) * turnedLeft(site.uniform(0, 2 * pi)) *
                            scaled(size, size * site.uniform(0.88f, 1.15f), size);
    const std::size_t leaves = kind == fir ? 3 : kind == poplar ? 0 : site.pick(12) == 0 ? 4 : site.pick(3);
    site.place(kinds[kind].trunk, finishes.bark, where);
    site.place(kinds[kind].crown, finishes.leaves[leaves], where);
}

void plantTrees(Site& site, const Finishes& finishes) {
    const std::vector<TreeKind> kinds = buildTrees(site);
    const float kerb = streetHalfWidth + 1.3f;
    // An avenue along the two streets that cross.
    for (const float side : {-1.0f, 1.0f})
        for (const float half : {-1.0f, 1.0f})
            for (int i = 0; i < 4; ++i) {
                const float along = half * (30.5f + 9.6f * static_cast<float>(i));
                plant(site, kinds, finishes, roundTree, {side * kerb, along}, site.uniform(0.85f, 1));
                plant(site, kinds, finishes, roundTree, {along, side * kerb}, site.uniform(0.85f, 1));
            }
    // The park, and the church's yard.
    const glm::vec2 pond(-41, -39);
    for (int i = 0; i < 46; ++i) {
        const glm::vec2 place(-site.uniform(12, 61), -site.uniform(12, 61));
        const bool inPond = glm::length(place - pond) < 14;
        const bool onWay = std::abs(place.x - place.y) < 3.2f;
        const bool nearRoundabout = glm::length(place) < 24;
        if (!inPond && !onWay && !nearRoundabout)
            plant(site, kinds, finishes, site.pick(5), place, site.uniform(0.9f, 1.35f));
    }
    for (const glm::vec2 place :
         {glm::vec2(13, 34), {17, 44}, {34, 13}, {44, 17}, {47, 30}, {30, 47}, {14, 25}, {25, 14}})
        plant(site, kinds, finishes, place.x + place.y > 60 ? tallTree : poplar, place,
              site.uniform(0.95f, 1.2f));
    // Gardens behind the houses.
    for (const glm::vec2 quarter : {quarters[1], quarters[3]})
        for (int i = 0; i < 9; ++i)
            plant(site, kinds, finishes, site.pick(3),
                  quarter * glm::vec2(site.uniform(23, 47), site.uniform(23, 47)), site.uniform(0.7f, 1.1f));
    // Outside: behind the outer houses, along the roads, and woods on the hills.
    for (int i = 0; i < 34; ++i) {
        const float angle = site.uniform(0, 2 * pi);
        const float radius = site.uniform(112, 128);
        const glm::vec2 place(radius * std::sin(angle), radius * std::cos(angle));
        if (std::min(std::abs(place.x), std::abs(place.y)) > 9)
            plant(site, kinds, finishes, site.pick(5), place, site.uniform(0.9f, 1.5f));
    }
    for (const float side : {-1.0f, 1.0f})
        for (const float half : {-1.0f, 1.0f})
            for (int i = 0; i < 6; ++i) {
                const float along = half * (104 + 15 * static_cast<float>(i));
                plant(site, kinds, finishes, poplar, {side * 7.0f, along}, 1.15f);
                plant(site, kinds, finishes, poplar, {along, side * 7.0f}, 1.15f);
            }
    for (int i = 0; i < 90; ++i) {
        const float angle = site.uniform(0, 2 * pi);
        const float radius = site.uniform(150, 285);
        const glm::vec2 place(radius * std::sin(angle), radius * std::cos(angle));
        if (std::min(std::abs(place.x), std::abs(place.y)) > 22)
            plant(site, kinds, finishes, site.pick(4) == 0 ? tallTree : fir, place, site.uniform(1.1f, 1.9f));
    }
}

void layPark(Site& site, const Finishes& finishes) {
    MeshBuilder ways;
    const float height = pavementHeight + 0.05f;
    slab(ways, {{-15.2f, -12.8f}, {-12.8f, -15.2f}, {-59, -61.4f}, {-61.4f, -59}}, height, height - 0.04f);
    std::vector<glm::vec2> round;
    arc(round, {-41, -39}, 13, 0, 350, 35);
    slab(ways, round, height + 0.005f, height - 0.04f);
    site.placeGround(ways.take("park ways"), finishes.path);
    MeshBuilder pond;
    round.clear();
    for (int i = 0; i < 40; ++i) {
        const float angle = 2 * pi * static_cast<float>(i) / 40;
        const float radius = 9.6f + 0.9f * std::sin(3 * angle + 0.6f) + 0.5f * std::sin(5 * angle);
        round.push_back(glm::vec2(-41, -39) + radius * glm::vec2(std::cos(angle), std::sin(angle)));
    }
    slab(pond, round, height + 0.03f, height);
    site.placeGround(pond.take("pond"), finishes.water);

    MeshBuilder bench;
    for (const float z : {-0.16f, 0.0f, 0.16f})
        bench.box({-0.9f, 0.44f, z - 0.06f}, {0.9f, 0.5f, z + 0.06f});
    bench.box({-0.9f, 0.62f, -0.30f}, {0.9f, 0.74f, -0.25f});
    bench.box({-0.9f, 0.80f, -0.33f}, {0.9f, 0.92f, -0.28f});
    MeshBuilder feet;
    for (const float x : {-0.7f, 0.7f}) {
        feet.box({x - 0.04f, 0, -0.2f}, {x + 0.04f, 0.45f, 0.2f});
        feet.box({x - 0.04f, 0.4f, -0.28f}, {x + 0.04f, 0.95f, -0.22f});
    }
    const std::size_t seat = site.add(bench.take("bench"));
    const std::size_t foot = site.add(feet.take("bench feet"));
    const auto sit = [&](glm::vec2 place, float heading) {
        const glm::mat4 where = at(place.x, pavementHeight, place.y) * turnedLeft(heading);
        site.place(seat, finishes.wood, where);
        site.place(foot, finishes.iron, where);
    };
    for (int i = 0; i < 6; ++i) {
        const float angle = 2 * pi * (static_cast<float>(i) + 0.3f) / 6;
        // Facing the water.
        const glm::vec2 out(std::sin(angle), std::cos(angle));
        sit(glm::vec2(-41, -39) + 12.3f * out, std::atan2(-out.x, -out.y));
    }
    for (const glm::vec2 quarter : quarters)
        sit(quarter * 14.35f, std::atan2(-quarter.x, -quarter.y));
}

void setLamps(Site& site, const Finishes& finishes) {
    MeshBuilder post;
    post.column({0, 0, 0}, 0.5f, 0.16f, 0.12f, 6);
    post.column({0, 0.5f, 0}, 3.3f, 0.07f, 0.05f, 6);
    post.column({0, 4.32f, 0}, 0.28f, 0.3f, 0.03f, 6, true);
    post.column({0, 3.74f, 0}, 0.08f, 0.05f, 0.17f, 6);
    MeshBuilder lantern;
    lantern.column({0, 3.82f, 0}, 0.5f, 0.16f, 0.25f, 6);
    const std::size_t stand = site.add(post.take("lamp post"));
    const std::size_t glass = site.add(lantern.take("lantern"));
    const auto set = [&](float x, float z) {
        site.place(stand, finishes.iron, at(x, pavementHeight, z));
        site.place(glass, finishes.lamp, at(x, pavementHeight, z));
    };
    const float kerb = streetHalfWidth + 0.6f;
    for (const float side : {-1.0f, 1.0f})
        for (const float half : {-1.0f, 1.0f}) {
            for (const float along : {26.0f, 45.2f, 64.2f}) {
                set(side * kerb, half * along);
                set(half * along, side * kerb);
            }
            for (const float along : {20.0f, 40.0f, 58.0f}) {
                set(side * (ringStreet + kerb), half * along);
                set(half * along, side * (ringStreet + kerb));
            }
        }
}

void hangClouds(Site& site) {
    const std::size_t white =
        site.add(material("cloud", {.diffuse = {0.72f, 0.74f, 0.78f}, .emission = {0.30f, 0.31f, 0.33f}}));
    const Mesh ball = tessellate(Sphere{1}, 8);
    for (int kind = 0; kind < 3; ++kind) {
        MeshBuilder builder;
        const int puffs = 5 + kind;
        for (int i = 0; i < puffs; ++i) {
            const float t = static_cast<float>(i) / static_cast<float>(puffs - 1) - 0.5f;
            const float size = (1.2f - 1.6f * t * t) * site.uniform(0.75f, 1.1f);
            builder.append(ball, at(22 * t, site.uniform(-0.3f, 0.9f), site.uniform(-2, 2)) *
                                     scaled(5.2f * size, 3.0f * size, 4.2f * size));
        }
        const std::size_t mesh = site.add(builder.take("cloud"));
        for (int i = 0; i < 5; ++i) {
            const float angle = 2 * pi * (static_cast<float>(3 * i + kind) + site.uniform(-0.3f, 0.3f)) / 15;
            const float radius = site.uniform(330, 520);
            site.place(mesh, white,
                       at(radius * std::sin(angle), site.uniform(95, 165), radius * std::cos(angle)) *
                           turnedLeft(angle + site.uniform(-0.4f, 0.4f)) *
                           glm::scale(glm::mat4(1), glm::vec3(site.uniform(1.6f, 2.8f))));
        }
    }
}

// ---- traffic ----

std::vector<glm::dvec2> tourOf() {
    std::vector<glm::dvec2> tour;
    const auto go = [&](double x, double z) { tour.emplace_back(x, z); };
    // Around the island, counter-clockwise: angles from +z over +x.
    const auto round = [&](double fromDegrees, double toDegrees) {
        const double radius = 0.5 * (roundaboutRadius + islandRadius);
        for (double angle = fromDegrees; angle <= toDegrees; angle += 15)
            go(radius * std::sin(glm::radians(angle)), radius * std::cos(glm::radians(angle)));
    };
    const double in = ringStreet - lane;
    go(-lane, -62);
    go(-lane, -24);
    round(210, 420);
    go(24, lane);
    go(in - 5, lane);
    go(in, lane + 5);
    go(in, in - 5);
    go(in - 5, in);
    go(lane + 5, in);
    go(lane, in - 5);
    go(lane, 24);
    round(30, 150);
    go(lane, -24);
    go(lane, -in + 5);
    go(lane + 5, -in);
    go(in - 5, -in);
    go(in, -in + 5);
    go(in, -lane - 5);
    go(in - 5, -lane);
    go(24, -lane);
    round(120, 240);
    go(-24, -lane);
    go(-in + 5, -lane);
    go(-in, -lane - 5);
    go(-in, -in + 5);
    go(-in + 5, -in);
    go(-lane - 5, -in);
    go(-lane, -in + 5);
    return tour;
}

void parkCars(Site& site) {
    const CarInstances model = addCar(site.town.scene, {0.06f, 0.22f, 0.36f});
    const auto park = [&](const CarInstances& car, double x, double z, double headingDegrees) {
        CarState state;
        state.position = {x, 0, z};
        state.heading = AngleSum(glm::radians(headingDegrees));
        placeCar(site.town.scene, car, poseOf(state).matrix(), 0.1, 0.4 * x);
    };
    // Beside the kerb, on the right.
    park(model, -3.05, 40, 0);
    park(addCarLike(site.town.scene, model, {0.55f, 0.42f, 0.08f}), 3.05, -36, 180);
}

}  // namespace

Town makeTown(const TownParams& params) {
    Site site(params.seed);
    layStreets(site);
    const Finishes finishes = makeFinishes(site);
    buildRows(site, finishes);
    buildChurch(site, finishes);
    buildFountain(site, finishes);
    layPark(site, finishes);
    plantTrees(site, finishes);
    setLamps(site, finishes);
    hangClouds(site);
    if (params.parkedCars)
        parkCars(site);

    Scene& scene = site.town.scene;
    scene.name = "town";
    Light sun;
    sun.kind = Light::Kind::directional;
    sun.name = "morning sun";
    sun.direction = *normalize(glm::vec3(0.62f, -0.66f, 0.43f));
    sun.color = {1.0f, 0.90f, 0.72f};
    sun.intensity = 1.15f;
    scene.lights = {sun};
    scene.ambientLight = {0.30f, 0.36f, 0.46f};
    scene.backgroundTop = {0.13f, 0.34f, 0.72f};
    scene.backgroundBottom = {0.80f, 0.86f, 0.88f};

    site.town.tour = tourOf();
    site.town.start.position = {-lane, 0, -58};
    return std::move(site.town);
}

}  // namespace quincunx
