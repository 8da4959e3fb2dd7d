#include "shadercompiler/opengl.hpp"

#include <algorithm>
#include <spirv_cross/spirv_glsl.hpp>

namespace lumo::shadercompiler {

Result<std::string> to_opengl(const std::string& path, const Words& spirv,
                              std::span<const rhi::BindingInfo> bindings) {
    try {
        spirv_cross::CompilerGLSL compiler(spirv);
        spirv_cross::CompilerGLSL::Options options;
        options.version = 450;
        options.es = false;
        options.emit_push_constant_as_uniform_buffer = true;
        // What a shader does to an image is as reflected; a deduction from code that the optimiser has seen
        // would differ.
        options.enable_storage_image_qualifier_deduction = false;
        options.enable_row_major_load_workaround = false;
        // The optimiser leaves undefined values on paths where nothing reads them; Mesa warns of each.
        options.force_zero_initialized_variables = true;
        options.vertex.support_nonzero_base_instance = false;
        compiler.set_common_options(options);

        const spirv_cross::ShaderResources resources = compiler.get_shader_resources();
        for (const auto* list : {&resources.sampled_images, &resources.storage_images,
                                 &resources.storage_buffers, &resources.uniform_buffers}) {
            for (const spirv_cross::Resource& resource : *list) {
                const uint32_t binding = compiler.get_decoration(resource.id, spv::DecorationBinding);
                const auto info = std::ranges::find(bindings, binding, &rhi::BindingInfo::binding);
                if (info == bindings.end()) {
                    return fail(ErrorKind::shader, path, "'" + resource.name + "' has no OpenGL slot");
                }
                compiler.set_decoration(resource.id, spv::DecorationBinding, info->gl_slot);
                compiler.unset_decoration(resource.id, spv::DecorationDescriptorSet);
            }
        }
        for (const spirv_cross::Resource& resource : resources.push_constant_buffers) {
            compiler.set_decoration(resource.id, spv::DecorationBinding, rhi::gl_push_slot);
        }
        return compiler.compile();
    } catch (const spirv_cross::CompilerError& error) {
        return fail(ErrorKind::shader, path, std::string("no OpenGL text: ") + error.what());
    }
}

}  // namespace lumo::shadercompiler
