#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "lab/lab.h"

namespace quincunx {

/// All that a picture was made from: with it the same driver draws the same picture again, bit for bit. It is
/// written into the metadata of every PNG and by `run --record`, and read by `run --replay`.
struct PictureState {
    std::string lab;                     ///< folder name, "10_shading"
    std::string model;                   ///< file given with --model; empty: the lab's own scene
    std::uint64_t modelFingerprint = 0;  ///< of that file's scene (scene/fingerprint.h); 0: not known
    std::string renderer;                ///< what drew it; not needed to draw it again
    KnobValues knobs;
    Frame frame;
};

/// The key of the PNG text entry that holds a state.
inline constexpr std::string_view pictureStateKey = "quincunx";

std::string toJson(const PictureState& state);

/// The inverse of toJson. `where` names the source in errors. InputError when it is no such text, or when
/// sizes, cameras or seeds make no sense.
PictureState parsePictureState(std::string_view json, std::string_view where);

/// From a file that `--record` wrote, or from the metadata of a picture.
PictureState readPictureState(const std::filesystem::path& file);

/// The largest picture side that is accepted, in pixels.
inline constexpr int maxPictureSide = 16384;

}  // namespace quincunx
