// Draws lab 10 at its defaults by BareShading, and writes it: bare_shading_main FILE.png. Prints nothing.
#include <cstdio>

#include "bare_shading.h"
#include "base/error.h"
#include "gl/context.h"
#include "image/io.h"

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fputs("usage: bare_shading_main FILE.png\n", stderr);
        return 2;
    }
    try {
        quincunx::preloadImageIo();
        const auto context = quincunx::gl::createOffscreenContext(quincunx::gl::Backend::automatic);
        gladUninstallGLDebug();
        quincunx::BareShading bare(640, 480);
        bare.draw(bare.camera());
        quincunx::writeImage(argv[1], bare.picture());
    } catch (const quincunx::Error& error) {
        std::fprintf(stderr, "bare_shading_main: %s\n", error.what());
        return static_cast<int>(error.exitStatus());
    }
}
