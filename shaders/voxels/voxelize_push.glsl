layout(push_constant) uniform Push {
    vec3 grid_origin;         // world position of the grid's corner, metres
    float voxels_per_metre;
    uint resolution;          // voxels a side
    uint first_index;
    uint first_instance;
    float emission_scale;     // stored emission = radiance * emission_scale, for 0 to 1
    uint triangles;           // of an instance
    uint instances;
    uint draw;                // where this draw has its arguments and its part of the list of large triangles
    uint first_large;
    uint subtract;            // 1: sums of integers lose what they were given
} push;
