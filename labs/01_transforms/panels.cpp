#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "labs/01_transforms/lab.h"
#include "math/projection.h"
#include "math/transform.h"
#include "math/vector.h"
#include "scene/import.h"

namespace quincunx {
namespace {

constexpr glm::vec4 ink{0.012f, 0.016f, 0.03f, 1};
constexpr glm::vec4 paper{0.96f, 0.97f, 0.98f, 0.80f};
constexpr glm::vec4 magenta{0.72f, 0.0f, 0.33f, 1};
constexpr glm::vec4 white{1, 1, 1, 1};
constexpr glm::vec4 green{0.02f, 0.38f, 0.10f, 1};

/// An eye of a panel, that looks at a ball from a side.
struct PanelEye {
    glm::vec3 centre{0};
    float radius = 1;
    float azimuthDegrees = 0;  ///< from +z towards +x
    float elevationDegrees = 20;

    glm::vec3 position(float aspect) const {
        const float azimuth = glm::radians(azimuthDegrees);
        const float elevation = glm::radians(elevationDegrees);
        const glm::vec3 back(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                             std::cos(azimuth) * std::cos(elevation));
        return centre + distance(aspect) * back;
    }
    glm::mat4 clipFromDisplay(float aspect) const {
        return perspective(fovY, aspect, 0.05f * distance(aspect), 4 * distance(aspect)) *
               cameraFromWorld(lookAt(position(aspect), centre, {0, 1, 0}));
    }

  private:
    static constexpr float fovY = 0.5f;
    float distance(float aspect) const { return radius / std::sin(fovY / 2) / std::min(1.0f, aspect); }
};

glm::vec3 divided(const glm::vec4& p) {
    return homogenize(p).value;
}

std::string coordinates(const glm::dvec4& p) {
    return fmt::format("({:.3f}, {:.3f}, {:.3f}, {:.3f})", p.x, p.y, p.z, p.w);
}

std::string coordinates(const glm::dvec3& p) {
    return fmt::format("({:.3f}, {:.3f}, {:.3f})", p.x, p.y, p.z);
}

}  // namespace

/// A cell of the 3 × 2 panels, in texels of the fine target from its top left.
struct TransformsLab::Panel {
    int left = 0;
    int bottom = 0;
    int width = 1;
    int height = 1;
    int factor = 1;

