// The scripts of the pages, checked by TypeScript's compiler through the types in their comments.

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

namespace fs = std::filesystem;

test::ProcessResult checkTypes(const std::vector<fs::path>& files, const std::string& libraries) {
    std::vector<std::string> words = {
        "tsc",      "--noEmit", "--allowJs", "--checkJs", "--strict", "--noUncheckedIndexedAccess",
        "--target", "es2020",   "--lib",     libraries};
    for (const fs::path& file : files)
        words.push_back(file.string());
    return test::runProcess(words);
}

std::vector<fs::path> scripts() {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(QUINCUNX_SOURCE_DIR) / "web"))
        if (entry.path().extension() == ".js")
            files.push_back(entry.path());
    return files;
}

TEST(Scripts, AreRightByTheirTypes) {
    ASSERT_GE(scripts().size(), 4U);
    const test::ProcessResult result = checkTypes(scripts(), "es2020,dom,dom.iterable");
    EXPECT_EQ(result.exitStatus, 0) << result.text();
}

TEST(Scripts, ThatAreWrongByTheirTypesAreFound) {
    const test::TemporaryFolder folder;
    const fs::path wrong = folder.file("wrong.js", "// @ts-check\nconst n = \"\";\nn.frobnicate();\n");
    const test::ProcessResult result = checkTypes({wrong}, "es5");
    EXPECT_NE(result.exitStatus, 0);
    EXPECT_THAT(result.out, testing::HasSubstr("frobnicate"));
}

}  // namespace
}  // namespace quincunx
