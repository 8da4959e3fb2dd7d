// Exclusive prefix sums in place, of blocks of `block` pairs, a block a group; and each block's total.
layout(local_size_x = 256) in;

layout(push_constant) uniform Push {
    uint count;
    uint block;  // a multiple of 256
} push;

layout(binding = 0, std430) LUMO_READ_WRITE buffer Sums { uvec2 data[]; } sums;
layout(binding = 1, std430) writeonly buffer Totals { uvec2 data[]; } totals;

shared uvec2 prefix[256];

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint first = gl_WorkGroupID.x * push.block;
    uvec2 before = uvec2(0);
    for (uint start = 0u; start < push.block; start += 256u) {
        uint place = first + start + lane;
        uvec2 own = place < push.count ? sums.data[place] : uvec2(0);
        prefix[lane] = own;
        barrier();
        for (uint reach = 1u; reach < 256u; reach *= 2u) {
            uvec2 more = lane >= reach ? prefix[lane - reach] : uvec2(0);
            barrier();
            prefix[lane] += more;
            barrier();
        }
        if (place < push.count) sums.data[place] = before + prefix[lane] - own;
        before += prefix[255];
        barrier();
    }
    if (lane == 0u) totals.data[gl_WorkGroupID.x] = before;
}
