// Blocks of 4 x 4 x 4 voxels of a dense volume that hold something, or did when they were last listed: the rest of the
// volume is 0 and stays so. Groups of indirect dispatches, the number of blocks, and the list: 10 bits for each of x, y
// and z. The includer defines BLOCKS, a binding, and the qualifier BLOCK_ACCESS.

const int block_side = 4;
const uint max_block_groups = 65535u;  // along x; then along y

struct BlockArguments {
    uint groups_x;
    uint groups_y;
    uint groups_z;
    uint count;
};

layout(binding = BLOCKS, std430) BLOCK_ACCESS buffer Blocks {
    BlockArguments each;   // a group a block
    BlockArguments eight;  // a group for eight of them
    uint data[];
} blocks;
