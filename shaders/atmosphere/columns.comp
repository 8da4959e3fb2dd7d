// Makes the table of columns, each by quadrature in single precision.
const int atmosphere_binding = 0;
#include "atmosphere/air.glsl"
#include "atmosphere/column_shape.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 1, rgba32f) writeonly uniform image2D columns;

// The distance at which a ray that rises reaches an altitude, or leaves the air.
float to_altitude(RayPoint low, float altitude) {
    float b = radius_at(low.altitude) * low.mu;
    float end = min(altitude, air.height);
    float change = (end - low.altitude) * (2.0 * air.radius_ground + low.altitude + end);
    return change > 0.0 ? change / (b + sqrt(b * b + change)) : 0.0;
}

float rise(RayPoint low, float distance) {
    float r = radius_at(low.altitude);
    float change = distance * (distance + 2.0 * r * low.mu);
    return change / (r + sqrt(r * r + change));
}

// In pieces of altitude that double: where the ray is steep the integrand is exp(-x), where it is level exp(-x²).
// Over the scale height and the density at the point.
float exponential(RayPoint low, float scale_height) {
    float sum = 0.0;
    float begin = 0.0;
    float scales = 1.0;
    for (int piece = 0; piece < 5; ++piece) {
        float end = to_altitude(low, low.altitude + scales * scale_height);
        for (int i = 0; i < air.nodes; ++i) {
            vec2 node = quadrature_node(i);
            sum += node.y * (end - begin) * exp(-rise(low, mix(begin, end, node.x)) / scale_height);
        }
        begin = end;
        scales = 2.0 * scales + 1.0;
    }
    return sum / scale_height;
}

float ozone(RayPoint low) {
    float sum = 0.0;
    float begin = to_altitude(low, air.ozone.x);
    for (int piece = 0; piece < 2; ++piece) {
        float end = to_altitude(low, piece == 0 ? air.ozone.y : air.ozone.z);
        for (int i = 0; i < air.nodes; ++i) {
            vec2 node = quadrature_node(i);
            float altitude = low.altitude + rise(low, mix(begin, end, node.x));
            sum += node.y * (end - begin) * ozone_density(altitude);
        }
        begin = end;
    }
    return sum;
}

void main() {
    ivec2 size = imageSize(columns);
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, size))) return;
    vec2 place = vec2(texel) / vec2(size - 1);
    RayPoint low = RayPoint(air.height * place.y, column_mu(place.x));
    vec3 sum = vec3(exponential(low, air.scale_heights.x), exponential(low, air.scale_heights.y), ozone(low));
    imageStore(columns, texel, vec4(sum / column_flat(low.mu), 0));
}
