#include "samples/embed-vulkan/host.hpp"

#include <cstdio>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <stdexcept>
#include <string>

#include "embed-vulkan-spirv/compose_frag.h"
#include "embed-vulkan-spirv/compose_vert.h"
#include "embed-vulkan-spirv/gbuffer_frag.h"
#include "embed-vulkan-spirv/gbuffer_vert.h"
#include "embed-vulkan-spirv/triangle_frag.h"
#include "embed-vulkan-spirv/triangle_vert.h"

namespace embed {

namespace {

struct Push {
    glm::mat4 matrix;
    glm::vec4 toward_sun, sun, sky;
};

constexpr VkShaderStageFlags all_stages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

VkImageAspectFlags aspect_of(VkFormat format) {
    return format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

glm::mat4 clip_from_world(const Camera& camera, float aspect) {
    glm::mat4 projection =
        glm::perspectiveRH_ZO(camera.vertical_fov, aspect, camera.near_plane, camera.far_plane);
    projection[1][1] *= -1;  // Vulkan's y points down: row 0 is the top
    return projection * glm::lookAtRH(camera.position, camera.target, glm::vec3(0, 1, 0));
}

}  // namespace

void check(VkResult result, const char* call) {
    if (result != VK_SUCCESS)
        throw std::runtime_error(std::string(call) + " returned VkResult " + std::to_string(int(result)));
}

VkBool32 VKAPI_CALL Host::on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                     const VkDebugUtilsMessengerCallbackDataEXT* data, void* host) {
    if (std::strcmp(data->pMessageIdName ? data->pMessageIdName : "", "Loader Message") != 0) {
        ++static_cast<Host*>(host)->messages_;
        std::fprintf(stderr, "embed-vulkan: %s\n", data->pMessage);
    }
    return VK_FALSE;
}

Host::Host(const HostOptions& options) : width_(options.width), height_(options.height) {
    make_instance(options);
    make_device(!options.surface_extensions.empty());
    albedo_ = make_image(VK_FORMAT_R8G8B8A8_UNORM,
                         VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT);
    normal_ = make_image(VK_FORMAT_R16G16B16A16_SFLOAT,
                         VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT);
    depth_ = make_image(VK_FORMAT_D32_SFLOAT,
                        VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT);
    irradiance_ = make_image(VK_FORMAT_R32G32B32A32_SFLOAT,
                             VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT);
    picture_ = make_image(VK_FORMAT_R8G8B8A8_SRGB,
                          VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
    make_boxes();
    make_descriptors();
    const VkFormat surfaces[] = {albedo_.format, normal_.format};
    gbuffer_pipeline_ = make_pipeline(gbuffer_vert, gbuffer_frag, surfaces, true);
    compose_pipeline_ = make_pipeline(compose_vert, compose_frag, {&picture_.format, 1}, false);
    triangle_pipeline_ = make_pipeline(triangle_vert, triangle_frag, {&picture_.format, 1}, false);
    // What nobody wrote yet is in the layout that its descriptor promises.
    run([&](VkCommandBuffer commands) {
        transition(commands, irradiance_.image, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
                   VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    });
}

Host::~Host() {
    vkDeviceWaitIdle(device_);
    for (VkPipeline pipeline : {gbuffer_pipeline_, compose_pipeline_, triangle_pipeline_})
        vkDestroyPipeline(device_, pipeline, nullptr);
    vkDestroyPipelineLayout(device_, layout_, nullptr);
    vkDestroyDescriptorPool(device_, descriptor_pool_, nullptr);
    vkDestroyDescriptorSetLayout(device_, set_layout_, nullptr);
    vkDestroySampler(device_, sampler_, nullptr);
    vkDestroyBuffer(device_, boxes_, nullptr);
    vkFreeMemory(device_, boxes_memory_, nullptr);
    for (const Image& image : {albedo_, normal_, depth_, irradiance_, picture_}) {
        vkDestroyImageView(device_, image.view, nullptr);
        vkDestroyImage(device_, image.image, nullptr);
        vkFreeMemory(device_, image.memory, nullptr);
    }
    vkDestroyCommandPool(device_, pool_, nullptr);
    vkDestroyDevice(device_, nullptr);
    if (messenger_) {
        reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(vkGetInstanceProcAddr(
            instance_, "vkDestroyDebugUtilsMessengerEXT"))(instance_, messenger_, nullptr);
    }
    vkDestroyInstance(instance_, nullptr);
}

void Host::make_instance(const HostOptions& options) {
    const VkDebugUtilsMessengerCreateInfoEXT messenger{
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType =
            VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = this};
    const auto synchronization = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    const VkValidationFeaturesEXT validation{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                             .pNext = &messenger,
                                             .enabledValidationFeatureCount = 1,
                                             .pEnabledValidationFeatures = &synchronization};
    std::vector<const char*> extensions(options.surface_extensions.begin(), options.surface_extensions.end());
    if (options.validation) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    const char* layer = "VK_LAYER_KHRONOS_validation";
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                        .pApplicationName = "embed-vulkan",
                                        .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                    .pNext = options.validation ? &validation : nullptr,
                                    .pApplicationInfo = &application,
                                    .enabledLayerCount = options.validation ? 1u : 0u,
                                    .ppEnabledLayerNames = &layer,
                                    .enabledExtensionCount = uint32_t(extensions.size()),
                                    .ppEnabledExtensionNames = extensions.data()};
    check(vkCreateInstance(&info, nullptr, &instance_), "vkCreateInstance");
    if (options.validation) {
        const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
        check(create(instance_, &messenger, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
    }
}

void Host::make_device(bool presents) {
    uint32_t count = 1;
    vkEnumeratePhysicalDevices(instance_, &count, &physical_);
    if (count == 0) throw std::runtime_error("there is no Vulkan device");
    std::vector<VkQueueFamilyProperties> families(32);
    count = uint32_t(families.size());
    vkGetPhysicalDeviceQueueFamilyProperties(physical_, &count, families.data());
    constexpr VkQueueFlags both = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    while (family_ + 1 < count && (families[family_].queueFlags & both) != both) ++family_;

    // The host itself needs dynamic rendering alone. The rest is for its guest: what lumo requires is listed by
    // lumo::backends::vulkan::requirements(). Push descriptors are left off, as most engines leave them.
    features13_ = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                   .synchronization2 = VK_TRUE,
                   .dynamicRendering = VK_TRUE};
    features12_ = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                   .pNext = &features13_,
                   .hostQueryReset = VK_TRUE,
                   .timelineSemaphore = VK_TRUE};
    features_ = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                 .pNext = &features12_,
                 .features = {.independentBlend = VK_TRUE,
                              .fragmentStoresAndAtomics = VK_TRUE,
                              .shaderStorageImageExtendedFormats = VK_TRUE,
                              .shaderStorageImageWriteWithoutFormat = VK_TRUE}};
    if (presents) device_extensions_.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                        .queueFamilyIndex = family_,
                                        .queueCount = 1,
                                        .pQueuePriorities = &priority};
    const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                  .pNext = &features_,
                                  .queueCreateInfoCount = 1,
                                  .pQueueCreateInfos = &queue,
                                  .enabledExtensionCount = uint32_t(device_extensions_.size()),
                                  .ppEnabledExtensionNames = device_extensions_.data()};
    check(vkCreateDevice(physical_, &info, nullptr, &device_), "vkCreateDevice");
    vkGetDeviceQueue(device_, family_, 0, &queue_);
    const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                       .queueFamilyIndex = family_};
    check(vkCreateCommandPool(device_, &pool, nullptr, &pool_), "vkCreateCommandPool");
}

