// The placements of the instances that one call draws. Laid out as MaterialPass::InstanceBlock in
// common/passes/material.h.

const int maxInstances = 128;

struct Instance {
    mat4 worldFromModel;
    mat3 worldNormalFromModel;  // the cofactor matrix
    vec4 padding;
};

layout(std140) uniform InstanceBlock {
    Instance instances[maxInstances];
};
