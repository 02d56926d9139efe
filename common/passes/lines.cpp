#include "passes/lines.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "base/check.h"
#include "math/vector.h"

namespace quincunx {

void Lines::segment(glm::vec3 from, glm::vec3 to, const Style& style) {
    QX_CHECK_GT(style.widthPixels, 0.0f);
    segments_.push_back({from, to, style.color, {style.widthPixels, style.dashPixels}});
}

void Lines::polyline(std::span<const glm::vec3> points, const Style& style, bool closed) {
    for (std::size_t i = 1; i < points.size(); ++i)
        segment(points[i - 1], points[i], style);
    if (closed && points.size() > 2)
        segment(points.back(), points.front(), style);
}

void Lines::arrow(glm::vec3 from, glm::vec3 to, float headLength, const Style& style) {
    segment(from, to, style);
    const std::optional<glm::mat3> frame = basisAround(to - from);
    if (!frame)
        return;
    for (const float angle : {0.0f, 0.5f, 1.0f, 1.5f}) {
        const glm::vec3 across = std::cos(angle * std::numbers::pi_v<float>) * (*frame)[0] +
                                 std::sin(angle * std::numbers::pi_v<float>) * (*frame)[1];
        segment(to, to - headLength * (*frame)[2] + 0.4f * headLength * across, style);
    }
}

void Lines::circle(glm::vec3 center, glm::vec3 normal, float radius, const Style& style, int segments) {
    QX_CHECK_GE(segments, 3);
    const glm::mat3 frame = basisAround(normal).value_or(glm::mat3(1));
    std::vector<glm::vec3> points;
    for (int i = 0; i < segments; ++i) {
        const float angle =
            2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(segments);
        points.push_back(center + radius * (std::cos(angle) * frame[0] + std::sin(angle) * frame[1]));
    }
    polyline(points, style, true);
}

void Lines::box(const glm::mat4& worldFromBox, const Style& style) {
    std::array<glm::vec3, 8> corners;
    for (std::size_t i = 0; i < 8; ++i) {
        const glm::vec4 corner =
            worldFromBox * glm::vec4((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1, 1);
        corners[i] = glm::vec3(corner) / corner.w;
    }
    for (std::size_t i = 0; i < 8; ++i)
        for (const std::size_t bit : {std::size_t{1}, std::size_t{2}, std::size_t{4}})
            if ((i & bit) == 0)
                segment(corners[i], corners[i | bit], style);
}

void Lines::axes(const glm::mat4& worldFromFrame, float widthPixels) {
    static constexpr std::array<glm::vec4, 3> colors = {
        {{0.80f, 0.07f, 0.07f, 1}, {0.08f, 0.50f, 0.10f, 1}, {0.06f, 0.20f, 0.85f, 1}}};
    const glm::vec3 origin(worldFromFrame[3]);
    for (int i = 0; i < 3; ++i) {
        const glm::vec3 axis(worldFromFrame[i]);
        arrow(origin, origin + axis, 0.15f * length(axis),
              {.color = colors[static_cast<std::size_t>(i)], .widthPixels = widthPixels});
    }
}

void Lines::draw(graph::PassContext& context, const View& view) {
    if (segments_.empty())
        return;
    const auto bytes = std::as_bytes(std::span(segments_));
    if (!device_) {
        device_.emplace(Device{gl::Buffer("line segments", GL_ARRAY_BUFFER, bytes, GL_DYNAMIC_DRAW),
                               gl::VertexArray("lines")});
        constexpr GLsizei stride = sizeof(Segment);
        const auto attribute = [&](GLuint location, GLint components, std::size_t offset) {
            device_->vertexArray.attribute(device_->segments,
                                           {location, components, GL_FLOAT, false, stride, offset, 1});
        };
        attribute(0, 3, offsetof(Segment, from));
        attribute(1, 3, offsetof(Segment, to));
        attribute(2, 4, offsetof(Segment, color));
        attribute(3, 2, offsetof(Segment, widthAndDash));
    } else {
        device_->segments.upload(bytes);
    }
    const gl::Program& program = context.programs().get(
        {.label = "lines", .vertex = "passes/lines.vert", .fragment = "passes/lines.frag"});
    program.use();
    program.set("clipFromWorld", view.clipFromWorld);
    program.set("viewportPixels", view.viewportPixels);
    program.set("depthBias", view.depthBias);
    device_->vertexArray.bind();
    if (view.depthTest) {
        glEnable(GL_DEPTH_TEST);
        glDepthMask(GL_FALSE);
        glDepthFunc(GL_LEQUAL);
    }
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(segments_.size()));
    glDisable(GL_BLEND);
    if (view.depthTest) {
        glDepthFunc(GL_LESS);
        glDepthMask(GL_TRUE);
        glDisable(GL_DEPTH_TEST);
    }
}

}  // namespace quincunx
