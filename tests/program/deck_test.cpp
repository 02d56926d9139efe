// The cards for Anki, read back as Anki's manual says a text file is read.

#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/program/program.h"

namespace quincunx::test {
namespace {

using testing::HasSubstr;
using testing::Not;

struct DeckFile {
    std::map<std::string, std::string> directives;
    std::vector<std::vector<std::string>> cards;
};

/// Header lines "#key:value", then CSV with quotes and the separator that the header names.
DeckFile readDeck(const std::filesystem::path& file) {
    std::ifstream stream(file);
    std::stringstream all;
    all << stream.rdbuf();
    std::string text = all.str();
    DeckFile deck;
    while (text.starts_with('#')) {
        const std::size_t end = text.find('\n');
        const std::size_t colon = text.find(':');
        deck.directives[text.substr(1, colon - 1)] = text.substr(colon + 1, end - colon - 1);
        text.erase(0, end + 1);
    }
    std::vector<std::string> row(1);
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"')
            row.back() += text[++i];
        else if (c == '"')
            quoted = !quoted;
        else if (!quoted && c == '\t')
            row.emplace_back();
        else if (!quoted && c == '\n') {
            deck.cards.push_back(row);
            row.assign(1, {});
        } else
            row.back() += c;
    }
    EXPECT_FALSE(quoted);
    EXPECT_EQ(row, std::vector<std::string>(1)) << "the last line ends";
    return deck;
}

class Deck : public Program {};

TEST_F(Deck, HoldsEveryQuestionOfTheLabWithItsAnswerFiguresAndPicture) {
    const ProcessResult result = call({"deck", "--labs", "rotations", "--out", "cards", "--json"});
    ASSERT_TRUE(succeeded(result));
    const nlohmann::json said = nlohmann::json::parse(result.out);
    const DeckFile deck = readDeck(folder_.path() / "cards/quincunx.txt");
    EXPECT_EQ(deck.directives.at("separator"), "tab");
    EXPECT_EQ(deck.directives.at("html"), "true");
    EXPECT_EQ(deck.directives.at("guid column"), "1");
    EXPECT_EQ(deck.directives.at("tags column"), "4");
    ASSERT_EQ(deck.cards.size(), 2U);
    EXPECT_EQ(said["cards"], 2);
    EXPECT_EQ(said["questions"], 118);
    std::set<std::string> identities;
    for (const std::vector<std::string>& card : deck.cards) {
        ASSERT_EQ(card.size(), 4U);
        identities.insert(card[0]);
        EXPECT_EQ(card[3], "quincunx::03_rotations");
        EXPECT_THAT(card[2], HasSubstr("<img src=\"quincunx_03_rotations.png\" alt=\""));
    }
    EXPECT_EQ(identities, (std::set<std::string>{"quincunx-075-03", "quincunx-104-03"}));
    EXPECT_TRUE(std::filesystem::is_regular_file(folder_.path() / "cards/quincunx_03_rotations.png"));

    const nlohmann::json asked = nlohmann::json::parse(call({"ask", "75", "--json"}).out);
    const auto card = std::find_if(deck.cards.begin(), deck.cards.end(),
                                   [](const auto& fields) { return fields[0] == "quincunx-075-03"; });
    ASSERT_NE(card, deck.cards.end());
    for (const nlohmann::json& measurement : asked["measurements"])
        EXPECT_THAT((*card)[2], HasSubstr("<tr><td>" + measurement["name"].get<std::string>() + "</td>"));
}

TEST_F(Deck, IsTheSameWhenMadeAgain) {
    const auto made = [&](const std::string& folder) {
        EXPECT_TRUE(succeeded(call({"deck", "--labs", "rotations", "--out", folder})));
        std::ifstream stream(folder_.path() / folder / "quincunx.txt");
        std::stringstream all;
        all << stream.rdbuf();
        return all.str();
    };
    EXPECT_EQ(made("a"), made("b"));
}

TEST_F(Deck, RefusesLabsThatThereAreNot) {
    EXPECT_TRUE(failedWith(call({"deck", "--labs", "rotations,alchemy"}), 2, "alchemy"));
    EXPECT_THAT(leftBehind(), testing::IsEmpty());
}

}  // namespace
}  // namespace quincunx::test
