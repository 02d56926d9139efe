// Every C++ file has the form that .clang-format describes.

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

namespace fs = std::filesystem;
using test::ProcessResult;
using test::runProcess;
using test::TemporaryFolder;

std::vector<std::string> sourcesBelow(const fs::path& tree) {
    std::vector<std::string> files;
    for (const char* top : {"common", "labs", "tests"})
        for (const fs::directory_entry& entry : fs::recursive_directory_iterator(tree / top))
            if (const fs::path extension = entry.path().extension();
                entry.is_regular_file() && (extension == ".h" || extension == ".cpp"))
                files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    return files;
}

ProcessResult checkFormat(const std::vector<std::string>& files) {
    std::vector<std::string> words = {CLANG_FORMAT_PROGRAM, "--dry-run", "-Werror", "--ferror-limit=3"};
    words.insert(words.end(), files.begin(), files.end());
    return runProcess(words);
}

TEST(Format, IsThatOfTheClangFormatFileEverywhere) {
    const std::vector<std::string> files = sourcesBelow(QUINCUNX_SOURCE_DIR);
    ASSERT_GT(files.size(), 10u);
    const ProcessResult result = checkFormat(files);
    EXPECT_EQ(result.exitStatus, 0) << "run clang-format -i on them (version 14 decides)\n" << result.text();
}

TEST(Format, DeviationsAreFound) {
    const TemporaryFolder folder;
    fs::copy_file(fs::path(QUINCUNX_SOURCE_DIR) / ".clang-format", folder / ".clang-format");
    EXPECT_EQ(
        checkFormat({folder.file("good.cpp", "int answer() {\n    return 42;\n}\n").string()}).exitStatus, 0);
    EXPECT_EQ(checkFormat({folder.file("bad.cpp", "int answer() {\n  return 42;\n}\n").string()}).exitStatus,
              1);
}

}  // namespace
}  // namespace quincunx
