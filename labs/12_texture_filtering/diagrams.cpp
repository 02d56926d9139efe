#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "labs/12_texture_filtering/lab.h"

namespace quincunx {
namespace {

const glm::vec4 ink(0.92f, 0.93f, 0.95f, 1);
const glm::vec4 shade(0.01f, 0.015f, 0.03f, 0.72f);
const glm::vec4 pixelColor(1, 1, 1, 1);
const glm::vec4 ellipseColor(0.1f, 0.75f, 1.0f, 1);
const glm::vec4 probeColor(1.0f, 0.72f, 0.08f, 1);
const glm::vec4 squareColor(1.0f, 0.16f, 0.12f, 1);

constexpr gl::Sampler::Params asTheyAre{GL_NEAREST_MIPMAP_NEAREST, GL_NEAREST, GL_REPEAT};

/// Pixels from the top left, y down.
glm::mat4 clipFromPixels(float width, float height) {
    return glm::ortho(0.0f, width, height, 0.0f, -1.0f, 1.0f);
}

}  // namespace

TextureFilteringLab::QuadLayout TextureFilteringLab::quadLayout(const Frame& frame) const {
    const float margins = 6 * textSize(frame);
    const int step = std::max(static_cast<int>((static_cast<float>(frame.height) - margins) / 16), 1);
    QuadLayout quad;
    quad.height = 16 * step;
    quad.width = 8 * step;
    const int gap = std::max(frame.width / 8, 4 * step);
    quad.squareLeft = std::max((frame.width - quad.width - gap - 4 * step) / 2, 0);
    quad.left = quad.squareLeft + 4 * step + gap;
    quad.bottom = std::max((frame.height - quad.height) / 2, 0);
    return quad;
}

void TextureFilteringLab::drawQuad(graph::PassContext& context, const Frame& frame) {
    const float size = textSize(frame);
    const QuadLayout quad = quadLayout(frame);
    const int side = quad.width / 2;
    gl::Sampler::Params params = asTheyAre;
    params.wrap = samplerParams(Filter::nearest).wrap;
    const int squareBottom = quad.bottom + (quad.height - side) / 2;
    drawWindow(context, {quad.squareLeft, squareBottom, side, side}, {{0, 1}, {1, 0}}, 0, params);
    drawWindow(context, {quad.left, quad.bottom, quad.width, quad.height},
               {{0, float{quadV}}, {float{quadU}, 0}}, 0, params);

    labels_.clear();
    const auto corner = [&](const char* name, float u, float v, int x, int yUp, Labels::Anchor anchor) {
        const float down = yUp == 0 ? 0.4f * size : -0.4f * size;
        labels_.text(
            fmt::format("{} ({:g}, {:g})", name, u, v),
            {static_cast<float>(quad.left + x), static_cast<float>(frame.height - quad.bottom - yUp) + down},
            {.sizePixels = size, .color = ink, .anchor = anchor});
    };
    corner("v₀", 0, 0, 0, 0, Labels::Anchor::topCenter);
    corner("v₁", quadU, 0, quad.width, 0, Labels::Anchor::topCenter);
    corner("v₂", quadU, quadV, quad.width, quad.height, Labels::Anchor::bottomCenter);
    corner("v₃", 0, quadV, 0, quad.height, Labels::Anchor::bottomCenter);
    labels_.text("the texture, 4 × 4 squares",
                 {static_cast<float>(quad.squareLeft) + 0.5f * static_cast<float>(side),
                  static_cast<float>(frame.height - squareBottom) + 0.4f * size},
                 {.sizePixels = size, .color = ink, .anchor = Labels::Anchor::topCenter});
    labels_.draw(context, {frame.width, frame.height});
}

void TextureFilteringLab::drawPyramid(graph::PassContext& context, const Frame& frame) {
    const float size = textSize(frame);
    const int levels = static_cast<int>(made_->size > 0 ? texture().levels() : 1);
    const float aspect = static_cast<float>(device_->height()) / static_cast<float>(device_->width());
    const int margin = static_cast<int>(1.6f * size);
    const int gap = std::max(frame.height / 90, 2);
    // The base, and a column of the others beside it.
    const int width =
        std::max(std::min({(frame.width - 2 * margin - gap) * 2 / 3,
                           static_cast<int>(static_cast<float>(frame.height - 3 * margin) / aspect)}),
                 4);
    const int left = (frame.width - width * 3 / 2 - gap) / 2;
    labels_.clear();
    int x = left;
    float top = static_cast<float>(frame.height) / 2 - 0.5f * aspect * static_cast<float>(width);
    float reach = top;
    for (int level = 0; level < levels; ++level) {
        const int wide = std::max(width >> level, 1);
        const int high = std::max(static_cast<int>(aspect * static_cast<float>(width)) >> level, 1);
        drawWindow(context, {x, frame.height - static_cast<int>(reach) - high, wide, high}, {{0, 0}, {1, 1}},
                   static_cast<float>(level), asTheyAre);
        const std::string words =
            fmt::format("{} × {}", mipSide(device_->width(), level), mipSide(device_->height(), level));
        if (level == 0)
            labels_.text(words, {x, reach + static_cast<float>(high) + 0.3f * size},
                         {.sizePixels = size, .color = ink});
        else if (static_cast<float>(high) > size)
            labels_.text(words, {static_cast<float>(x + wide + gap), reach},
                         {.sizePixels = 0.8f * size, .color = ink});
        if (level == 0)
            x += width + gap;
        else
            reach += static_cast<float>(high + gap);
    }
    labels_.draw(context, {frame.width, frame.height});
}

void TextureFilteringLab::drawFootprint(graph::PassContext& context, const Frame& frame) {
    const float size = textSize(frame);
    const int half = std::max(frame.width / 2, 1);
    drawFloorPanel(context, frame, {0, half, "", minification.as<Filter>(), {}}, minification.as<Filter>());
    labels_.clear();
    lines_.clear();

    // The chosen pixel on the floor, and what it covers of the texture.
    const FloorView seen = floorView(frame.camera, half, frame.height);
    const glm::dvec2 pixel(std::floor(probeX * static_cast<float>(half - 1)) + 0.5,
                           std::floor(probeY * static_cast<float>(frame.height - 1)) + 0.5);
    const FloorView::Place place = seen.at(pixel);
    const glm::vec2 mark(pixel.x, frame.height - pixel.y);
    const float thick = std::max(1.5f, size / 9);
    lines_.circle({mark, 0}, {0, 0, 1}, 0.7f * size, {.color = pixelColor, .widthPixels = thick});
    lines_.circle({mark, 0}, {0, 0, 1}, 0.1f * size, {.color = pixelColor, .widthPixels = thick}, 12);
    glViewport(0, 0, half, frame.height);
    lines_.draw(context,
                {.clipFromWorld = clipFromPixels(static_cast<float>(half), static_cast<float>(frame.height)),
                 .viewportPixels = {half, frame.height},
                 .depthTest = false});
    glViewport(0, 0, frame.width, frame.height);
    const int right = frame.width - half;
    if (!place.floor || right < 1) {
        labels_.text("the chosen pixel shows sky", {static_cast<float>(half) + size, size},
                     {.sizePixels = size, .color = ink});
        labels_.draw(context, {frame.width, frame.height});
        return;
    }

    const glm::dvec2 side(device_->width(), device_->height());
    const Footprint footprint =
        footprintOf(place.point(), device_->width(), device_->height(), maxAnisotropy, lodBias);
    const double isotropic = levelOfDetail(place.point(), device_->width(), device_->height(), lodBias);
    const double radius = 0.66 * std::max({footprint.longTexels, std::exp2(isotropic), 3.0});
    const double scale = 0.5 * std::min(right, frame.height) / radius;  // pixels a texel
    const glm::dvec2 halfWindow(0.5 * right / scale / side.x, 0.5 * frame.height / scale / side.y);
    drawWindow(context, {half, 0, right, frame.height}, {place.st - halfWindow, place.st + halfWindow}, 0,
               asTheyAre, 0.4f);

    const auto toPixels = [&](glm::dvec2 st) {
        const glm::dvec2 texels = (st - place.st) * side;
        return glm::vec3(0.5 * right + scale * texels.x, 0.5 * frame.height + scale * texels.y, 0);
    };
    lines_.clear();
    // What an isotropic filter takes: a square as wide as the long axis.
    const double reach = 0.5 * std::exp2(isotropic);
    std::array<glm::vec3, 4> square;
    std::array<glm::vec3, 4> outline;
    static constexpr std::array corners = {glm::dvec2(-1, -1), glm::dvec2(1, -1), glm::dvec2(1, 1),
                                           glm::dvec2(-1, 1)};
    for (std::size_t i = 0; i < corners.size(); ++i) {
        square[i] = toPixels(place.st + reach * corners[i] / side);
        const FloorView::Place there = seen.at(pixel + 0.5 * corners[i]);
        outline[i] = toPixels(there.floor ? there.st : place.st);
    }
    lines_.polyline(square, {.color = squareColor, .widthPixels = thick, .dashPixels = 4 * thick}, true);
    for (int i = 0; i < footprint.probes; ++i)
        lines_.circle(toPixels(footprint.probe(i, place.st)), {0, 0, 1},
                      static_cast<float>(0.5 * std::exp2(std::max(footprint.lambda, 0.0)) * scale),
                      {.color = probeColor, .widthPixels = thick});
    for (int i = 0; i < footprint.probes; ++i)
        lines_.circle(toPixels(footprint.probe(i, place.st)), {0, 0, 1}, thick,
                      {.color = probeColor, .widthPixels = thick}, 12);
    std::vector<glm::vec3> ellipse;
    const glm::dvec2 along = 0.5 * footprint.longAxis * side;
    const double length = glm::length(along);
    const glm::dvec2 across =
        length > 0 ? glm::dvec2(-along.y, along.x) / length * 0.5 * footprint.shortTexels : glm::dvec2(0);
    for (int i = 0; i < 96; ++i) {
        const double angle = i * 2 * glm::pi<double>() / 96;
        ellipse.push_back(toPixels(place.st + (std::cos(angle) * along + std::sin(angle) * across) / side));
    }
    lines_.polyline(ellipse, {.color = ellipseColor, .widthPixels = thick}, true);
    lines_.polyline(outline, {.color = pixelColor, .widthPixels = 1.3f * thick}, true);
    glViewport(half, 0, right, frame.height);
    lines_.draw(context,
                {.clipFromWorld = clipFromPixels(static_cast<float>(right), static_cast<float>(frame.height)),
                 .viewportPixels = {right, frame.height},
                 .depthTest = false});
    glViewport(0, 0, frame.width, frame.height);

    labels_.plate({half - 1, 0}, {2, frame.height}, {1, 1, 1, 1});
    const std::array rows{
        std::pair(
            fmt::format("the pixel: {:.1f} × {:.1f} texels", footprint.longTexels, footprint.shortTexels),
            ellipseColor),
        std::pair(fmt::format("{} probe{} at level {:.2f}", footprint.probes, footprint.probes > 1 ? "s" : "",
                              std::max(footprint.lambda, 0.0)),
                  probeColor),
        std::pair(fmt::format("trilinear: level {:.2f}", std::max(isotropic, 0.0)), squareColor)};
    float top = static_cast<float>(frame.height) - (static_cast<float>(rows.size()) * 1.3f + 0.4f) * size;
    for (const auto& [words, color] : rows) {
        labels_.text(words, {static_cast<float>(half) + 0.6f * size, top},
                     {.sizePixels = size, .color = color, .backing = shade});
        top += 1.3f * size;
    }
    labels_.draw(context, {frame.width, frame.height});
}

}  // namespace quincunx
