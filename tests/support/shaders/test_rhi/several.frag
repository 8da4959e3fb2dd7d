// What a fragment knows of itself, into targets of three kinds.
layout(location = 0) out vec4 where;
layout(location = 1) out uvec4 which;
layout(location = 2) out vec4 facing;

void main() {
    where = gl_FragCoord;
    which = uvec4(uint(gl_FragCoord.x) + 100u * uint(gl_FragCoord.y), uint(gl_PrimitiveID), 0u, 0xffffffffu);
    facing = gl_FrontFacing ? vec4(0.0, 1.0, 0.0, 1.0) : vec4(1.0, 0.0, 0.0, 1.0);
}
