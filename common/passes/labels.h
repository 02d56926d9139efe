#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gl/executor.h"

namespace quincunx {

/// Text in a picture: names of panels, coordinates, legends. UTF-8: Latin, Greek, arrows, mathematical
/// operators, super- and subscripts. A line feed starts a new line.
class Labels {
  public:
    Labels();
    ~Labels();
    Labels(Labels&&) noexcept;
    Labels& operator=(Labels&&) noexcept;

    /// Which point of the text lies at its position.
    enum class Anchor { topLeft, topRight, bottomLeft, bottomRight, center, topCenter, bottomCenter };
    struct Style {
        float sizePixels = 16;          ///< height of a line, of the target; 4 … 128, rounded
        glm::vec4 color{1};             ///< linear RGB, not multiplied with the opacity in a
        glm::vec4 backing{0, 0, 0, 0};  ///< a plate behind the text; opacity 0: none
        Anchor anchor = Anchor::topLeft;
    };

    void clear();
    /// `positionPixels`: from the top left of the viewport, y down.
    void text(std::string words, glm::vec2 positionPixels, const Style& style);
    /// A filled rectangle, for legends.
    void plate(glm::vec2 topLeftPixels, glm::vec2 sizePixels, glm::vec4 color);

    /// Width and height in pixels that the text would take.
    glm::vec2 extent(const std::string& words, float sizePixels);

    /// Into the bound target, over what is there, in the order of adding. `viewportPixels`: the size of the
    /// viewport that is set. EnvironmentError if the typeface is not installed.
    void draw(graph::PassContext& context, glm::vec2 viewportPixels);

  private:
    struct Font;
    struct Item {
        std::string words;  ///< empty: a plate
        glm::vec2 position;
        glm::vec2 size;
        Style style;
    };
    struct Device;
    Font& font(float sizePixels);

    std::vector<Item> items_;
    std::map<int, std::unique_ptr<Font>> fonts_;  ///< by size in pixels
    std::unique_ptr<Device> device_;
};

/// Where a point of the world is seen, in pixels from the viewport's top left, y down; none if it is before
/// the near plane or behind the eye.
std::optional<glm::vec2> pixelOf(glm::vec3 world, const glm::mat4& clipFromWorld, glm::vec2 viewportPixels);

}  // namespace quincunx
