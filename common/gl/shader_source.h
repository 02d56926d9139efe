#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "gl/program.h"

/// How shader files become text; users of programs include gl/program.h.
namespace quincunx::gl::detail {

/// The file as it is now.
FileStamp stampOf(const std::filesystem::path& file);

/// As loadShader, and lists every file that was looked at (also when it throws) as it was just before.
ShaderSource loadShader(const std::filesystem::path& file,
                        const std::vector<std::pair<std::string, std::string>>& defines,
                        std::vector<FileStamp>& visited);

/// "shaders/passes/phong.frag" for a file under assetRoot()/shaders, else the whole path.
std::string displayName(const std::filesystem::path& file);

/// The identifiers in `text`, sorted, each once.
std::vector<std::string> identifiers(std::string_view text);

/// The first error of a log that authorsLog has treated, on one line, and how many more there are.
std::string firstError(std::string_view log);

}  // namespace quincunx::gl::detail
