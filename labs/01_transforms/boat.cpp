#include "labs/01_transforms/boat.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "base/check.h"
#include "geometry/normals.h"
#include "geometry/shapes.h"

namespace quincunx {
namespace {

constexpr double pi = std::numbers::pi;

struct Paint {
    glm::vec3 color;
    float specular = 0.06f;
    float shininess = 24;
    bool doubleSided = false;
    glm::vec3 emission{0};
};

/// Collects parts.
class Shipyard {
  public:
    void add(Mesh mesh, const Paint& paint, const glm::mat4& placement = glm::mat4(1)) {
        Material material;
        material.name = mesh.name;
        material.baseColor = glm::vec4(paint.color, 1);
        material.ambient = paint.color;
        material.diffuse = paint.color;
        material.specular = glm::vec3(paint.specular);
        material.shininess = paint.shininess;
        material.doubleSided = paint.doubleSided;
        material.emission = paint.emission;
        scene.instances.push_back({.name = mesh.name,
                                   .mesh = scene.meshes.size(),
                                   .material = scene.materials.size(),
                                   .worldFromModel = placement});
        scene.materials.push_back(std::move(material));
        scene.meshes.push_back(std::move(mesh));
    }

    Scene scene;
};

glm::mat4 at(float x, float y, float z) {
    return glm::translate(glm::mat4(1), {x, y, z});
}

glm::mat4 turned(float degrees, const glm::vec3& axis) {
    return glm::rotate(glm::mat4(1), glm::radians(degrees), axis);
}

constexpr double sternX = -1.25;
constexpr double lengthX = 2.65;
constexpr double widest = 0.36;  // where along the hull, 0 stern … 1 bow

/// 0 at the widest section, 1 at the bow, negative towards the stern.
double forward(double u) {
    return u > widest ? (u - widest) / (1 - widest) : (u - widest) / widest;
}

double halfBeam(double u) {
    const double t = forward(u);
    return t > 0 ? 0.46 * (1 - std::pow(t, 2.1)) : 0.46 * (1 - 0.3 * t * t);
}

double sheer(double u) {
    return 0.30 + 0.20 * u * u + 0.04 * (1 - u) * (1 - u);
}

double keel(double u) {
    const double t = forward(u);
    return t > 0 ? -0.30 + 0.62 * t * t * t : -0.30 + 0.12 * t * t;
}

/// A section of the hull: s from −1 (port gunwale) over 0 (keel) to 1 (starboard gunwale).
glm::vec3 hullPoint(double u, double s) {
    const double angle = s * pi / 2;
    const double depth = sheer(u) - keel(u);
    return {static_cast<float>(sternX + lengthX * u + 0.06 * u * (1 - std::cos(angle))),
            static_cast<float>(sheer(u) - depth * std::pow(std::cos(angle), 0.9)),
            static_cast<float>(halfBeam(u) * std::sin(angle))};
}

/// A grid of (columns + 1) × (rows + 1) points, counter-clockwise where u × v points at the viewer.
template <typename Point>
Mesh grid(std::string name, int columns, int rows, const Point& point) {
    Mesh mesh;
    mesh.name = std::move(name);
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i)
            mesh.positions.push_back(point(static_cast<double>(i) / columns, static_cast<double>(j) / rows));
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const auto a = static_cast<std::uint32_t>(j * (columns + 1) + i);
            const auto b = a + 1;
            const auto c = a + static_cast<std::uint32_t>(columns) + 1;
            mesh.indices.insert(mesh.indices.end(), {a, b, c + 1, a, c + 1, c});
        }
    makeSmoothNormals(mesh);
    return mesh;
}

/// The rows `first` … `last` of a grid that was made with `columns`.
Mesh rowsOf(const Mesh& whole, std::string name, int columns, int first, int last) {
    Mesh part;
    part.name = std::move(name);
    const auto stride = static_cast<std::size_t>(columns) + 1;
    const auto from = static_cast<std::ptrdiff_t>(static_cast<std::size_t>(first) * stride);
    const auto to = static_cast<std::ptrdiff_t>(static_cast<std::size_t>(last + 1) * stride);
    part.positions.assign(whole.positions.begin() + from, whole.positions.begin() + to);
    part.normals.assign(whole.normals.begin() + from, whole.normals.begin() + to);
    const std::size_t perRow = 6 * static_cast<std::size_t>(columns);
    for (std::size_t i = static_cast<std::size_t>(first) * perRow;
         i < static_cast<std::size_t>(last) * perRow; ++i)
        part.indices.push_back(whole.indices[i] - static_cast<std::uint32_t>(from));
    return part;
}

