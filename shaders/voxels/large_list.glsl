// Triangles that are left to groups. Per draw: the groups of an indirect dispatch, and how many triangles its part of
// the list holds. The includer defines LARGE_ARGUMENTS, LARGE_LIST and the qualifier LARGE_ACCESS.
const uint max_large_groups = 65535u;

struct LargeArguments {
    uint groups_x;
    uint groups_y;
    uint groups_z;
    uint count;
};

layout(binding = LARGE_ARGUMENTS, std430) LARGE_ACCESS buffer Arguments {
    LargeArguments data[];
} large_arguments;
