// What the READMEs say of the labs is what the program says.

#include <filesystem>
#include <regex>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "tests/program/program.h"

namespace quincunx::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uintmax_t mostBytes = 1 << 20;

class Readmes : public Program {
  protected:
    json labs() const { return json::parse(call({"list", "--json"}).out); }
    fs::path root_ = QUINCUNX_SOURCE_DIR;
};

TEST_F(Readmes, TheTableOfLabsIsTheList) {
    const std::string readme = readFile(root_ / "README.md", mostBytes);
    std::string table;
    for (const json& lab : labs()) {
        const std::string folder = lab["lab"];
        std::string questions;
        for (const int number : lab["questions"])
            questions += (questions.empty() ? "" : ", ") + std::to_string(number);
        table += "| [" + folder + "](labs/" + folder + "/README.md) | " + lab["topic"].get<std::string>() +
                 " | " + questions + " |\n";
    }
    EXPECT_NE(readme.find(table), std::string::npos) << "README.md should hold:\n" << table;
    // And nothing else that looks like a row.
    const std::regex row("\\| \\[[0-9]{2}_[a-z_]+\\]\\(");
    EXPECT_EQ(std::distance(std::sregex_iterator(readme.begin(), readme.end(), row), std::sregex_iterator()),
              static_cast<std::ptrdiff_t>(labs().size()));
}

TEST_F(Readmes, EveryLabTellsItsQuestionsAndShowsAPicture) {
    for (const json& lab : labs()) {
        const fs::path folder = root_ / "labs" / lab["lab"].get<std::string>();
        const std::string readme = readFile(folder / "README.md", mostBytes);
        for (const int number : lab["questions"])
            EXPECT_NE(readme.find("\n| " + std::to_string(number) + " |"), std::string::npos)
                << folder << ": question " << number << " has no row";
        EXPECT_NE(readme.find("]("), std::string::npos) << folder;
        EXPECT_NE(readme.find("!["), std::string::npos) << folder << " has no picture";
    }
}

TEST_F(Readmes, LinksLeadSomewhere) {
    std::vector<fs::path> files = {root_ / "README.md", root_ / "CONTRIBUTING.md", root_ / "data/SOURCES.md"};
    for (const json& lab : labs())
        files.push_back(root_ / "labs" / lab["lab"].get<std::string>() / "README.md");
    const std::regex link("\\]\\(([^)#:]+)\\)");
    for (const fs::path& file : files) {
        const std::string text = readFile(file, mostBytes);
        for (std::sregex_iterator found(text.begin(), text.end(), link), end; found != end; ++found)
            EXPECT_TRUE(fs::exists(file.parent_path() / found->str(1))) << file << ": " << found->str(1);
    }
}

}  // namespace
}  // namespace quincunx::test
