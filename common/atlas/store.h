#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lab/json.h"

namespace quincunx::atlas {

/// A result with the names of the pictures written beside it.
struct Piece {
    Json result;
    std::vector<std::string> files;  ///< relative to the store's folder
};

/// Results on disk, each a file data/NAME.json with what it was made of. A piece is there whole or not at
/// all: its pictures are written before the file that names them. What an interrupted call has finished, the
/// next one finds.
class Store {
  public:
    explicit Store(std::filesystem::path folder) : folder_(std::move(folder)) {}

    const std::filesystem::path& folder() const { return folder_; }
    /// Whether the piece is there, with all its files, and was made of the same.
    bool has(const std::string& name, const std::string& madeOf) const;
    /// The piece as it is there; `make` makes it if it is not. `make` writes its files into the folder
    /// itself. A file that cannot be understood is as one that is missing.
    Json get(const std::string& name, const std::string& madeOf, const std::function<Piece()>& make);
    /// How many pieces `get` has had to make.
    int made() const { return made_; }

  private:
    std::filesystem::path fileOf(const std::string& name) const;
    bool read(const std::string& name, const std::string& madeOf, Json& result) const;

    std::filesystem::path folder_;
    int made_ = 0;
};

}  // namespace quincunx::atlas
