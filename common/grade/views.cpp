#include "grade/views.h"

#include <glm/gtc/matrix_transform.hpp>

#include "scene/import.h"

namespace quincunx::grade {
namespace {

constexpr int viewWidth = 200;
constexpr int viewHeight = 150;

void set(KnobSet& knobs, const KnobValues& values) {
    for (const auto& [name, value] : values)
        knobs.find(name).parse(value);
}

KnobValues over(KnobValues values, const KnobValues& others) {
    values.insert(values.end(), others.begin(), others.end());
    return values;
}

}  // namespace

Camera turnedAbout(const Camera& camera, const glm::vec3& centre, float aboutUp, float upwards) {
    const glm::vec3 right(camera.worldFromCamera[0]);
    glm::mat4 turn(1);
    turn = glm::translate(turn, centre);
    turn = glm::rotate(turn, aboutUp, {0, 1, 0});
    turn = glm::rotate(turn, upwards, right);
    turn = glm::translate(turn, -centre);
    Camera turned = camera;
    turned.worldFromCamera = turn * camera.worldFromCamera;
    return turned;
}

std::vector<View> unseenViews(const Lab& lab, const Exercise& exercise, const Rubric& rubric) {
    const float aspect = static_cast<float>(viewWidth) / viewHeight;
    const auto viewWith = [&](const KnobValues& knobs, float aboutUp, float upwards) {
        View view;
        view.knobs = over(over(rubric.knobs, exercise.shaderKnobs), knobs);
        view.frame.width = viewWidth;
        view.frame.height = viewHeight;
        const Bounds bounds = lab.sceneBounds();
        view.frame.camera = turnedAbout(fittedToAspect(lab.defaultCamera(), aspect),
                                        0.5F * (bounds.min + bounds.max), aboutUp, upwards);
        return view;
    };
    // Angles that nobody chooses, small enough for what is in front of the camera to stay there.
    std::vector<View> views = {viewWith({}, 0, 0), viewWith({}, 0.31F, -0.07F), viewWith({}, -0.43F, -0.12F)};
    for (const KnobValues& knobs : exercise.scenes)
        views.push_back(viewWith(knobs, 0.17F, -0.05F));
    return views;
}

Image8 drawView(Studio& studio, Lab& lab, const View& view) {
    const KnobScope scope(lab.knobs());
    set(lab.knobs(), view.knobs);
    return studio.picture(lab, view.frame);
}

}  // namespace quincunx::grade
