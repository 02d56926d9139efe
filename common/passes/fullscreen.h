#pragma once

#include <string>

#include "gl/executor.h"
#include "gl/program.h"

namespace quincunx {

/// A program that runs a fragment shader, relative to shaders/, for every pixel of a target
/// (PassContext::drawFullscreen).
inline gl::ProgramFiles fullscreenProgram(const std::string& label, const std::string& fragment) {
    return {.label = label, .vertex = "passes/fullscreen.vert", .fragment = fragment};
}

/// The same of shaders/passes/`name`.frag, labelled by that name.
inline gl::ProgramFiles fullscreenProgram(const std::string& name) {
    return fullscreenProgram(name, "passes/" + name + ".frag");
}

/// Copies a picture that the pass reads into the bound target, whose format encodes it.
void drawPicture(graph::PassContext& context, graph::Resource picture);

}  // namespace quincunx