uint32_t Host::memory_type(uint32_t allowed, VkMemoryPropertyFlags wanted) const {
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory);
    for (uint32_t type = 0; type < memory.memoryTypeCount; ++type)
        if ((allowed >> type & 1) && (memory.memoryTypes[type].propertyFlags & wanted) == wanted) return type;
    throw std::runtime_error("the device has no memory of a fitting type");
}

Image Host::make_image(VkFormat format, VkImageUsageFlags usage) {
    Image made{.format = format};
    const VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                 .imageType = VK_IMAGE_TYPE_2D,
                                 .format = format,
                                 .extent = {width_, height_, 1},
                                 .mipLevels = 1,
                                 .arrayLayers = 1,
                                 .samples = VK_SAMPLE_COUNT_1_BIT,
                                 .usage = usage};
    check(vkCreateImage(device_, &info, nullptr, &made.image), "vkCreateImage");
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(device_, made.image, &needs);
    const VkMemoryAllocateInfo allocate{
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = needs.size,
        .memoryTypeIndex = memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)};
    check(vkAllocateMemory(device_, &allocate, nullptr, &made.memory), "vkAllocateMemory");
    check(vkBindImageMemory(device_, made.image, made.memory, 0), "vkBindImageMemory");
    const VkImageViewCreateInfo view{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                     .image = made.image,
                                     .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                     .format = format,
                                     .subresourceRange = {aspect_of(format), 0, 1, 0, 1}};
    check(vkCreateImageView(device_, &view, nullptr, &made.view), "vkCreateImageView");
    return made;
}

