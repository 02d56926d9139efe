#include "lab/picture_state.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "image/io.h"

namespace quincunx {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uintmax_t maxStateBytes = 1 << 20;

Json toJson(const Camera& camera) {
    Json columns = Json::array();
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            columns.push_back(camera.worldFromCamera[column][row]);
    // JSON has no infinity: a camera without a far plane leaves the far distance out.
    Json json{
        {"world_from_camera", columns}, {"fov_y_radians", camera.fovYRadians}, {"near", camera.nearDistance}};
    if (std::isfinite(camera.farDistance))
        json["far"] = camera.farDistance;
    return json;
}

Camera parseCamera(const Json& json) {
    Camera camera;
    const Json& columns = json.at("world_from_camera");
    if (!columns.is_array() || columns.size() != 16)
        throw InputError("world_from_camera is not a list of 16 numbers");
    for (int i = 0; i < 16; ++i)
        camera.worldFromCamera[i / 4][i % 4] = columns[static_cast<std::size_t>(i)].get<float>();
    camera.fovYRadians = json.at("fov_y_radians").get<float>();
    camera.nearDistance = json.at("near").get<float>();
    camera.farDistance = json.value("far", std::numeric_limits<float>::infinity());
    const bool sane = camera.fovYRadians > 0 && camera.fovYRadians < 3.14159f && camera.nearDistance > 0 &&
                      camera.farDistance > camera.nearDistance;
    if (!sane)
        throw InputError("the camera's angle or distances make no sense");
    return camera;
}

}  // namespace

std::string toJson(const PictureState& state) {
    Json knobs = Json::object();
    for (const auto& [name, value] : state.knobs)
        knobs[name] = value;
    const Json json{{"lab", state.lab},
                    {"model", state.model},
                    {"renderer", state.renderer},
                    {"width", state.frame.width},
                    {"height", state.frame.height},
                    {"time_seconds", state.frame.timeSeconds},
                    {"seed", state.frame.seed},
                    {"camera", toJson(state.frame.camera)},
                    {"knobs", knobs}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

PictureState parsePictureState(std::string_view text, std::string_view where) {
    try {
        const Json json = Json::parse(text);
        PictureState state;
        state.lab = json.at("lab").get<std::string>();
        state.model = json.value("model", "");
        state.renderer = json.value("renderer", "");
        state.frame.width = json.at("width").get<int>();
        state.frame.height = json.at("height").get<int>();
        state.frame.timeSeconds = json.value("time_seconds", 0.0);
        state.frame.seed = json.value("seed", std::uint64_t{1});
        state.frame.camera = parseCamera(json.at("camera"));
        for (const auto& [name, value] : json.at("knobs").items())
            state.knobs.emplace_back(name, value.get<std::string>());
        const auto sane = [](int side) { return side >= 1 && side <= maxPictureSide; };
        if (!sane(state.frame.width) || !sane(state.frame.height) || !std::isfinite(state.frame.timeSeconds))
            throw InputError("the picture's size or time makes no sense");
        return state;
    } catch (const Json::exception& e) {
        throw InputError(fmt::format("is no record of a picture ({})", printable(e.what(), 120)), where,
                         "make one with run --record FILE");
    } catch (const InputError& e) {
        throw InputError(e.what(), where, "make a new one with run --record FILE");
    }
}

PictureState readPictureState(const std::filesystem::path& file) {
    if (file.extension() == ".png" || file.extension() == ".exr") {
        for (const auto& [key, value] : readMetadata(file))
            if (key == pictureStateKey)
                return parsePictureState(value, file.string());
        throw InputError("the picture holds no record of how it was made", file.string(),
                         "name a PNG that this program wrote, or a file from run --record");
    }
    return parsePictureState(readFile(file, maxStateBytes), file.string());
}

}  // namespace quincunx
