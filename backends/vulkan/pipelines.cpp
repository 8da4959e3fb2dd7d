#include "backends/vulkan/pipelines.hpp"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>

#include "backends/vulkan/convert.hpp"
#include "rhi/disk_cache.hpp"

namespace lumo::backends::vulkan {

namespace {

VkPipelineColorBlendAttachmentState blend_state(const rhi::ColorTargetState& target) {
    VkPipelineColorBlendAttachmentState state{.colorWriteMask = target.write_mask};
    if (target.blend) {
        const auto& blend = *target.blend;
        state.blendEnable = VK_TRUE;
        state.srcColorBlendFactor = to_vk(blend.source_color);
        state.dstColorBlendFactor = to_vk(blend.destination_color);
        state.colorBlendOp = to_vk(blend.color_op);
        state.srcAlphaBlendFactor = to_vk(blend.source_alpha);
        state.dstAlphaBlendFactor = to_vk(blend.destination_alpha);
        state.alphaBlendOp = to_vk(blend.alpha_op);
    }
    return state;
}

/// The stages of a program, with the specialization that they share. Points into itself.
struct ShaderStages {
    std::vector<Unique<VkShaderModule>> modules;
    std::vector<VkSpecializationMapEntry> entries;
    VkSpecializationInfo specialization{};
    std::vector<VkPipelineShaderStageCreateInfo> infos;
};

/// What is wrong with a program's code, and not with the memory for it, is an error of the shader.
tl::unexpected<Error> refused(Error error) {
    if (error.kind == ErrorKind::unsupported) error.kind = ErrorKind::shader;
    return tl::unexpected(std::move(error));
}

Result<std::unique_ptr<ShaderStages>> make_stages(const Gpu& gpu, const rhi::ProgramInfo& program,
                                                  std::span<const uint32_t> options) {
    auto made = std::make_unique<ShaderStages>();
    for (uint32_t i = 0; i < program.options.size(); ++i) {
        made->entries.push_back({program.options[i].id, i * 4, 4});
    }
    made->specialization = {uint32_t(made->entries.size()), made->entries.data(), options.size_bytes(),
                            options.data()};
    for (const auto& stage : program.stages) {
        VkShaderModuleCreateInfo info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                      .codeSize = stage.spirv.size_bytes(),
                                      .pCode = stage.spirv.data()};
        auto module = gpu.make<VkShaderModule>(gpu.vk().vkCreateShaderModule, gpu.vk().vkDestroyShaderModule,
                                               info, program.name, VK_OBJECT_TYPE_SHADER_MODULE);
        if (!module) return refused(module.error());
        made->infos.push_back({.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                               .stage = VkShaderStageFlagBits(to_vk(stage.stage)),
                               .module = module->get(),
                               .pName = "main",
                               .pSpecializationInfo = &made->specialization});
        made->modules.push_back(std::move(*module));
    }
    return made;
}

VkResult make_compute(const Gpu& gpu, VkPipelineCache cache, VkPipelineLayout layout,
                      const ShaderStages& stages, VkPipeline* pipeline) {
    VkComputePipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                     .stage = stages.infos.front(),
                                     .layout = layout};
    return gpu.vk().vkCreateComputePipelines(gpu.device(), cache, 1, &info, nullptr, pipeline);
}

