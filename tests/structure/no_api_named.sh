#!/usr/bin/env bash
# Nothing under techniques, scene or shaders names an API: neither a backend's header nor a branch on the API.
set -uo pipefail
cd "$1"
named=$(grep -rnE '#include [<"](backends/|vulkan/|volk|epoxy/|GL/)|Api::(gl|vulkan)|#ifdef +(VULKAN|GL_BACKEND)' \
    techniques scene shaders --include='*.cpp' --include='*.hpp' --include='*.glsl' --include='*.comp' \
    --include='*.vert' --include='*.geom' --include='*.frag')
if [[ $? -gt 1 || -n $named ]]; then
    printf '%s\n' "an API is named where none should be:" "$named" >&2
    exit 1
fi
