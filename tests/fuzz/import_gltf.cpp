#include <cstddef>
#include <cstdint>
#include <string>

#include "base/error.h"
#include "scene/import_formats.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string contents(reinterpret_cast<const char*>(data), size);
    try {
        quincunx::importGltf(contents, "fuzz.gltf");
    } catch (const quincunx::InputError&) {
        // Refused: what most inputs deserve.
    }
    return 0;
}