/// A box between two corners.
Mesh box(std::string name, glm::vec3 low, glm::vec3 high) {
    Mesh mesh;
    mesh.name = std::move(name);
    for (unsigned i = 0; i < 8; ++i)
        mesh.positions.emplace_back((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                                    (i & 4) != 0 ? high.z : low.z);
    mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    makeFlatNormals(mesh);
    return mesh;
}

/// A sail between three corners, blown out towards +z. t: 0 foot … 1 head.
glm::vec3 sailPoint(const glm::vec3& tack, const glm::vec3& clew, const glm::vec3& head, double belly,
                    double s, double t) {
    const glm::dvec3 foot = glm::dvec3(tack) + s * (glm::dvec3(clew) - glm::dvec3(tack));
    const glm::dvec3 point = foot + t * (glm::dvec3(head) - foot);
    const double out =
        belly * std::sin(pi * std::pow(s, 0.8)) * std::sin(pi * std::pow(t, 0.6)) * (1 - 0.3 * t);
    return glm::vec3(point + glm::dvec3(0, 0, out));
}

void addHull(Shipyard& yard) {
    constexpr int along = 44;
    constexpr int around = 40;
    // From stern to bow, and from port over the keel to starboard.
    const Mesh hull = grid("hull", along, around, [](double u, double v) { return hullPoint(u, 2 * v - 1); });
    const Paint top{.color = {0.02f, 0.055f, 0.16f}, .specular = 0.35f, .shininess = 70};
    const Paint stripe{.color = {0.80f, 0.72f, 0.52f}, .specular = 0.1f, .shininess = 30};
    const Paint bottom{.color = {0.42f, 0.035f, 0.025f}, .specular = 0.15f, .shininess = 30};
    yard.add(rowsOf(hull, "port side", along, 0, 7), top);
    yard.add(rowsOf(hull, "port stripe", along, 7, 9), stripe);
    yard.add(rowsOf(hull, "bottom", along, 9, 31), bottom);
    yard.add(rowsOf(hull, "starboard stripe", along, 31, 33), stripe);
    yard.add(rowsOf(hull, "starboard side", along, 33, 40), top);
    yard.add(grid("deck", along, 8,
                  [](double u, double v) {
                      const double across = 1 - 2 * v;
                      glm::vec3 p = hullPoint(u, 1);
                      p.z *= static_cast<float>(0.99 * across);
                      p.y += static_cast<float>(0.04 * (1 - across * across) - 0.004);
                      return p;
                  }),
             {.color = {0.50f, 0.27f, 0.10f}, .specular = 0.12f, .shininess = 40});
    Mesh transom = grid("transom", 16, 1, [](double u, double v) {
        glm::vec3 p = hullPoint(0, 2 * u - 1);
        const double across = p.z / halfBeam(0);
        if (v > 0)
            p.y = static_cast<float>(sheer(0) + 0.04 * (1 - across * across));
        return p;
    });
    makeFlatNormals(transom);
    yard.add(std::move(transom),
             {.color = {0.50f, 0.27f, 0.10f}, .specular = 0.12f, .shininess = 40, .doubleSided = true});
    yard.add(box("rudder", {-1.50f, -0.30f, -0.025f}, {-1.27f, 0.22f, 0.025f}),
             {.color = {0.36f, 0.18f, 0.06f}, .specular = 0.1f});
    yard.add(box("tiller", {-1.42f, 0.40f, -0.02f}, {-0.85f, 0.445f, 0.02f}),
             {.color = {0.36f, 0.18f, 0.06f}, .specular = 0.1f});
}

void addRig(Shipyard& yard) {
    const Paint wood{.color = {0.55f, 0.33f, 0.13f}, .specular = 0.2f, .shininess = 50};
    yard.add(tessellate(Capsule{0.036, 1.04}, 10, "mast"), wood, at(0.22f, 1.30f, 0));
    yard.add(tessellate(Capsule{0.026, 0.58}, 9, "boom"), wood,
             at(-0.40f, 0.66f, 0.0f) * turned(90, {0, 0, 1}));
    constexpr int columns = 20;
    const auto main = [](double s, double t) {
        return sailPoint({0.16f, 0.72f, 0.02f}, {-0.98f, 0.72f, 0.02f}, {0.18f, 2.25f, 0.02f}, 0.26, s, t);
    };
    const Mesh sail = grid("main sail", columns, 24, main);
    const Paint canvas{
        .color = {0.86f, 0.82f, 0.72f}, .specular = 0.03f, .shininess = 8, .doubleSided = true};
    const Paint band{.color = {0.70f, 0.07f, 0.04f}, .specular = 0.03f, .shininess = 8, .doubleSided = true};
    yard.add(rowsOf(sail, "main sail, foot", columns, 0, 11), canvas);
    yard.add(rowsOf(sail, "main sail, band", columns, 11, 15), band);
    yard.add(rowsOf(sail, "main sail, head", columns, 15, 24), canvas);
    yard.add(
        grid("jib", columns, 24,
             [](double s, double t) {
                 return sailPoint({1.34f, 0.54f, 0}, {0.34f, 0.66f, 0.02f}, {0.27f, 1.95f, 0}, 0.2, s, t);
             }),
        {.color = {0.85f, 0.36f, 0.05f}, .specular = 0.03f, .shininess = 8, .doubleSided = true});
    yard.add(grid("pennant", 12, 2,
                  [](double s, double t) {
                      const double taper = (t - 0.5) * (1 - s);
                      return glm::vec3(static_cast<float>(0.22 - 0.5 * s),
                                       static_cast<float>(2.33 - 0.05 * s + 0.2 * taper),
                                       static_cast<float>(0.05 * std::sin(5 * s)));
                  }),
             {.color = {0.75f, 0.03f, 0.03f}, .specular = 0.02f, .doubleSided = true});
}

void addFittings(Shipyard& yard) {
    const glm::vec3 port = hullPoint(0.72, -1);
    const glm::vec3 starboard = hullPoint(0.72, 1);
    yard.add(
        tessellate(Sphere{0.055}, 20, "port lamp"),
        {.color = {0.5f, 0.01f, 0.01f}, .specular = 0.5f, .shininess = 90, .emission = {0.5f, 0.01f, 0.01f}},
        at(port.x, port.y + 0.05f, port.z));
    yard.add(
        tessellate(Sphere{0.055}, 20, "starboard lamp"),
        {.color = {0.01f, 0.4f, 0.06f}, .specular = 0.5f, .shininess = 90, .emission = {0.01f, 0.4f, 0.06f}},
        at(starboard.x, starboard.y + 0.05f, starboard.z));
    yard.add(tessellate(Torus{0.13, 0.04}, 32, "life ring"),
             {.color = {0.9f, 0.30f, 0.03f}, .specular = 0.2f, .shininess = 40},
             at(-0.42f, 0.26f, 0.475f) * turned(83, {1, 0, 0}));
    yard.add(tessellate(Drum{0.20, 0.10, 0.05}, 32, "cabin"),
             {.color = {0.75f, 0.74f, 0.70f}, .specular = 0.2f, .shininess = 40},
             at(0.66f, 0.46f, 0) * glm::scale(glm::mat4(1), {1.5f, 1, 1}));
}

}  // namespace

