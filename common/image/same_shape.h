#pragma once

#include <fmt/format.h>

#include "base/error.h"
#include "image/image.h"

namespace quincunx {

/// Throws InputError naming both sizes, or both encodings, unless they agree; and if there are no pixels.
template <typename Channel>
void requireSameShape(const BasicImage<Channel>& reference, const BasicImage<Channel>& test) {
    if (reference.width != test.width || reference.height != test.height)
        throw InputError(fmt::format("pictures of different sizes: {} × {} and {} × {}", reference.width,
                                     reference.height, test.width, test.height),
                         {}, "compare pictures of one size");
    if (reference.encoding != test.encoding) {
        const auto name = [](Encoding encoding) { return encoding == Encoding::srgb ? "sRGB" : "linear"; };
        throw InputError(fmt::format("pictures of different encodings: {} and {}", name(reference.encoding),
                                     name(test.encoding)),
                         {}, "encode both the same way");
    }
    if (reference.width < 1 || reference.height < 1)
        throw InputError("pictures without pixels cannot be compared");
}

}  // namespace quincunx
