#pragma once

#include <filesystem>
#include <string>

namespace quincunx::test {

/// A copy of the shaders in which one place is broken; assets come from it while this lives.
class BrokenShaders {
  public:
    /// Replaces the first `from` of a file under shaders/ by `to`.
    BrokenShaders(const std::string& file, const std::string& from, const std::string& to);
    ~BrokenShaders();
    BrokenShaders(const BrokenShaders&) = delete;
    BrokenShaders& operator=(const BrokenShaders&) = delete;
    /// False if the file no longer holds what was to be broken.
    bool found() const { return found_; }

  private:
    std::filesystem::path root_;
    bool found_ = false;
};

}  // namespace quincunx::test
