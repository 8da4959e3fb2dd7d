// Chooses the finest level of cells whose emitters are few enough to be lit by one by one.
//
// Where the coarsest level still has more, emission fills the scene and cones of fixed directions see it well: the part
// that the chosen emitters stand for, `share`, falls to 0 at twice as many.
#include "cones/emitter_block.glsl"

layout(local_size_x = 256) in;

layout(push_constant) uniform Push {
    int finest;           // cells a side of the finest level
    int levels;
    int few;              // emitters, at most max_emitters / 2
    float emission_unit;  // radiance = stored emission * emission_unit, W/m²/sr
} push;

layout(binding = 0, std430) readonly buffer Cells { EmitterCell data[]; } cells;
layout(binding = 1, std430) writeonly buffer Emitters { EMITTER_BLOCK } emitters;

const int max_levels = 3;
shared uint emitting[max_levels];
shared uint found;
shared uint chosen[max_emitters];

void main() {
    int thread = int(gl_LocalInvocationIndex);
    int threads = int(gl_WorkGroupSize.x);
    if (thread < max_levels) emitting[thread] = 0u;
    if (thread == 0) found = 0u;
    barrier();
    for (int level = 0; level < push.levels; ++level) {
        int first = first_cell(push.finest, level);
        int end = first_cell(push.finest, level + 1);
        uint count = 0u;
        for (int i = first + thread; i < end; i += threads) {
            if (emitter_weight(cells.data[i]) > 0.0) ++count;
        }
        atomicAdd(emitting[level], count);
    }
    barrier();
    int level = 0;
    while (level < push.levels - 1 && emitting[level] > uint(push.few)) ++level;
    float share = clamp(2.0 - float(emitting[level]) / float(push.few), 0.0, 1.0);
    int first = first_cell(push.finest, level);
    int end = first_cell(push.finest, level + 1);
    for (int i = first + thread; i < end && share > 0.0; i += threads) {
        if (emitter_weight(cells.data[i]) > 0.0) chosen[atomicAdd(found, 1u)] = uint(i);
    }
    barrier();
    // They were found in any order; each goes to the place of its index.
    if (thread < int(found)) {
        uint place = 0u;
        for (uint i = 0u; i < found; ++i) place += chosen[i] < chosen[thread] ? 1u : 0u;
        EmitterCell emitter = cells.data[chosen[thread]];
        emitter.flux *= share * push.emission_unit;
        emitters.data[place] = emitter;
    }
    if (thread == 0) {
        emitters.share = share;
        emitters.count = int(found);
    }
}
