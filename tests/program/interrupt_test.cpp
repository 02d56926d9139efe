// Ctrl-C at any moment: exit status 130, one line, and no file that is not whole.

#include <algorithm>
#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/file.h"
#include "tests/program/program.h"

namespace quincunx::test {
namespace {

using std::chrono::milliseconds;

class ProgramInterrupted : public Program {
  protected:
    /// Sends `signal` that long after the start.
    ProcessResult callAndStop(std::vector<std::string> words, milliseconds after, int signal = SIGINT) const {
        Process process(command(std::move(words)), options());
        std::this_thread::sleep_for(after);
        process.signal(signal);
        return process.wait();
    }
    /// Names that are not those of finished pictures and tables.
    std::vector<std::string> temporaryFiles() const {
        std::vector<std::string> names = leftBehind();
        std::erase_if(names, [](const std::string& name) {
            return name.find("/.") == std::string::npos && name.front() != '.';
        });
        return names;
    }
};

// Early enough that none of the three can be done: they take seconds, and the signal comes after 0.3.
TEST_F(ProgramInterrupted, LongWorkStopsWithStatus130AndOneLine) {
    const std::vector<std::vector<std::string>> longWork = {
        {"stress", "shading", "--full"},
        {"sweep", "shading", "--backend", "osmesa"},
        {"run", "shading", "--backend", "osmesa", "--size", "8000x8000", "--supersample", "1", "--out",
         "picture.png"}};
    for (const auto& words : longWork)
        for (const int signal : {SIGINT, SIGTERM}) {
            EXPECT_TRUE(failedWith(callAndStop(words, milliseconds(300), signal), 130, "interrupted"))
                << words.front();
            EXPECT_THAT(leftBehind(), testing::Not(testing::Contains("picture.png")));
            EXPECT_THAT(temporaryFiles(), testing::IsEmpty());
        }
}

TEST_F(ProgramInterrupted, APictureIsWholeOrAbsentWheneverTheSignalComes) {
    const std::vector<std::string> words = {"run",    "shading", "--backend", "osmesa",
                                            "--size", "320x240", "--out",     "picture.png"};
    for (int after = 0; after <= 600; after += 100) {
        std::filesystem::remove(folder_ / "picture.png");
        const ProcessResult result = callAndStop(words, milliseconds(after));
        // Before the program is ready to hear it, the signal ends it as it ends any program.
        EXPECT_TRUE(result.exitStatus == 0 || result.exitStatus == 130 || result.signal == SIGINT)
            << result.text();
        EXPECT_THAT(temporaryFiles(), testing::IsEmpty());
        const bool drawn = std::filesystem::exists(folder_ / "picture.png");
        EXPECT_EQ(drawn, result.exitStatus == 0) << result.text();
        if (drawn) {
            EXPECT_TRUE(succeeded(call({"compare", "picture.png", "picture.png"}))) << after;
        }
    }
}

TEST_F(ProgramInterrupted, ASecondSignalEndsItAtOnce) {
    Process process(command({"stress", "shading", "--full"}), options());
    std::this_thread::sleep_for(milliseconds(300));
    process.signal(SIGINT);
    process.signal(SIGINT);
    const ProcessResult result = process.wait();
    EXPECT_TRUE(result.signal == SIGINT || result.exitStatus == 130) << result.text();
}

}  // namespace
}  // namespace quincunx::test
