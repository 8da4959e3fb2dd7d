// The layers of the tables from the light that arrives: a weighted sum over zenith angles for each.
layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
    ivec2 size;  // of the tables: suns, altitudes
    int first_row;
    int rows;
    int first_layer;
    int layers;      // that follow
    int all_layers;
    int zeniths;
    int degree;
    int directions;  // layers of each degree of what aerosols send on
    int add;         // 1: to what the sum has of other orders
} push;

layout(binding = 0, std430) readonly buffer Rings { vec4 data[]; } rings;
layout(binding = 1, std430) readonly buffer Weights { float data[]; } weights;  // zeniths are adjacent, then layers, then rows
layout(binding = 2, rgba32f) writeonly uniform image2DArray light;
layout(binding = 3, rgba32f) LUMO_READ_WRITE uniform image2DArray sum;

const int first_aerosol_layer = 5;

int degree_of(int layer) {
    if (layer >= first_aerosol_layer) return (layer - first_aerosol_layer) / push.directions;
    return layer == 2 ? 1 : layer == 3 ? 2 : 0;
}

void main() {
    int i = int(gl_GlobalInvocationID.x);
    int texels = push.size.x * push.rows;
    if (i >= texels * push.layers) return;
    int texel = i % texels;
    int layer = push.first_layer + i / texels;
    ivec3 place = ivec3(texel % push.size.x, push.first_row + texel / push.size.x, layer);
    int weight = (place.y * push.all_layers + layer) * push.zeniths;
    int ring = texel * push.zeniths * (push.degree + 1) + degree_of(layer);
    vec4 value = vec4(0);
    for (int j = 0; j < push.zeniths; ++j)
        value += weights.data[weight + j] * rings.data[ring + j * (push.degree + 1)];
    imageStore(light, place, value);
    imageStore(sum, place, push.add == 1 ? imageLoad(sum, place) + value : value);
}