VkResult make_raster(const Gpu& gpu, VkPipelineCache cache, VkPipelineLayout layout,
                     const ShaderStages& stages, uint32_t color_outputs, const rhi::RasterState& state,
                     VkPipeline* pipeline) {
    VkPipelineVertexInputStateCreateInfo vertex_input{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    VkPipelineInputAssemblyStateCreateInfo assembly{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = to_vk(state.topology)};
    VkPipelineViewportStateCreateInfo viewport{.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
                                               .viewportCount = 1,
                                               .scissorCount = 1};
    rhi::DepthState depth = state.depth.value_or(rhi::DepthState{.format = rhi::Format::undefined});
    VkPipelineRasterizationStateCreateInfo rasterization{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .depthClampEnable = state.depth_clamp,
        .polygonMode = VK_POLYGON_MODE_FILL,
        .cullMode = to_vk(state.cull),
        // Vulkan's +y points down in NDC, the RHI's up: counter-clockwise there is clockwise here.
        .frontFace = VK_FRONT_FACE_CLOCKWISE,
        .depthBiasEnable = depth.bias_constant != 0 || depth.bias_slope != 0,
        .depthBiasConstantFactor = depth.bias_constant,
        .depthBiasSlopeFactor = depth.bias_slope,
        .lineWidth = 1,
    };
    VkPipelineMultisampleStateCreateInfo multisample{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VkSampleCountFlagBits(state.samples)};
    VkPipelineDepthStencilStateCreateInfo depth_test{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = state.depth.has_value(),
        .depthWriteEnable = state.depth && depth.write,
        .depthCompareOp = to_vk(depth.compare)};
    std::vector<VkPipelineColorBlendAttachmentState> attachments;
    std::vector<VkFormat> formats;
    for (uint32_t i = 0; i < state.color.size(); ++i) {
        attachments.push_back(blend_state(state.color[i]));
        // What the shader leaves out keeps its value, instead of becoming undefined.
        if (!(color_outputs >> i & 1)) attachments.back().colorWriteMask = 0;
        formats.push_back(to_vk(state.color[i].format));
    }
    VkPipelineColorBlendStateCreateInfo blend{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = uint32_t(attachments.size()),
        .pAttachments = attachments.data()};
    constexpr VkDynamicState dynamic_states[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamic{.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
                                             .dynamicStateCount = 2,
                                             .pDynamicStates = dynamic_states};
    VkPipelineRenderingCreateInfo targets{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                          .colorAttachmentCount = uint32_t(formats.size()),
                                          .pColorAttachmentFormats = formats.data(),
                                          .depthAttachmentFormat = to_vk(depth.format)};
    VkGraphicsPipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                      .pNext = &targets,
                                      .stageCount = uint32_t(stages.infos.size()),
                                      .pStages = stages.infos.data(),
                                      .pVertexInputState = &vertex_input,
                                      .pInputAssemblyState = &assembly,
                                      .pViewportState = &viewport,
                                      .pRasterizationState = &rasterization,
                                      .pMultisampleState = &multisample,
                                      .pDepthStencilState = &depth_test,
                                      .pColorBlendState = &blend,
                                      .pDynamicState = &dynamic,
                                      .layout = layout};
    return gpu.vk().vkCreateGraphicsPipelines(gpu.device(), cache, 1, &info, nullptr, pipeline);
}

/// What needs a feature that a host may have left off. Error: unsupported.
Result<void> check_features(const Gpu& gpu, const rhi::ProgramInfo& program, const rhi::RasterState* raster) {
    using rhi::Stages;
    const VkPhysicalDeviceFeatures& enabled = gpu.features().core;
    auto lacks = [&](const char* feature) {
        return fail(ErrorKind::unsupported, std::string(program.name),
                    fmt::format("it needs {}, which this device was made without", feature),
                    "enable it with the host's device, or use another device");
    };
    if (raster && raster->depth_clamp && !enabled.depthClamp) return lacks("depthClamp");
    for (const rhi::BindingInfo& binding : program.bindings) {
        const bool storage = binding.kind == rhi::BindingKind::storage_buffer ||
                             binding.kind == rhi::BindingKind::storage_image;
        if (storage && binding.access != rhi::ShaderAccess::read &&
            has(binding.stages, Stages::vertex | Stages::geometry) && !enabled.vertexPipelineStoresAndAtomics)
            return lacks("vertexPipelineStoresAndAtomics");
        if (binding.dimension == rhi::Dimension::cube_array && !enabled.imageCubeArray)
            return lacks("imageCubeArray");
    }
    return {};
}

rhi::CacheKey cache_key(const Gpu& gpu) {
    const auto& p = gpu.properties();
    return rhi::KeyBuilder()
        .add("vulkan pipelines")
        .add(uint64_t(p.vendorID) << 32 | p.deviceID)
        .add(uint64_t(p.driverVersion))
        .add(std::as_bytes(std::span(p.pipelineCacheUUID)))
        .key();
}

bool is_of(const Gpu& gpu, std::span<const std::byte> cache) {
    VkPipelineCacheHeaderVersionOne header;
    if (cache.size() < sizeof header) return false;
    std::memcpy(&header, cache.data(), sizeof header);
    const auto& p = gpu.properties();
    return header.headerSize >= sizeof header && header.headerSize <= cache.size() &&
           header.headerVersion == VK_PIPELINE_CACHE_HEADER_VERSION_ONE && header.vendorID == p.vendorID &&
           header.deviceID == p.deviceID &&
           std::equal(std::begin(p.pipelineCacheUUID), std::end(p.pipelineCacheUUID),
                      std::begin(header.pipelineCacheUUID));
}

}  // namespace

