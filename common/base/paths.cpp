#include "base/paths.h"

#include <cstdlib>
#include <system_error>

#include "base/error.h"

namespace quincunx {
namespace fs = std::filesystem;

fs::path executablePath() {
    std::error_code error;
    return fs::read_symlink("/proc/self/exe", error);
}

fs::path assetRoot() {
    std::error_code error;
    const auto hasShaders = [&](const fs::path& root) { return fs::is_directory(root / "shaders", error); };
    if (const char* named = std::getenv("QUINCUNX_ROOT"); named != nullptr && *named != '\0') {
        if (!hasShaders(named))
            throw EnvironmentError("holds no folder shaders/", named,
                                   "set QUINCUNX_ROOT to the folder that does");
        return named;
    }
    for (const fs::path& root :
         {fs::path(QUINCUNX_SOURCE_DIR), executablePath().parent_path() / "../share/quincunx"})
        if (hasShaders(root))
            return fs::weakly_canonical(root);
    throw EnvironmentError("the folders shaders/ and data/ are missing", {},
                           "set QUINCUNX_ROOT to the folder that holds them");
}

fs::path asset(std::string_view relative) {
    fs::path file = assetRoot() / relative;
    std::error_code error;
    if (!fs::exists(file, error))
        throw EnvironmentError("no such file", file.string(),
                               "the installation is incomplete: build it again");
    return file;
}

fs::path typefaceFile() {
    fs::path file = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
    std::error_code error;
    if (!fs::is_regular_file(file, error))
        throw EnvironmentError("the typeface is not installed", file.string(),
                               "install the package fonts-dejavu-core");
    return file;
}

}  // namespace quincunx
