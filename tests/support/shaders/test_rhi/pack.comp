// Writes packed bytes through an integer view, after what was there.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, r32ui) LUMO_READ_WRITE uniform uimage2D words;

void main() {
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(p, imageSize(words)))) return;
    imageStore(words, p, uvec4(imageLoad(words, p).r * 2u + 1u));
}
