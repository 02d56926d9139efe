#include "labs/10_shading/shading_pass.h"

namespace quincunx {

SceneBuffers::Layout layoutFor(ShadingModel shading) {
    return shading == ShadingModel::flat ? SceneBuffers::Layout::faceted : SceneBuffers::Layout::shared;
}

gl::ProgramFiles shadingProgram(ShadingModel shading, bool blinnPhong) {
    gl::ProgramFiles files = phongProgram(blinnPhong);
    if (shading == ShadingModel::phong)
        return files;
    files.label = shading == ShadingModel::flat ? "flat" : "gouraud";
    files.vertex = "labs/10_shading/" + files.label + ".vert";
    files.fragment = "labs/10_shading/" + files.label + ".frag";
    return files;
}

}  // namespace quincunx
