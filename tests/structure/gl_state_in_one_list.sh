#!/usr/bin/env bash
# The OpenGL backend sets state of the context through the list in backends/gl/state.hpp alone, whose pieces a host gets
# back. What the debug output needs is apart: backends/gl/context.cpp gives that back.
set -uo pipefail
cd "$1/backends/gl" || exit 1
setters='gl(Enable|Disable|Bind|Use|Viewport|Scissor|Depth|Blend|ColorMask|PixelStore|ActiveTexture|FrontFace|CullFace'
setters+='|Polygon|Point|Line|Logic|SampleCoverage|SampleMask|Stencil|Clip|Provoking|Primitive|Patch|Hint|Clamp'
setters+='|ClearColor|ClearDepth|ClearStencil|DrawBuffer|ReadBuffer|MinSample|VertexAttrib|Uniform|BeginQuery'
setters+='|BeginConditional|BeginTransform)[A-Za-z0-9_]*\('
found=$(grep -nE "\b$setters" *.cpp *.hpp | grep -vE '^pieces\.|debug_capabilities|hosts_debug_|GL_DEBUG_OUTPUT')
if [[ -n $found ]]; then
    printf '%s\n' "state of the context is set beside the list that a host gets back:" "$found" >&2
    exit 1
fi
