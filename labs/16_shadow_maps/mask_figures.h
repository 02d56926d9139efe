#pragma once

#include "image/image.h"

namespace quincunx {

/// A shadow mask held against the traced one, over the pixels where both see a surface.
struct MaskFigures {
    std::size_t surface = 0;  ///< pixels compared
    std::size_t lit = 0;      ///< of these, lit by the trace
    std::size_t acne = 0;     ///< lit by the trace, more than half dark in the mask
    std::size_t leaks = 0;    ///< dark by the trace, more than half lit in the mask
    double rmse = 0;          ///< of the lit share

    double acneShare() const { return lit > 0 ? static_cast<double>(acne) / static_cast<double>(lit) : 0; }
    double leakShare() const {
        return surface > lit ? static_cast<double>(leaks) / static_cast<double>(surface - lit) : 0;
    }
    double wrongShare() const {
        return surface > 0 ? static_cast<double>(acne + leaks) / static_cast<double>(surface) : 0;
    }
};

/// `mask`: a picture of the view "mask", linear, RGBA. `traced`: of traceLitMask, of the same size. Pixels
/// beside an outline of the traced background are left out: triangles and surfaces differ there.
MaskFigures compareMasks(const Image& mask, const Image& traced);

}  // namespace quincunx
