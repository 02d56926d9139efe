#include "tests/program/program.h"

#include <algorithm>

namespace quincunx::test {
namespace fs = std::filesystem;

std::vector<std::string> Program::command(std::vector<std::string> words) {
    words.insert(words.begin(), QUINCUNX_PROGRAM);
    return words;
}

ProcessOptions Program::options(std::vector<std::string> environment) const {
    environment.insert(environment.end(), {"DISPLAY=", "WAYLAND_DISPLAY="});
    return {.folder = folder_.path(), .environment = std::move(environment), .out = {}};
}

ProcessResult Program::call(std::vector<std::string> words, std::vector<std::string> environment) const {
    return runProcess(command(std::move(words)), options(std::move(environment)));
}

ProcessResult Program::callInShell(const std::string& script, std::vector<std::string> words) const {
    words = command(std::move(words));
    words.insert(words.begin(), {"sh", "-c", script, "sh"});
    return runProcess(std::move(words), options());
}

std::vector<std::string> Program::leftBehind() const {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_.path()))
        names.push_back(entry.path().lexically_relative(folder_.path()).generic_string());
    std::sort(names.begin(), names.end());
    return names;
}

std::vector<std::string> drawingSmall(std::vector<std::string> words) {
    words.insert(words.end(), {"--size", "32x24", "--backend", "osmesa"});
    return words;
}

testing::AssertionResult failedWith(const ProcessResult& result, int status, const std::string& part) {
    const auto failure = [&](const char* reason) {
        return testing::AssertionFailure() << reason << '\n' << result.text();
    };
    if (result.exitStatus != status)
        return failure("another exit status");
    if (!result.out.empty())
        return failure("something on stdout");
    if (result.err.rfind("quincunx: ", 0) != 0 ||
        std::find(result.err.begin(), result.err.end(), '\n') != std::prev(result.err.end()))
        return failure("not one line that names the program");
    if (std::any_of(result.err.begin(), std::prev(result.err.end()),
                    [](char c) { return static_cast<unsigned char>(c) < 0x20; }))
        return failure("control characters");
    if (result.err.find(part) == std::string::npos)
        return testing::AssertionFailure() << "no \"" << part << "\" in it\n" << result.text();
    return testing::AssertionSuccess();
}

testing::AssertionResult succeeded(const ProcessResult& result) {
    if (result.exitStatus == 0 && result.err.empty())
        return testing::AssertionSuccess();
    return testing::AssertionFailure() << result.text();
}

}  // namespace quincunx::test
