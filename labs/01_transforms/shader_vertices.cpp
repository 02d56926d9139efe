#include "labs/01_transforms/shader_vertices.h"

#include <array>

#include "base/check.h"
#include "passes/scene_buffers.h"

namespace quincunx {

ShaderVertices shaderVertices(Studio& studio, const TransformsLab& lab, const Frame& frame) {
    gl::ProgramCache& programs = studio.executor().programs();
    const SpaceChain spaces = lab.chain(frame);
    const TransformsLab::PlacedView placed = lab.placedView(frame);
    const glm::dmat4 eyeFromWorld = glm::inverse(glm::dmat4(frame.camera.worldFromCamera));
    const Scene& boat = lab.boat();

    SceneBuffers buffers(boat, SceneBuffers::Layout::shared);
    std::vector<ObjectBlock> objects;
    ShaderVertices result;
    for (std::size_t i = 0; i < boat.instances.size(); ++i) {
        const glm::mat4& boatFromPart = lab.boatFromPart()[i];
        objects.push_back(
            makeObjectBlock(boat.materials[boat.instances[i].material], placed.worldFromBoat * boatFromPart));
        const Mesh& mesh = boat.meshes[boat.instances[i].mesh];
        for (const std::uint32_t index : mesh.indices)
            result.exactClip.push_back(glm::dmat4(spaces.clipFromEye) *
                                       (eyeFromWorld * (glm::dmat4(spaces.worldFromModel) *
                                                        (glm::dmat4(boatFromPart) *
                                                         glm::dvec4(glm::dvec3(mesh.positions[index]), 1)))));
    }
    buffers.update(makeFrameBlock(boat, boat.lights, placed.clipFromWorld, placed.eyeWorld), objects);

    // Nothing is rasterized, but drawing needs a whole framebuffer all the same.
    const gl::Texture2D color("unused", GL_RGBA8, 1, 1);
    const std::array<const gl::Texture2D*, 1> colors = {&color};
    const gl::Framebuffer target("unused", colors, nullptr);
    target.bind();
    gl::ProgramFiles files = phongProgram();
    files.blocks = SceneBuffers::bindings();
    files.feedback = {"gl_Position"};
    const gl::Program& program = programs.get(files);
    program.use();
    buffers.bindFrame();
    buffers.bindVertices();
    result.clip.resize(result.exactClip.size());
    const gl::Buffer captured("captured vertices", GL_TRANSFORM_FEEDBACK_BUFFER,
                              std::as_bytes(std::span(result.clip)), GL_STREAM_READ);
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, captured.get());
    glEnable(GL_RASTERIZER_DISCARD);
    const gl::Query written("captured triangles", GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
    const std::uint64_t triangles = written.count([&] {
        glBeginTransformFeedback(GL_TRIANGLES);
        for (std::size_t i = 0; i < buffers.instanceCount(); ++i)
            buffers.draw(i);
        glEndTransformFeedback();
    });
    glDisable(GL_RASTERIZER_DISCARD);
    QX_CHECK_EQ(3 * triangles, result.clip.size());
    glBindBuffer(GL_TRANSFORM_FEEDBACK_BUFFER, captured.get());
    glGetBufferSubData(GL_TRANSFORM_FEEDBACK_BUFFER, 0,
                       static_cast<GLsizeiptr>(result.clip.size() * sizeof(glm::vec4)), result.clip.data());
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
    return result;
}

}  // namespace quincunx
