#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "tests/program/program.h"

namespace quincunx::test {
namespace {

namespace fs = std::filesystem;

class Checkpoints : public Program {
  protected:
    std::vector<std::string> words(const std::string& picture, const std::string& checkpoint) const {
        std::vector<std::string> words{"run",   "path_tracing", "--backend", "osmesa",      "--size",
                                       "40x30", "--samples",    "240",       "--terms=off", "--out",
                                       picture, "--checkpoint", checkpoint};
        return words;
    }
    std::string contents(const std::string& name) const {
        std::ifstream file(folder_ / name, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
};

TEST_F(Checkpoints, SurviveAKillAndGiveTheSamePictureBitForBit) {
    EXPECT_TRUE(succeeded(call(words("whole.png", "whole.checkpoint"))));
    for (const int signal : {SIGKILL, SIGTERM}) {
        const std::string name = signal == SIGKILL ? "killed" : "stopped";
        const fs::path checkpoint = folder_ / (name + ".checkpoint");
        {
            Process process(command(words(name + ".png", name + ".checkpoint")), options());
            while (!fs::exists(checkpoint) && fs::exists(folder_.path()) && ::kill(process.id(), 0) == 0)
                std::this_thread::sleep_for(std::chrono::milliseconds(2));
            process.signal(signal);
            const ProcessResult result = process.wait();
            EXPECT_NE(result.exitStatus, 0) << result.text();
        }
        ASSERT_TRUE(fs::exists(checkpoint));
        EXPECT_FALSE(fs::exists(folder_ / (name + ".png"))) << "it was stopped before its end";
        EXPECT_TRUE(succeeded(call(words(name + ".png", name + ".checkpoint"))));
        EXPECT_EQ(contents(name + ".checkpoint"), contents("whole.checkpoint")) << name;
    }
}

TEST_F(Checkpoints, OfAnotherPictureAreRefused) {
    EXPECT_TRUE(succeeded(call({"run", "path_tracing", "--backend", "osmesa", "--size", "8x6", "--samples",
                                "2", "--out", "a.png", "--checkpoint", "a.checkpoint"})));
    EXPECT_TRUE(failedWith(call({"run", "path_tracing", "--backend", "osmesa", "--size", "8x6", "--samples",
                                 "2", "--seed", "2", "--out", "a.png", "--checkpoint", "a.checkpoint"}),
                           2, "the checkpoint of another picture"));
}

}  // namespace
}  // namespace quincunx::test
