// Results on disk: whole or not there, and made again only when what they were made of has changed.

#include "atlas/store.h"

#include <filesystem>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "base/file.h"
#include "tests/support/temporary_folder.h"

namespace quincunx::atlas {
namespace {

namespace fs = std::filesystem;

class Stored : public testing::Test {
  protected:
    Json get(Store& store, const std::string& madeOf) {
        return store.get("piece", madeOf, [&] {
            ++calls_;
            writeFile(folder_ / "a.jpg", "picture");
            return Piece{{{"call", calls_}, {"infinite", std::numeric_limits<double>::infinity()}},
                         {"a.jpg"}};
        });
    }
    const test::TemporaryFolder folder_;
    int calls_ = 0;
};

TEST_F(Stored, PiecesAreMadeOnceAlsoAcrossCalls) {
    Store first(folder_.path());
    EXPECT_FALSE(first.has("piece", "x"));
    const Json made = get(first, "x");
    EXPECT_TRUE(made["infinite"].is_null()) << "the first reader sees what later ones will";
    EXPECT_EQ(first.made(), 1);
    Store second(folder_.path());
    EXPECT_TRUE(second.has("piece", "x"));
    EXPECT_EQ(get(second, "x"), made);
    EXPECT_EQ(second.made(), 0);
    EXPECT_EQ(calls_, 1);
}

TEST_F(Stored, PiecesAreMadeAgainOfSomethingElse) {
    Store store(folder_.path());
    get(store, "x");
    EXPECT_EQ(get(store, "y")["call"], 2);
    EXPECT_FALSE(store.has("piece", "x"));
}

TEST_F(Stored, PiecesAreMadeAgainWhereAPictureIsMissingOrTheFileIsSpoilt) {
    Store store(folder_.path());
    get(store, "x");
    fs::remove(folder_ / "a.jpg");
    EXPECT_EQ(get(store, "x")["call"], 2);
    int calls = 2;
    for (const char* spoilt :
         {"", "{", "[]", "{\"made_of\":\"x\"}", "{\"made_of\":7,\"files\":[],\"result\":1}",
          "{\"made_of\":\"x\",\"files\":[\"../../etc/passwd\"],\"result\":1}",
          "{\"made_of\":\"x\",\"files\":[\"/etc/passwd\"],\"result\":1}",
          "{\"made_of\":\"x\",\"files\":7,\"result\":1}"}) {
        writeFile(folder_ / "data/piece.json", spoilt);
        EXPECT_EQ(get(store, "x")["call"], ++calls) << spoilt;
    }
}

TEST_F(Stored, NothingIsLeftOfAPieceThatCouldNotBeMade) {
    Store store(folder_.path());
    EXPECT_THROW(store.get("piece", "x", []() -> Piece { throw std::runtime_error("stopped"); }),
                 std::runtime_error);
    EXPECT_FALSE(store.has("piece", "x"));
    EXPECT_EQ(get(store, "x")["call"], 1);
}

}  // namespace
}  // namespace quincunx::atlas
