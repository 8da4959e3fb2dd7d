// Every triangle into every layer.
layout(triangles) in;
layout(triangle_strip, max_vertices = 18) out;
layout(push_constant) uniform Push { int layers; } push;

layout(location = 0) flat out int layer;

void main() {
    for (int i = 0; i < push.layers; ++i) {
        for (int corner = 0; corner < 3; ++corner) {
            gl_Layer = i;
            layer = i;
            gl_Position = gl_in[corner].gl_Position;
            EmitVertex();
        }
        EndPrimitive();
    }
}