Scene makeBoat() {
    Shipyard yard;
    addHull(yard);
    addRig(yard);
    addFittings(yard);
    Scene& boat = yard.scene;
    boat.name = "boat";
    Light sun;
    sun.kind = Light::Kind::directional;
    sun.name = "sun";
    sun.direction = glm::normalize(glm::vec3(0.45f, -0.75f, -0.62f));
    sun.color = {1.0f, 0.93f, 0.80f};
    sun.intensity = 0.92f;
    Light sky;
    sky.kind = Light::Kind::directional;
    sky.name = "sky";
    sky.direction = glm::normalize(glm::vec3(-0.7f, -0.35f, 0.5f));
    sky.color = {0.55f, 0.72f, 1.0f};
    sky.intensity = 0.30f;
    boat.lights = {sun, sky};
    boat.ambientLight = {0.30f, 0.33f, 0.38f};
    boat.backgroundTop = {0.42f, 0.58f, 0.76f};
    boat.backgroundBottom = {0.86f, 0.90f, 0.93f};
    return std::move(boat);
}

Scene makeSea() {
    Shipyard yard;
    yard.add(tessellate(Drum{3.1, 0.06, 0.05}, 72, "sea"),
             {.color = {0.035f, 0.19f, 0.24f}, .specular = 0.25f, .shininess = 60}, at(0, -0.06f, 0));
    const Scene boat = makeBoat();
    Scene sea = std::move(yard.scene);
    sea.name = "sea";
    sea.lights = boat.lights;
    sea.ambientLight = boat.ambientLight;
    sea.backgroundTop = boat.backgroundTop;
    sea.backgroundBottom = boat.backgroundBottom;
    return sea;
}

std::array<BoatVertex, 4> namedVertices(const Scene& boat) {
    struct Wanted {
        const char* name;
        const char* part;
        glm::vec3 towards;  ///< the part's vertex that is farthest this way
    };
    static constexpr std::array<Wanted, 4> wanted = {{{"masthead", "mast", {0, 1, 0}},
                                                      {"bow", "starboard side", {1, 0.01f, 0}},
                                                      {"stern", "starboard side", {-1, 0.3f, 0.3f}},
                                                      {"clew", "main sail, foot", {-1, -0.2f, 0}}}};
    std::array<BoatVertex, 4> found{};
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        found[k].name = wanted[k].name;
        float best = -1e9f;
        for (std::size_t i = 0; i < boat.instances.size(); ++i) {
            if (boat.instances[i].name != wanted[k].part)
                continue;
            const std::vector<glm::vec3>& positions = boat.meshes[boat.instances[i].mesh].positions;
            for (std::size_t v = 0; v < positions.size(); ++v) {
                const glm::vec3 p(boat.instances[i].worldFromModel * glm::vec4(positions[v], 1));
                if (const float score = glm::dot(p, wanted[k].towards); score > best) {
                    best = score;
                    found[k] = {wanted[k].name, i, v, p};
                }
            }
        }
        QX_CHECK(best > -1e9f);
    }
    return found;
}

}  // namespace quincunx
