#include "passes/fullscreen.h"

namespace quincunx {

void drawPicture(graph::PassContext& context, graph::Resource picture) {
    const gl::Program& program = context.programs().get(fullscreenProgram("copy"));
    constexpr int unit = 1;
    program.use();
    program.set("picture", unit);
    context.texture(picture).bind(unit);
    context.drawFullscreen();
}

}  // namespace quincunx
