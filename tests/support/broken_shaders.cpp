#include "tests/support/broken_shaders.h"

#include <cstdlib>
#include <fstream>
#include <iterator>

#include <unistd.h>

#include "base/paths.h"

namespace quincunx::test {

namespace fs = std::filesystem;

BrokenShaders::BrokenShaders(const std::string& file, const std::string& from, const std::string& to)
    : root_(fs::temp_directory_path() / fs::path("quincunx_mutation_" + std::to_string(getpid()))) {
    fs::remove_all(root_);
    fs::create_directories(root_);
    fs::copy(assetRoot() / "shaders", root_ / "shaders", fs::copy_options::recursive);
    const fs::path path = root_ / "shaders" / file;
    std::ifstream in(path);
    std::string text((std::istreambuf_iterator<char>(in)), {});
    in.close();
    const std::size_t place = text.find(from);
    found_ = place != std::string::npos;
    if (found_)
        std::ofstream(path) << text.replace(place, from.size(), to);
    setenv("QUINCUNX_ROOT", root_.c_str(), 1);
}

BrokenShaders::~BrokenShaders() {
    unsetenv("QUINCUNX_ROOT");
    std::error_code error;
    fs::remove_all(root_, error);
}

}  // namespace quincunx::test
