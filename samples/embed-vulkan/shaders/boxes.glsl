// The scene, as samples/embed-vulkan/scene.hpp has it.
struct Box {
    vec4 center;
    vec4 half_size;
    vec4 color;
};
const int box_count = 7;
layout(std140, set = 0, binding = 0) uniform Boxes { Box boxes[box_count]; };

layout(push_constant) uniform Frame {
    mat4 matrix;      // clip from world, or for the composition world from clip
    vec4 toward_sun;  // w: 1 with indirect light
    vec4 sun;
    vec4 sky;
} frame;
