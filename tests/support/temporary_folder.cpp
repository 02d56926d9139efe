#include "tests/support/temporary_folder.h"

#include <cstdlib>

#include "base/check.h"
#include "base/file.h"

namespace quincunx::test {
namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "quincunx-test-XXXXXX").string();
    QX_CHECK(mkdtemp(name.data()) != nullptr);
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

fs::path TemporaryFolder::file(std::string_view name, std::string_view contents) const {
    const fs::path file = path_ / name;
    fs::create_directories(file.parent_path());
    writeFile(file, contents);
    return file;
}

}  // namespace quincunx::test