PipelineCache::PipelineCache(const Gpu& gpu, bool on_disk) : gpu_(gpu), on_disk_(on_disk) {
    std::vector<std::byte> stored;
    if (on_disk) {
        stored = rhi::DiskCache::of_user().get(cache_key(gpu)).value_or(std::vector<std::byte>());
        if (!is_of(gpu, stored)) stored.clear();
    }
    loaded_bytes_ = stored.size();
    VkPipelineCacheCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO,
                                   .initialDataSize = stored.size(),
                                   .pInitialData = stored.data()};
    auto made = gpu.make<VkPipelineCache>(gpu.vk().vkCreatePipelineCache, gpu.vk().vkDestroyPipelineCache,
                                          info, "pipeline cache");
    // Without a cache everything works, only slower.
    if (made) cache_ = std::move(*made);
}

PipelineCache::~PipelineCache() {
    size_t size = 0;
    if (!on_disk_ || !cache_) return;
    gpu_.vk().vkGetPipelineCacheData(gpu_.device(), cache_.get(), &size, nullptr);
    if (size <= loaded_bytes_) return;
    std::vector<std::byte> bytes(size);
    if (gpu_.vk().vkGetPipelineCacheData(gpu_.device(), cache_.get(), &size, bytes.data()) != VK_SUCCESS)
        return;
    bytes.resize(size);
    if (auto put = rhi::DiskCache::of_user().put(cache_key(gpu_), bytes); !put) {
        gpu_.instance().report({.id = "pipeline-cache", .text = to_string(put.error())});
    }
}

Result<Pipeline> create_pipeline(const Gpu& gpu, const PipelineCache& cache, const rhi::ProgramInfo& program,
                                 std::span<const uint32_t> options, const rhi::RasterState* raster) {
    if (auto fine = check_features(gpu, program, raster); !fine) return tl::unexpected(fine.error());
    const auto& vk = gpu.vk();
    Pipeline made;
    if (raster) made.bind_point = VK_PIPELINE_BIND_POINT_GRAPHICS;
    for (const auto& stage : program.stages) made.stages |= to_vk(stage.stage);

    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (const auto& binding : program.bindings) {
        made.slots.push_back({binding.binding, to_vk(binding.kind)});
        bindings.push_back({.binding = binding.binding,
                            .descriptorType = made.slots.back().type,
                            .descriptorCount = 1,
                            .stageFlags = to_vk(binding.stages)});
    }
    VkDescriptorSetLayoutCreateInfo set_info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                             .bindingCount = uint32_t(bindings.size()),
                                             .pBindings = bindings.data()};
    if (gpu.has_push_descriptors()) {
        set_info.flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR;
    }
    auto set_layout =
        gpu.make<VkDescriptorSetLayout>(vk.vkCreateDescriptorSetLayout, vk.vkDestroyDescriptorSetLayout,
                                        set_info, program.name, VK_OBJECT_TYPE_DESCRIPTOR_SET_LAYOUT);
    if (!set_layout) return tl::unexpected(set_layout.error());
    made.set_layout = std::move(*set_layout);

    VkDescriptorSetLayout set = made.set_layout.get();
    VkPushConstantRange push{made.stages, 0, program.push_size};
    VkPipelineLayoutCreateInfo layout_info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                           .setLayoutCount = 1,
                                           .pSetLayouts = &set,
                                           .pushConstantRangeCount = program.push_size > 0 ? 1u : 0u,
                                           .pPushConstantRanges = &push};
    auto layout = gpu.make<VkPipelineLayout>(vk.vkCreatePipelineLayout, vk.vkDestroyPipelineLayout,
                                             layout_info, program.name, VK_OBJECT_TYPE_PIPELINE_LAYOUT);
    if (!layout) return tl::unexpected(layout.error());
    made.layout = std::move(*layout);

    auto stages = make_stages(gpu, program, options);
    if (!stages) return tl::unexpected(stages.error());
    VkPipeline pipeline = VK_NULL_HANDLE;
    VkResult result = raster ? make_raster(gpu, cache.get(), made.layout.get(), **stages,
                                           program.color_outputs, *raster, &pipeline)
                             : make_compute(gpu, cache.get(), made.layout.get(), **stages, &pipeline);
    made.pipeline = Unique<VkPipeline>(gpu.device(), pipeline, vk.vkDestroyPipeline);
    if (result != VK_SUCCESS) {
        return refused(fail(result, std::string(program.name), "pipeline creation").value());
    }
    gpu.set_name(VK_OBJECT_TYPE_PIPELINE, uint64_t(pipeline), program.name);
    return made;
}

}  // namespace lumo::backends::vulkan
