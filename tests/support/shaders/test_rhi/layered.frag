layout(location = 0) flat in int layer;
layout(location = 0) out vec4 result;

void main() { result = vec4(float(layer) + 1.0, gl_FragCoord.x, 0.0, 1.0); }
