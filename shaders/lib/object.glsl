// One placed mesh and its material. Laid out as struct ObjectBlock in common/passes/scene_buffers.h.

layout(std140) uniform ObjectBlock {
    mat4 worldFromModel;
    mat3 worldNormalFromModel;
    vec4 ambient;    // rgb: share of the ambient light sent back
    vec4 diffuse;    // rgb: Lambertian albedo; a: alpha below which a fragment is cut out, 0 for none
    vec4 specular;   // rgb: weight of the highlight; a: shininess
    vec4 emission;   // rgb: radiance; a: opacity
};

uniform sampler2D baseColorTexture;  // white where a material has none
