#include "scene/import.h"

#include <new>

#include "base/error.h"
#include "base/file.h"
#include "scene/import_formats.h"

namespace quincunx {

ImportedScene importScene(const std::filesystem::path& file) {
    const std::string extension = lowerCaseExtension(file);
    const bool isObj = extension == ".obj";
    if (!isObj && extension != ".gltf" && extension != ".glb")
        throw InputError("not a model that can be read", printable(file.string()), "use .obj, .gltf or .glb");
    try {
        std::string contents = readFile(file, largestModelFile);
        return isObj ? importObj(std::move(contents), file) : importGltf(contents, file);
    } catch (const std::bad_alloc&) {
        throw InputError("needs more memory than there is", printable(file.string()), "use a smaller model");
    }
}

}  // namespace quincunx
