#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace quincunx::test {

/// Calls the built program in an empty folder, on a machine without a display.
class Program : public testing::Test {
  protected:
    /// The program's file and these words.
    static std::vector<std::string> command(std::vector<std::string> words);
    /// `environment` is added to that of the test.
    ProcessResult call(std::vector<std::string> words, std::vector<std::string> environment = {}) const;
    /// Calls through `sh -c script`, where "$@" is the program with its words.
    ProcessResult callInShell(const std::string& script, std::vector<std::string> words) const;
    ProcessOptions options(std::vector<std::string> environment = {}) const;

    /// Names of all files and folders in the folder, at any depth.
    std::vector<std::string> leftBehind() const;

    TemporaryFolder folder_;
};

/// Small pictures, drawn without a device.
std::vector<std::string> drawingSmall(std::vector<std::string> words);

/// Succeeds if the program ended with `status`, said nothing on stdout, and on stderr one line that names it,
/// holds `part`, and has no control characters.
testing::AssertionResult failedWith(const ProcessResult& result, int status, const std::string& part = {});
testing::AssertionResult succeeded(const ProcessResult& result);

}  // namespace quincunx::test
