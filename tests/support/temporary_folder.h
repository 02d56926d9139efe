#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace quincunx::test {

/// A new empty folder that is removed with everything in it at the end of the scope.
class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(std::string_view name) const { return path_ / name; }
    /// Writes a file of it, with the folders it is in; returns its path.
    std::filesystem::path file(std::string_view name, std::string_view contents) const;

  private:
    std::filesystem::path path_;
};

}  // namespace quincunx::test
