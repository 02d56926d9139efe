#pragma once

#include <filesystem>
#include <string_view>

namespace quincunx {

/// The folder that holds `shaders/` and `data/`. In order: the environment variable QUINCUNX_ROOT, the source
/// tree the program was built from, `share/quincunx` beside an installed program. Throws EnvironmentError if
/// none of them has the folder `shaders`.
std::filesystem::path assetRoot();

/// `assetRoot() / relative`; throws EnvironmentError if it does not exist.
std::filesystem::path asset(std::string_view relative);

/// The typeface of panels and of labels in pictures (DejaVu Sans). Throws EnvironmentError if it is not
/// installed.
std::filesystem::path typefaceFile();

/// The running program's own file.
std::filesystem::path executablePath();

}  // namespace quincunx