std::pair<VkBuffer, VkDeviceMemory> Host::make_buffer(VkDeviceSize size, VkBufferUsageFlags usage) {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    const VkBufferCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size, .usage = usage};
    check(vkCreateBuffer(device_, &info, nullptr, &buffer), "vkCreateBuffer");
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device_, buffer, &needs);
    const VkMemoryAllocateInfo allocate{
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = needs.size,
        .memoryTypeIndex = memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                                                 VK_MEMORY_PROPERTY_HOST_COHERENT_BIT)};
    check(vkAllocateMemory(device_, &allocate, nullptr, &memory), "vkAllocateMemory");
    check(vkBindBufferMemory(device_, buffer, memory, 0), "vkBindBufferMemory");
    return {buffer, memory};
}

void Host::make_boxes() {
    std::tie(boxes_, boxes_memory_) = make_buffer(sizeof boxes, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT);
    void* mapped = nullptr;
    check(vkMapMemory(device_, boxes_memory_, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
    std::memcpy(mapped, boxes.data(), sizeof boxes);
    vkUnmapMemory(device_, boxes_memory_);
}

void Host::make_descriptors() {
    const VkSamplerCreateInfo sampler{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    check(vkCreateSampler(device_, &sampler, nullptr, &sampler_), "vkCreateSampler");

    const Image* sampled[] = {&albedo_, &normal_, &depth_, &irradiance_};
    std::vector<VkDescriptorSetLayoutBinding> bindings{
        {0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1, all_stages, nullptr}};
    for (uint32_t i = 1; i <= std::size(sampled); ++i)
        bindings.push_back(
            {i, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr});
    const VkDescriptorSetLayoutCreateInfo set_layout{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = uint32_t(bindings.size()),
        .pBindings = bindings.data()};
    check(vkCreateDescriptorSetLayout(device_, &set_layout, nullptr, &set_layout_),
          "vkCreateDescriptorSetLayout");
    const VkPushConstantRange push{all_stages, 0, sizeof(Push)};
    const VkPipelineLayoutCreateInfo layout{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                            .setLayoutCount = 1,
                                            .pSetLayouts = &set_layout_,
                                            .pushConstantRangeCount = 1,
                                            .pPushConstantRanges = &push};
    check(vkCreatePipelineLayout(device_, &layout, nullptr, &layout_), "vkCreatePipelineLayout");

    const VkDescriptorPoolSize sizes[] = {
        {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1},
        {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, uint32_t(std::size(sampled))}};
    const VkDescriptorPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                          .maxSets = 1,
                                          .poolSizeCount = 2,
                                          .pPoolSizes = sizes};
    check(vkCreateDescriptorPool(device_, &pool, nullptr, &descriptor_pool_), "vkCreateDescriptorPool");
    const VkDescriptorSetAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                               .descriptorPool = descriptor_pool_,
                                               .descriptorSetCount = 1,
                                               .pSetLayouts = &set_layout_};
    check(vkAllocateDescriptorSets(device_, &allocate, &set_), "vkAllocateDescriptorSets");

    const VkDescriptorBufferInfo buffer{boxes_, 0, VK_WHOLE_SIZE};
    std::vector<VkDescriptorImageInfo> images;
    for (const Image* image : sampled)
        images.push_back({sampler_, image->view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL});
    const VkWriteDescriptorSet writes[] = {{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                            .dstSet = set_,
                                            .dstBinding = 0,
                                            .descriptorCount = 1,
                                            .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
                                            .pBufferInfo = &buffer},
                                           {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                            .dstSet = set_,
                                            .dstBinding = 1,
                                            .descriptorCount = uint32_t(images.size()),
                                            .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                            .pImageInfo = images.data()}};
    vkUpdateDescriptorSets(device_, 2, writes, 0, nullptr);
}

VkPipeline Host::make_pipeline(std::span<const uint32_t> vertex, std::span<const uint32_t> fragment,
                               std::span<const VkFormat> colors, bool depth) {
    VkPipelineShaderStageCreateInfo stages[2]{};
    const std::span<const uint32_t> codes[] = {vertex, fragment};
    for (int i = 0; i < 2; ++i) {
        const VkShaderModuleCreateInfo info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                            .codeSize = codes[i].size_bytes(),
                                            .pCode = codes[i].data()};
        stages[i] = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                     .stage = i == 0 ? VK_SHADER_STAGE_VERTEX_BIT : VK_SHADER_STAGE_FRAGMENT_BIT,
                     .pName = "main"};
        check(vkCreateShaderModule(device_, &info, nullptr, &stages[i].module), "vkCreateShaderModule");
    }
    const VkPipelineVertexInputStateCreateInfo input{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    const VkPipelineInputAssemblyStateCreateInfo assembly{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkPipelineViewportStateCreateInfo viewport{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .scissorCount = 1};
    const VkPipelineRasterizationStateCreateInfo rasterization{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO, .lineWidth = 1};
    const VkPipelineMultisampleStateCreateInfo multisample{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    const VkPipelineDepthStencilStateCreateInfo depth_test{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = depth,
        .depthWriteEnable = depth,
        .depthCompareOp = VK_COMPARE_OP_LESS};
    const std::vector<VkPipelineColorBlendAttachmentState> attachments(colors.size(),
                                                                       {.colorWriteMask = 0xf});
    const VkPipelineColorBlendStateCreateInfo blend{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = uint32_t(attachments.size()),
        .pAttachments = attachments.data()};
    const VkDynamicState dynamic_states[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    const VkPipelineDynamicStateCreateInfo dynamic{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
        .dynamicStateCount = 2,
        .pDynamicStates = dynamic_states};
    const VkPipelineRenderingCreateInfo targets{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
        .colorAttachmentCount = uint32_t(colors.size()),
        .pColorAttachmentFormats = colors.data(),
        .depthAttachmentFormat = depth ? depth_.format : VK_FORMAT_UNDEFINED};
    const VkGraphicsPipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                            .pNext = &targets,
                                            .stageCount = 2,
                                            .pStages = stages,
                                            .pVertexInputState = &input,
                                            .pInputAssemblyState = &assembly,
                                            .pViewportState = &viewport,
                                            .pRasterizationState = &rasterization,
                                            .pMultisampleState = &multisample,
                                            .pDepthStencilState = &depth_test,
                                            .pColorBlendState = &blend,
                                            .pDynamicState = &dynamic,
                                            .layout = layout_};
    VkPipeline pipeline = VK_NULL_HANDLE;
    const VkResult made = vkCreateGraphicsPipelines(device_, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline);
    for (const auto& stage : stages) vkDestroyShaderModule(device_, stage.module, nullptr);
    check(made, "vkCreateGraphicsPipelines");
    return pipeline;
}

void transition(VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect, VkImageLayout before,
                VkImageLayout after) {
    const VkImageMemoryBarrier2 barrier{
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .srcAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT,
        .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT,
        .oldLayout = before,
        .newLayout = after,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image,
        .subresourceRange = {aspect, 0, 1, 0, 1}};
    const VkDependencyInfo info{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                .imageMemoryBarrierCount = 1,
                                .pImageMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands, &info);
}

void Host::begin_rendering(VkCommandBuffer commands, std::span<const Image* const> colors, const Image* depth,
                           VkPipeline pipeline) const {
    const auto attach = [](const Image& image, VkImageLayout layout) {
        return VkRenderingAttachmentInfo{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                         .imageView = image.view,
                                         .imageLayout = layout,
                                         .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                         .storeOp = VK_ATTACHMENT_STORE_OP_STORE};
    };
    std::vector<VkRenderingAttachmentInfo> targets;
    for (const Image* color : colors)
        targets.push_back(attach(*color, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL));
    VkRenderingAttachmentInfo depth_target{};
    if (depth) {
        depth_target = attach(*depth, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
        depth_target.clearValue.depthStencil.depth = 1;
    }
    const VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                               .renderArea = {{0, 0}, {width_, height_}},
                               .layerCount = 1,
                               .colorAttachmentCount = uint32_t(targets.size()),
                               .pColorAttachments = targets.data(),
                               .pDepthAttachment = depth ? &depth_target : nullptr};
    vkCmdBeginRendering(commands, &info);
    const VkViewport viewport{0, 0, float(width_), float(height_), 0, 1};
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdSetScissor(commands, 0, 1, &info.renderArea);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_, 0, 1, &set_, 0, nullptr);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
}

void Host::draw_gbuffer(const Camera& camera) {
    run([&](VkCommandBuffer commands) {
        for (const Image* image : {&albedo_, &normal_})
            transition(commands, image->image, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
                       VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
        transition(commands, depth_.image, VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
                   VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
        const Image* targets[] = {&albedo_, &normal_};
        begin_rendering(commands, targets, &depth_, gbuffer_pipeline_);
        const Push push{.matrix = clip_from_world(camera, float(width_) / float(height_))};
        vkCmdPushConstants(commands, layout_, all_stages, 0, sizeof push, &push);
        vkCmdDraw(commands, 36, uint32_t(boxes.size()), 0, 0);
        vkCmdEndRendering(commands);
        for (const Image* image : {&albedo_, &normal_})
            transition(commands, image->image, VK_IMAGE_ASPECT_COLOR_BIT,
                       VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
        transition(commands, depth_.image, VK_IMAGE_ASPECT_DEPTH_BIT,
                   VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    });
}

void Host::compose(const Camera& camera, bool with_indirect) {
    run([&](VkCommandBuffer commands) {
        transition(commands, picture_.image, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
                   VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
        const Image* targets[] = {&picture_};
        begin_rendering(commands, targets, nullptr, compose_pipeline_);
        const Push push{.matrix = glm::inverse(clip_from_world(camera, float(width_) / float(height_))),
                        .toward_sun = glm::vec4(toward_sun, with_indirect ? 1 : 0),
                        .sun = glm::vec4(sun_irradiance, 0),
                        .sky = glm::vec4(sky_radiance, 0)};
        vkCmdPushConstants(commands, layout_, all_stages, 0, sizeof push, &push);
        vkCmdDraw(commands, 3, 1, 0, 0);
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, triangle_pipeline_);
        vkCmdDraw(commands, 3, 1, 0, 0);
        vkCmdEndRendering(commands);
        transition(commands, picture_.image, VK_IMAGE_ASPECT_COLOR_BIT,
                   VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    });
}

std::vector<uint8_t> Host::read_picture() {
    std::vector<uint8_t> texels(size_t(width_) * height_ * 4);
    const auto [buffer, memory] = make_buffer(texels.size(), VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    run([&, target = buffer](VkCommandBuffer commands) {
        const VkBufferImageCopy region{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                       .imageExtent = {width_, height_, 1}};
        vkCmdCopyImageToBuffer(commands, picture_.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target, 1,
                               &region);
        const VkMemoryBarrier2 visible{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                       .srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT,
                                       .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                       .dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT,
                                       .dstAccessMask = VK_ACCESS_2_HOST_READ_BIT};
        const VkDependencyInfo info{
            .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &visible};
        vkCmdPipelineBarrier2(commands, &info);
    });
    finish();
    void* mapped = nullptr;
    check(vkMapMemory(device_, memory, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
    std::memcpy(texels.data(), mapped, texels.size());
    vkDestroyBuffer(device_, buffer, nullptr);
    vkFreeMemory(device_, memory, nullptr);
    return texels;
}

void Host::run(const std::function<void(VkCommandBuffer)>& record, VkSemaphore wait, VkSemaphore signal) {
    VkCommandBuffer commands = VK_NULL_HANDLE;
    const VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                               .commandPool = pool_,
                                               .commandBufferCount = 1};
    check(vkAllocateCommandBuffers(device_, &allocate, &commands), "vkAllocateCommandBuffers");
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    check(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
    record(commands);
    check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
    const VkPipelineStageFlags everything = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
    const VkSubmitInfo info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                            .waitSemaphoreCount = wait ? 1u : 0u,
                            .pWaitSemaphores = &wait,
                            .pWaitDstStageMask = &everything,
                            .commandBufferCount = 1,
                            .pCommandBuffers = &commands,
                            .signalSemaphoreCount = signal ? 1u : 0u,
                            .pSignalSemaphores = &signal};
    check(vkQueueSubmit(queue_, 1, &info, VK_NULL_HANDLE), "vkQueueSubmit");
    submitted_.push_back(commands);
}

void Host::finish() {
    check(vkQueueWaitIdle(queue_), "vkQueueWaitIdle");
    if (!submitted_.empty())
        vkFreeCommandBuffers(device_, pool_, uint32_t(submitted_.size()), submitted_.data());
    submitted_.clear();
}

}  // namespace embed
