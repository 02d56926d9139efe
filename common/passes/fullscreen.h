#pragma once

#include <string>

#include "gl/program.h"

namespace quincunx {

/// A program that runs shaders/passes/`name`.frag for every pixel of a target (PassContext::drawFullscreen),
/// labelled by that name.
inline gl::ProgramFiles fullscreenProgram(const std::string& name) {
    return {.label = name, .vertex = "passes/fullscreen.vert", .fragment = "passes/" + name + ".frag"};
}

}  // namespace quincunx
