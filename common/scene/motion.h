#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

/// What moves in a scene: frames that hang from each other, the keys that move them, and what hangs from
/// them. Plain data, as in glTF 2.0, sections 3.5.3 and 3.11. `pose` (scene/animation.h) puts it to use.
namespace quincunx {

/// A frame at rest. The translation acts last, the scale first.
struct Node {
    static constexpr std::size_t noParent = std::numeric_limits<std::size_t>::max();

    std::string name = {};
    std::size_t parent = noParent;   ///< index into Scene::nodes, less than the node's own
    glm::vec3 translation{0};        ///< in the parent's frame
    glm::quat rotation{1, 0, 0, 0};  ///< of any length but zero
    glm::vec3 scale{1};
    std::optional<glm::mat4> matrix = {};  ///< affine, in place of the three, for nodes that no channel moves
};

/// What goes where its node goes.
struct Attachment {
    enum class Thing { instance, light, camera };
    Thing thing = Thing::instance;
    std::size_t index = 0;       ///< into Scene::instances, lights or cameras
    std::size_t node = 0;        ///< index into Scene::nodes
    glm::mat4 nodeFromThing{1};  ///< affine; lights shine and cameras look along their −z
};

/// Keys, and what they move.
struct Animation {
    enum class Interpolation {
        step,        ///< a key's value until the next one
        linear,      ///< rotations: slerp by the shorter way
        cubicSpline  ///< Hermite; rotations are then made unit length
    };
    enum class Path { translation, rotation, scale };

    struct Sampler {
        Interpolation interpolation = Interpolation::linear;
        std::vector<float> seconds = {};  ///< of the keys: at least one, ≥ 0, ascending
        /// One a key, or three for cubicSpline: the tangent towards the key, the value, the tangent from it
        /// on. Translation and scale are in xyz; rotations are (x, y, z, w), of any length but zero.
        std::vector<glm::vec4> values = {};
    };
    struct Channel {
        std::size_t sampler = 0;  ///< index into the animation's samplers
        std::size_t node = 0;     ///< index into Scene::nodes, of one without a matrix
        Path path = Path::translation;
        bool operator==(const Channel&) const = default;
    };

    std::string name = {};
    std::vector<Sampler> samplers = {};
    std::vector<Channel> channels = {};
};

}  // namespace quincunx
