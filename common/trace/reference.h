#pragma once

#include <atomic>

#include <glm/glm.hpp>

#include "image/image.h"
#include "scene/still_life.h"
#include "trace/trace_scene.h"

namespace quincunx {

/// Which terms of the local reflection model are added.
///
/// L = emission + ambient ⊙ ambientLight ⊙ base
///     + Σ over lights of E ⊙ (diffuse ⊙ base · max(0, n·l) + specular · s)
///
/// with n the unit normal out of the solid, l the unit vector towards the light, v the one towards the eye,
/// base the texture's colour (1 without one), and s = 0 unless n·l > 0, else, with shininess k,
///   Phong:       s = max(0, r·v)^k,  r = 2 (n·l) n - l       (Phong 1975)
///   Blinn–Phong: s = max(0, n·h)^k,  h = (l + v) / |l + v|   (Blinn 1977); 0 where l = -v
/// where x^0 = 1 for every x, 0 included. E = color · intensity for a directional light; a point light's is
/// divided by the squared distance, a spot's also multiplied with its cone (see shaders/lib/phong.glsl).
/// As intensities are divided by π (scene.h), there is no π here. With `shadows`, E is 0 where something lies
/// between the point and the light.
struct PhongModel {
    enum class Reflection { phong, blinnPhong };
    Reflection reflection = Reflection::phong;
    bool ambient = true;
    bool diffuse = true;
    bool specular = true;
    bool emission = true;
    bool shadows = false;
};

/// The picture that shading per pixel tends to: one ray through each pixel's centre, nearest hit between the
/// camera's near and far planes, and the model's formulas written plainly in double. Surfaces of materials
/// that are not double-sided are seen from their front only, but throw shadows from both sides; of solids in
/// closed form the inside is seen too. Where double-sided ones are seen from behind, their normals are turned
/// around. Pixels without a hit get mix(backgroundBottom, backgroundTop, (height - y - ½) / height). The
/// result is RGBA (A = 1), linear, and the same on any number of threads. When `stop` becomes true, the
/// remaining rows are left at zero.
Image traceReference(const TraceScene& scene, const Camera& camera, int width, int height,
                     const PhongModel& model = {}, const std::atomic<bool>* stop = nullptr);

/// Which pixels see a point that a light reaches: 1 if the surface faces it and nothing lies between, 0 if
/// not, −1 where there is no surface. The same rays as `traceReference`; one channel.
Image traceLitMask(const TraceScene& scene, const Camera& camera, int width, int height, std::size_t light,
                   const std::atomic<bool>* stop = nullptr);

/// All placed anew by `worldFromWorld`, any affine map: it may shear, scale and mirror. Lights, cameras and
/// what moves stay as they are. What the map flattens is not drawn.
StillLife placedBy(StillLife stillLife, const glm::mat4& worldFromWorld);
Scene placedBy(Scene scene, const glm::mat4& worldFromWorld);

}  // namespace quincunx
