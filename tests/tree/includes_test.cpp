// Includes only go down: a room of common/ may include the rooms that its row names, and nothing else of
// ours.

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/file.h"
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::map<std::string, std::set<std::string>> mayInclude = {
    {"base", {}},
    {"math", {"base"}},
    {"geometry", {"base", "math"}},
    {"image", {"base", "math"}},
    {"scene", {"base", "math", "geometry", "image"}},
    {"graph", {"base", "math", "geometry", "image", "scene"}},
    {"gl", {"base", "math", "geometry", "image", "scene", "graph"}},
    {"trace", {"base", "math", "geometry", "image", "scene"}},
    {"passes", {"base", "math", "geometry", "image", "scene", "graph", "gl", "trace"}},
    {"web", {"base", "math", "image"}},
    {"lab", {"base", "math", "geometry", "image", "scene", "graph", "gl", "trace"}},
    {"atlas", {"base", "math", "geometry", "image", "scene", "graph", "gl", "trace", "web", "lab"}},
    {"grade", {"base", "math", "geometry", "image", "scene", "graph", "gl", "trace", "web", "lab"}},
    {"cli",
     {"base", "math", "geometry", "image", "scene", "graph", "gl", "trace", "web", "lab", "atlas", "grade"}},
    {"labs", {"base", "math", "geometry", "image", "scene", "graph", "gl", "trace", "passes", "lab"}},
};

const std::set<std::string> roomsWithGl = {"gl", "passes", "lab", "atlas", "cli", "labs"};
const std::set<std::string> glHeaders = {"glad", "GL", "GLES2", "GLES3", "EGL", "GLFW", "KHR"};

/// The folder that a file or an include is in, seen from common/ or from the top: "lab" for "lab/lab.h".
std::string firstFolder(const std::string& path) {
    return path.substr(0, path.find('/'));
}

/// What is wrong with this include in a file of `room`; empty: nothing.
std::string fault(const std::string& room, const std::string& included) {
    if (included.find("..") != std::string::npos || included.rfind("common/", 0) == 0)
        return "includes are relative to common/";
    const std::string target = firstFolder(included);
    if (glHeaders.contains(target) && !roomsWithGl.contains(room))
        return room + " knows no GL";
    if (!mayInclude.contains(target) || target == room || mayInclude.at(room).contains(target))
        return {};
    return fmt::format("{} is not below {}", target, room);
}

/// A line "file: include: fault" for every include that goes up.
std::vector<std::string> faultsOf(const fs::path& tree) {
    static const std::regex include(R"(^[ \t]*#[ \t]*include[ \t]*["<]([^">]+)[">])");
    std::vector<std::string> faults;
    for (const fs::path& top : {tree / "common", tree / "labs"}) {
        for (const fs::directory_entry& entry : fs::recursive_directory_iterator(top)) {
            const fs::path extension = entry.path().extension();
            if (!entry.is_regular_file() || (extension != ".h" && extension != ".cpp" && extension != ".inc"))
                continue;
            const bool inLabs = top.filename() == "labs";
            const std::string room =
                inLabs ? "labs" : firstFolder(entry.path().lexically_relative(top).generic_string());
            std::istringstream lines(readFile(entry.path(), 1 << 24));
            std::smatch match;
            for (std::string line; std::getline(lines, line);) {
                if (!std::regex_search(line, match, include))
                    continue;
                if (const std::string wrong = fault(room, match[1].str()); !wrong.empty())
                    faults.push_back(fmt::format("{}: {}: {}",
                                                 entry.path().lexically_relative(tree).generic_string(),
                                                 match[1].str(), wrong));
            }
        }
    }
    std::sort(faults.begin(), faults.end());
    return faults;
}

/// The faults of a copy of the tree's own sources with more files, each a name and its contents.
std::vector<std::string> faultsWith(const std::vector<std::pair<std::string, std::string>>& planted) {
    const TemporaryFolder copy;
    for (const char* top : {"common", "labs"})
        fs::copy(fs::path(QUINCUNX_SOURCE_DIR) / top, copy / top, fs::copy_options::recursive);
    for (const auto& [file, contents] : planted)
        copy.file(file, contents);
    return faultsOf(copy.path());
}

TEST(Includes, OnlyGoDown) {
    EXPECT_THAT(faultsOf(QUINCUNX_SOURCE_DIR), IsEmpty());
}

TEST(Includes, NameARoomForEveryFolderOfCommon) {
    for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(QUINCUNX_SOURCE_DIR) / "common"))
        EXPECT_TRUE(!entry.is_directory() || mayInclude.contains(entry.path().filename())) << entry.path();
}

TEST(Includes, ThatGoUpAreFound) {
    EXPECT_THAT(faultsWith({{"common/base/planted.h", "#pragma once\n#include \"lab/lab.h\"\n"}}),
                ElementsAre("common/base/planted.h: lab/lab.h: lab is not below base"));
    EXPECT_THAT(faultsWith({{"common/geometry/deep/planted.cpp", "  #  include <image/image.h>\n"}}),
                ElementsAre("common/geometry/deep/planted.cpp: image/image.h: image is not below geometry"));
    EXPECT_THAT(faultsWith({{"common/lab/planted.cpp", "#include \"labs/all_labs.h\"\n"}}),
                ElementsAre(HasSubstr("labs is not below lab")));
}

TEST(Includes, BetweenPassesAndLabAreFoundBothWays) {
    EXPECT_THAT(faultsWith({{"common/passes/planted.h", "#include \"lab/knob.h\"\n"}}),
                ElementsAre(HasSubstr("lab is not below passes")));
    EXPECT_THAT(faultsWith({{"common/lab/planted.h", "#include \"passes/shadow.h\"\n"}}),
                ElementsAre(HasSubstr("passes is not below lab")));
}

TEST(Includes, OfGlAreFoundWhereGlIsNotKnown) {
    std::vector<std::pair<std::string, std::string>> planted;
    for (const char* room : {"graph", "scene", "geometry", "trace"})
        for (const char* header : {"glad/gl.h", "GLFW/glfw3.h", "EGL/egl.h", "GL/osmesa.h"})
            planted.emplace_back(fmt::format("common/{}/planted_{}.cpp", room, planted.size()),
                                 fmt::format("#include <{}>\n", header));
    const std::vector<std::string> faults = faultsWith(planted);
    EXPECT_EQ(faults.size(), planted.size());
    EXPECT_THAT(faults, testing::Each(HasSubstr("knows no GL")));
}

TEST(Includes, ThatLeaveTheirFolderByDotsAreFound) {
    EXPECT_THAT(faultsWith({{"common/base/planted.cpp", "#include \"../lab/lab.h\"\n"}}),
                ElementsAre(HasSubstr("relative to common/")));
}

}  // namespace
}  // namespace quincunx