    static Panel cell(int index, const Frame& frame, int factor) {
        const int gap = 2 * factor;
        const int wide = frame.width * factor;
        const int high = frame.height * factor;
        const int column = index % 3;
        const int row = index / 3;
        Panel panel;
        panel.factor = factor;
        panel.left = wide * column / 3 + (column > 0 ? gap / 2 : 0);
        panel.width = std::max(wide * (column + 1) / 3 - (column < 2 ? gap / 2 : 0) - panel.left, 1);
        const int top = high * row / 2 + (row > 0 ? gap / 2 : 0);
        panel.height = std::max(high * (row + 1) / 2 - (row < 1 ? gap / 2 : 0) - top, 1);
        panel.bottom = high - top - panel.height;
        return panel;
    }
    float aspect() const { return static_cast<float>(width) / static_cast<float>(height); }
    glm::vec2 size() const { return {static_cast<float>(width), static_cast<float>(height)}; }
    /// Of the text, so that a line of coordinates fits.
    float textSize() const {
        return std::max(std::min(size().x / 17, size().y / 15), 7.0f * static_cast<float>(factor));
    }
    float line(float pixels) const { return pixels * std::max(textSize() / 14, 0.6f); }
    void use() const { glViewport(left, bottom, width, height); }
};

void TransformsLab::drawSpaces(graph::PassContext& context, const Frame& frame, int factor) {
    const SpaceChain spaces = chain(frame);
    const BoatVertex chosen = chosenVertex();
    const VertexInSpaces at = throughSpaces(spaces, glm::dvec3(chosen.positionBoat));
    const glm::mat4 clipFromWorld = spaces.clipFromEye * spaces.eyeFromWorld;
    const glm::mat4 worldFromClip = quincunx::inverse(clipFromWorld).value_or(glm::mat4(1));
    const glm::vec3 eyeWorld(frame.camera.worldFromCamera[3]);
    const glm::mat4 boat = spaces.worldFromModel;

    // Clip space has four dimensions, but z is determined by w: (x, y, −w) shows all of it.
    glm::mat4 displayFromClipSpace(1);
    for (int column = 0; column < 4; ++column)
        displayFromClipSpace[column] = glm::vec4(clipFromWorld[column][0], clipFromWorld[column][1],
                                                 -clipFromWorld[column][3], column == 3 ? 1.0f : 0.0f);
    // NDC's z runs away from the viewer.
    glm::mat4 displayFromNdc(1);
    displayFromNdc[2][2] = -1;

    struct Space {
        const char* title;
        std::string where;
        glm::mat4 displayFromWorld;
        PanelEye eye;
        glm::vec3 vertex;
    };
    const float near = nearPlane;
    const float far = farPlane;
    const float reach = std::min(far, 3 * near + 12);
    const glm::mat4& pose = frame.camera.worldFromCamera;
    const glm::vec3 ahead = -glm::vec3(pose[2]);
    const glm::vec3 middle = eyeWorld + 0.50f * reach * ahead;
    // From the side: the view's own right, a little from behind.
    const glm::vec3 side = normalizeOr(glm::vec3(pose[0]) - 0.25f * ahead, glm::vec3(1, 0, 0));
    const float sideDegrees = glm::degrees(std::atan2(side.x, side.z));
    const bool hasNdc = at.ndc.isPoint();
    const std::array<Space, 5> shown = {{{"1  object",
                                          coordinates(at.model),
                                          glm::mat4(1),
                                          {{0, 0.95f, 0}, 1.65f, 28, 14},
                                          glm::vec3(at.model)},
                                         {"2  world = M · object",
                                          coordinates(at.world),
                                          glm::mat4(1),
                                          {middle, 0.62f * reach, sideDegrees, 22},
                                          glm::vec3(at.world)},
                                         {"3  eye = V · world",
                                          coordinates(at.eye),
                                          spaces.eyeFromWorld,
                                          {{0, 0, -0.50f * reach}, 0.62f * reach, 66, 20},
                                          glm::vec3(at.eye)},
                                         {"4  clip = P · eye",
                                          coordinates(at.clip),
                                          displayFromClipSpace,
                                          {{0, 0, -0.62f * reach}, 1.15f * reach, 62, 20},
                                          glm::vec3(at.clip.x, at.clip.y, -at.clip.w)},
                                         {"5  NDC = clip / w",
                                          hasNdc ? coordinates(at.ndc.value) : "w = 0: a direction",
                                          displayFromNdc * clipFromWorld,
                                          {{0, 0, 0}, 1.85f, 24, 18},
                                          glm::vec3(at.ndc.value.x, at.ndc.value.y, -at.ndc.value.z)}}};

    for (std::size_t i = 0; i < shown.size(); ++i) {
        const Space& space = shown[i];
        const Panel panel = Panel::cell(static_cast<int>(i), frame, factor);
        panel.use();
        const glm::mat4 clipFromDisplay = space.eye.clipFromDisplay(panel.aspect());
        const bool object = i == 0;
        const glm::vec3 seenFrom = i <= 1 ? space.eye.position(panel.aspect()) : eyeWorld;
        drawScene(context, object ? glm::mat4(1) : boat, worldFromSea_,
                  {.clipFromWorld = clipFromDisplay * space.displayFromWorld, .eyeWorld = seenFrom}, !object);

        lines_.clear();
        const Lines::Style frustum{.color = {0.10f, 0.11f, 0.14f, 0.85f}, .widthPixels = panel.line(1.3f)};
        const Lines::Style ray{
            .color = magenta, .widthPixels = panel.line(1.4f), .dashPixels = panel.line(5)};
        const glm::mat4 displayFromClip = space.displayFromWorld * worldFromClip;
        if (object) {
            lines_.axes(glm::mat4(glm::mat3(1.75f)), panel.line(2.4f));
        } else if (i == 4) {
            lines_.box(glm::mat4(1), frustum);
            lines_.axes(displayFromNdc, panel.line(2.4f));
        } else {
            lines_.box(displayFromClip, frustum);
            lines_.axes(glm::mat4(glm::mat3(i == 1 ? 1.2f : 0.18f * reach)), panel.line(2.4f));
            if (i == 1)
                lines_.axes(frame.camera.worldFromCamera, panel.line(2.0f));
        }
        if (!object && hasNdc && at.ndc.kind == HomogeneousKind::point) {
            // From the eye, which is a point in all of these spaces but NDC.
            const glm::vec3 first =
                i == 4 ? divided(displayFromClip * glm::vec4(at.ndc.value.x, at.ndc.value.y, -1, 1))
                       : glm::vec3(space.displayFromWorld * glm::vec4(eyeWorld, 1));
            const glm::vec3 last = divided(displayFromClip * glm::vec4(at.ndc.value.x, at.ndc.value.y, 1, 1));
            lines_.segment(first, last, ray);
        }
        lines_.draw(context, {.clipFromWorld = clipFromDisplay, .viewportPixels = panel.size()});
        dots_.clear();
        if (i < 4 || hasNdc) {
            dots_.segment(space.vertex, space.vertex, {.color = white, .widthPixels = panel.line(10)});
            dots_.segment(space.vertex, space.vertex, {.color = magenta, .widthPixels = panel.line(6.5f)});
        }
        dots_.draw(context,
                   {.clipFromWorld = clipFromDisplay, .viewportPixels = panel.size(), .depthTest = false});
        addBackdrop(context, panel, space.title, false);
        labels_.clear();
        labels_.text(space.where, {panel.size().x / 2, panel.size().y - 0.6f * panel.textSize()},
                     {.sizePixels = panel.textSize(),
                      .color = magenta,
                      .backing = paper,
                      .anchor = Labels::Anchor::bottomCenter});
        labels_.draw(context, panel.size());
    }

    // The window: the picture itself, in the frame's proportions.
    const Panel cell = Panel::cell(5, frame, factor);
    Panel window = cell;
    const float aspect = static_cast<float>(frame.width) / static_cast<float>(frame.height);
    const float margin = 2.4f * cell.textSize();
    const float fitted =
        std::min(cell.size().x - 0.8f * cell.textSize(), (cell.size().y - 2 * margin) * aspect);
    window.width = std::max(static_cast<int>(fitted), 1);
    window.height = std::max(static_cast<int>(fitted / aspect), 1);
    window.left += (cell.width - window.width) / 2;
    window.bottom += (cell.height - window.height) / 2;
    window.use();
    drawScene(context, boat, worldFromSea_, {.clipFromWorld = clipFromWorld, .eyeWorld = eyeWorld}, true);
    lines_.clear();
    dots_.clear();
    const glm::mat4 clipFromWindow =
        orthographic(0, static_cast<float>(frame.width), 0, static_cast<float>(frame.height), -1, 1);
    std::string where = "behind the eye: no pixel";
    if (at.window) {
        const glm::vec3 pixel(at.window->x, at.window->y, 0);
        const Lines::Style ruler{
            .color = magenta, .widthPixels = cell.line(1.2f), .dashPixels = cell.line(4)};
        lines_.segment({0, pixel.y, 0}, pixel, ruler);
        lines_.segment({pixel.x, 0, 0}, pixel, ruler);
        dots_.segment(pixel, pixel, {.color = white, .widthPixels = cell.line(10)});
        dots_.segment(pixel, pixel, {.color = magenta, .widthPixels = cell.line(6.5f)});
        where = fmt::format("({:.2f}, {:.2f}), depth {:.5f}", at.window->x, at.window->y, at.window->z);
        if (!at.inView)
            where = "clipped: outside the view";
    }
    lines_.draw(context,
                {.clipFromWorld = clipFromWindow, .viewportPixels = window.size(), .depthTest = false});
    dots_.draw(context,
               {.clipFromWorld = clipFromWindow, .viewportPixels = window.size(), .depthTest = false});
    cell.use();
    addBackdrop(context, cell, fmt::format("6  window, {} × {}", frame.width, frame.height), false);
    labels_.clear();
    labels_.text(where, {cell.size().x / 2, cell.size().y - 0.6f * cell.textSize()},
                 {.sizePixels = cell.textSize(),
                  .color = magenta,
                  .backing = paper,
                  .anchor = Labels::Anchor::bottomCenter});
    labels_.draw(context, cell.size());
    glViewport(0, 0, frame.width * factor, frame.height * factor);
}

void TransformsLab::addBackdrop(graph::PassContext& context, const Panel& panel, const std::string& title,
                                bool intended) {
    labels_.clear();
    const float size = panel.textSize();
    labels_.text(title, {0.7f * size, 0.5f * size},
                 {.sizePixels = 1.1f * size, .color = intended ? green : ink, .backing = paper});
    labels_.draw(context, panel.size());
}

void TransformsLab::drawOrders(graph::PassContext& context, const Frame& frame, int factor) {
    const glm::mat4 intended = worldFromBoat(intendedOrder);
    Bounds bounds;
    for (std::size_t i = 0; i < boatFromPart_.size(); ++i)
        for (const glm::vec3& position : boat().meshes[boat().instances[i].mesh].positions)
            bounds.extend(glm::vec3(boatFromPart_[i] * glm::vec4(position, 1)));
    glm::mat4 boatFromBox(1);
    for (int axis = 0; axis < 3; ++axis) {
        boatFromBox[axis][axis] = (bounds.max[axis] - bounds.min[axis]) / 2;
        boatFromBox[3][axis] = (bounds.max[axis] + bounds.min[axis]) / 2;
    }
    for (int i = 0; i < orderCount; ++i) {
        const Panel panel = Panel::cell(i, frame, factor);
        panel.use();
        Camera camera = frame.camera;
        camera.fovYRadians = glm::radians(static_cast<float>(fov));
        camera = fittedToAspect(camera, panel.aspect());
        const glm::mat4 clipFromWorld = perspective(camera.fovYRadians, panel.aspect(), 0.2f, 100) *
                                        inverted(camera.worldFromCamera, inverse.as<Inverse>());
        const glm::mat4 placed = worldFromBoat(i);
        drawScene(context, placed, worldFromSea_,
                  {.clipFromWorld = clipFromWorld, .eyeWorld = glm::vec3(camera.worldFromCamera[3])}, true);

        double farthest = 0;
        for (const BoatVertex& corner : vertices_)
            farthest = std::max<double>(
                farthest, length(glm::vec3((placed - intended) * glm::vec4(corner.positionBoat, 1))));
        const bool right = i == intendedOrder;
        lines_.clear();
        lines_.box(intended * boatFromBox, {.color = right ? green : magenta,
                                            .widthPixels = panel.line(1.5f),
                                            .dashPixels = right ? 0 : panel.line(4)});
        lines_.axes(placed, panel.line(2.2f));
        lines_.draw(context, {.clipFromWorld = clipFromWorld, .viewportPixels = panel.size()});
        // A frame around the intended one.
        if (right) {
            lines_.clear();
            const float inset = panel.line(2.5f);
            const glm::vec2 far = panel.size() - inset;
            const std::array<glm::vec3, 4> corners = {
                {{inset, inset, 0}, {far.x, inset, 0}, {far.x, far.y, 0}, {inset, far.y, 0}}};
            lines_.polyline(corners, {.color = green, .widthPixels = panel.line(5)}, true);
            lines_.draw(context, {.clipFromWorld = orthographic(0, panel.size().x, 0, panel.size().y, -1, 1),
                                  .viewportPixels = panel.size(),
                                  .depthTest = false});
        }
        const std::string& letters = order.options()[static_cast<std::size_t>(i)];
        addBackdrop(context, panel,
                    fmt::format("v' = {} {} {} v{}", letters[0], letters[1], letters[2],
                                right ? "   as intended" : ""),
                    right);
        labels_.clear();
        labels_.text(
            right ? "stretched, turned, then carried" : fmt::format("off by up to {:.2f} units", farthest),
            {panel.size().x / 2, panel.size().y - 0.6f * panel.textSize()},
            {.sizePixels = panel.textSize(),
             .color = right ? green : magenta,
             .backing = paper,
             .anchor = Labels::Anchor::bottomCenter});
        labels_.draw(context, panel.size());
    }
    glViewport(0, 0, frame.width * factor, frame.height * factor);
}

}  // namespace quincunx
