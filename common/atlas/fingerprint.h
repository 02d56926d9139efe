#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "lab/lab.h"

/// Whether something that was measured earlier would come out otherwise today.
namespace quincunx::atlas {

/// FNV-1a of 64 bits (Fowler, Noll, Vo: draft-eastlake-fnv). No protection from intent.
class Digest {
  public:
    /// Length and bytes, so that pieces do not run into one another.
    Digest& add(std::string_view text);
    std::uint64_t value() const { return value_; }
    std::string text() const;  ///< 16 hexadecimal digits

  private:
    std::uint64_t value_ = 0xcbf29ce484222325u;
};

/// What all figures and pictures of a lab follow from, but for the machine: its code and that of the rooms
/// below it, the shaders it may use, and its knobs. The code is the tree's sources, where the program was
/// made from them as they are now; where there are none, or one is younger than the program, it is the
/// program itself. Shaders of other labs, pages and their templates do not count.
std::string labFingerprint(const LabEntry& entry, Lab& lab);

/// The same with the places given: `root` holds common/, labs/ and shaders/ (the first two may be missing).
std::string labFingerprint(const std::string& folder, const KnobSet& knobs, const std::filesystem::path& root,
                           const std::filesystem::path& program);

}  // namespace quincunx::atlas
