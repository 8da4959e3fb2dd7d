// The directions in which light is gathered at a point, for integrals over the sphere: zenith angles in three
// zones, below the horizon, between it and the level, and above, each dense toward its edge at the horizon; and azimuths.
layout(binding = 6, std430) readonly buffer Zeniths { vec4 data[]; } zeniths;  // node and weight in [0, 1], zone

struct Zenith {
    float mu;
    float weight;  // of the integral over mu
    bool level_up;
};

Zenith zenith(int i, float altitude) {
    vec4 node = zeniths.data[i];
    float horizon = horizon_mu(altitude);
    float from = node.z < 1.0 ? horizon : node.z < 2.0 ? horizon : 0.0;
    float to = node.z < 1.0 ? -1.0 : node.z < 2.0 ? 0.0 : 1.0;
    return Zenith(mix(from, to, node.x * node.x), 2.0 * node.x * node.y * abs(to - from), node.z >= 2.0);
}

float azimuth(int i, int count) { return pi * (float(i) + 0.5) / float(count); }
