// Where a dense volume holds something: not 0, a word for each block of 4 x 4 x 4 voxels, x fastest. An octree has none:
// its nodes are such blocks. The includer defines BLOCK_MARKS, a binding.
layout(binding = BLOCK_MARKS, std430) readonly buffer BlockMarks { uint data[]; } block_marks;
