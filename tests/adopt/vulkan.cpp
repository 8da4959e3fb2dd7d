// lumo on a Vulkan device that is a host's: made without push descriptors and with no feature beyond those that are
// required. The host's validation layers, and lumo's checks, must have nothing to say.
#include <fstream>
#include <glm/vec4.hpp>
#include <iterator>
#include <map>

#include "backends/vulkan/adopt.hpp"
#include "shaders/test_rhi/advance.hpp"
#include "shaders/test_rhi/count.hpp"
#include "shaders/test_rhi/pull.hpp"
#include "shaders/test_rhi/sample_cube_array.hpp"
#include "shaders/test_rhi/sample_d2.hpp"
#include "shaders/test_rhi/scale.hpp"
#include "shaders/test_rhi/store_d2.hpp"
#include "tests/adopt/vulkan_host.hpp"
#include "tests/support/device_test.hpp"

namespace lumo::rhi {
namespace {

using namespace testing_support;
using namespace shaders::test_rhi;
using backends::vulkan::HostDevice;
using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

constexpr uint32_t side = 16;

struct AdoptVulkan : testing::Test {
    std::unique_ptr<VulkanHost> host;
    std::vector<Message> messages;
    std::optional<Device> device;

    void open(const VulkanHost::Asked& asked = {}) {
        host = VulkanHost::open(asked);
        if (!host) return;
        device.emplace(must(adopt(host->described())));
    }
    Result<Device> adopt(const HostDevice& described, DeviceDesc desc = {}) {
        desc.sink = [this](const Message& message) { messages.push_back(message); };
        return backends::vulkan::adopt_device(described, desc);
    }
    /// lumo goes, then the host with its device: what lumo left behind, the layers name.
    void TearDown() override {
        device.reset();
        for (const Message& message : messages)
            if (is_failure(message)) ADD_FAILURE() << message.id << ": " << message.text;
        if (!host) return;
        const auto said = host->messages();
        host.reset();
        EXPECT_THAT(*said, IsEmpty());
    }

    Texture adopted(VkImage image, VkImageLayout before, VkImageLayout after,
                    TextureUsage usage = TextureUsage::sampled, Format format = Format::rgba32_float) {
        return must(device->adopt_texture(
            {.name = "host's", .format = format, .extent = {side, side}, .usage = usage},
            {.object = uint64_t(image), .layout_before = uint32_t(before), .layout_after = uint32_t(after)}));
    }
};

#define OPEN_HOST(...) \
    open(__VA_ARGS__); \
    if (!host) GTEST_SKIP() << "there is no Vulkan device"

/// Compute and raster work whose result is a list of numbers.
std::vector<uint32_t> work_on(Device& device) {
    std::vector<uint32_t> all;
    const auto keep = [&](const std::vector<std::byte>& bytes) {
        for (uint32_t word : values_of<uint32_t>(bytes)) all.push_back(word);
    };
    // More descriptor sets in one submission than one pool holds, and more submissions than are in flight.
    Buffer values = must(device.create_buffer({.name = "values", .size = 4096}));
    Buffer counters = must(device.create_buffer({.name = "counters", .size = 64}));
    Buffer scaled = must(device.create_buffer({.name = "scaled", .size = 4096}));
    const auto step = must(device.create_compute_pipeline<advance>());
    const auto tally = must(device.create_compute_pipeline<count>());
    const auto multiply = must(device.create_compute_pipeline<scale>());
    for (int submission = 0; submission < 4; ++submission) {
        Commands commands = device.begin();
        const UniformBuffer settings = commands.uniform(scale::Settings{.addend = {1, 2, 3, submission}});
        Pass pass = commands.pass("work");
        if (submission == 0) {
            pass.fill(values.slice(), 5);
            pass.fill(counters.slice());
        }
        for (int i = 0; i < 300; ++i) {
            pass.dispatch(step, {.Values = values.slice()}, {}, {16});
            pass.dispatch(tally, {.Counters = counters.slice()}, {.counters = 16}, {2});
        }
        pass.dispatch(multiply, {.Source = values.slice(), .settings = settings, .Target = scaled.slice()},
                      {.count = 1024, .factor = 3, .pair = {2, 7}}, {16});
    }
    keep(must(device.download(values.slice())));
    keep(must(device.download(counters.slice())));
    keep(must(device.download(scaled.slice())));

    struct Vertex {
        glm::vec4 position, color;
    };
    const std::vector<Vertex> corners{{{-0.9f, -0.8f, 0.2f, 1}, {1, 0, 0, 1}},
                                      {{0.8f, -0.7f, 0.5f, 1}, {0, 1, 0, 1}},
                                      {{-0.1f, 0.9f, 0.8f, 1}, {0, 0, 1, 1}}};
    Buffer vertices = must(device.create_buffer({.name = "vertices", .size = sizeof(Vertex) * 3}));
    must(device.upload(vertices.slice(), bytes_of(corners)));
    const TextureUsage usage = TextureUsage::attachment | TextureUsage::sampled;
    Texture target = must(device.create_texture(
        {.name = "target", .format = Format::rgba32_float, .extent = {64, 64}, .usage = usage}));
    Texture depth = must(device.create_texture(
        {.name = "depth", .format = Format::d32_float, .extent = {64, 64}, .usage = usage}));
    const auto draw = must(device.create_raster_pipeline<pull>(
        {.color = {{.format = Format::rgba32_float}}, .depth = DepthState{}, .cull = CullMode::none}));
    {
        Commands commands = device.begin();
        RasterPass pass = commands.raster_pass(
            "draw", {.color = {{.view = target.view()}}, .depth = DepthTarget{.view = depth.view()}});
        for (int i = 0; i < 300; ++i)
            pass.draw(draw, {.Vertices = vertices.slice()},
                      {.tint = {1, 1, 1, 1}, .offset = {float(i) * 0.001f, 0}},
                      Draw{.vertices = 3, .instances = 2});
    }
    keep(must(device.download(target, whole_mip(target.desc()))));
    keep(must(device.download(depth, whole_mip(depth.desc()))));
    return all;
}

TEST_F(AdoptVulkan, GivesTheSameBitsAsADeviceOfLumosOwn) {
    OPEN_HOST();
    auto own = open_device(Api::vulkan, {.name = host->device_name()});
    ASSERT_TRUE(own);
    EXPECT_EQ(work_on(*device), work_on(*own->device));
    EXPECT_THAT(own->take_failures(), IsEmpty());
}

TEST_F(AdoptVulkan, PushDescriptorsAreUsedWhereTheHostEnabledThem) {
    OPEN_HOST({.extensions = {VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME}});
    const std::vector<uint32_t> pushed = work_on(*device);
    device.reset();
    OPEN_HOST();
    EXPECT_EQ(work_on(*device), pushed);
}

TEST_F(AdoptVulkan, AHostWithoutDebugUtilsIsServedAsWell) {
    OPEN_HOST({.debug_utils = false});
    const std::vector<uint32_t> silent = work_on(*device);
    device.reset();
    OPEN_HOST();
    EXPECT_EQ(work_on(*device), silent);
}

TEST_F(AdoptVulkan, FeaturesAreReadFromStructuresOfTheirOwnToo) {
    OPEN_HOST();
    HostFeatures features = HostFeatures::required();
    VkPhysicalDeviceTimelineSemaphoreFeatures timeline{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES, .timelineSemaphore = VK_TRUE};
    VkPhysicalDeviceHostQueryResetFeatures reset{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_HOST_QUERY_RESET_FEATURES,
        .pNext = &timeline,
        .hostQueryReset = VK_TRUE};
    VkPhysicalDeviceSynchronization2Features synchronization{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES,
        .pNext = &reset,
        .synchronization2 = VK_TRUE};
    VkPhysicalDeviceDynamicRenderingFeatures rendering{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES,
        .pNext = &synchronization,
        .dynamicRendering = VK_TRUE};
    const VkPhysicalDeviceFeatures2 chain{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                          .pNext = &rendering,
                                          .features = features.core};
    HostDevice described = host->described();
    described.features = &chain;
    EXPECT_TRUE(adopt(described));
}

// -- what is asked of a host

TEST_F(AdoptVulkan, EachMissingFeatureIsNamed) {
    OPEN_HOST();
    struct Missing {
        const char* name;
        VkBool32& (*in)(HostFeatures&);
    };
    const Missing each[] = {
        {"fragmentStoresAndAtomics",
         [](HostFeatures& f) -> VkBool32& { return f.core.fragmentStoresAndAtomics; }},
        {"shaderStorageImageWriteWithoutFormat",
         [](HostFeatures& f) -> VkBool32& { return f.core.shaderStorageImageWriteWithoutFormat; }},
        {"shaderStorageImageExtendedFormats",
         [](HostFeatures& f) -> VkBool32& { return f.core.shaderStorageImageExtendedFormats; }},
        {"independentBlend", [](HostFeatures& f) -> VkBool32& { return f.core.independentBlend; }},
        {"timelineSemaphore", [](HostFeatures& f) -> VkBool32& { return f.v12.timelineSemaphore; }},
        {"hostQueryReset", [](HostFeatures& f) -> VkBool32& { return f.v12.hostQueryReset; }},
        {"synchronization2", [](HostFeatures& f) -> VkBool32& { return f.v13.synchronization2; }},
        {"dynamicRendering", [](HostFeatures& f) -> VkBool32& { return f.v13.dynamicRendering; }},
    };
    size_t required = 0;
    for (const auto& requirement : backends::vulkan::requirements()) required += requirement.required;
    EXPECT_EQ(required, std::size(each)) << "the published list and this one";
    for (const Missing& missing : each) {
        HostFeatures features = HostFeatures::required();
        missing.in(features) = VK_FALSE;
        const VkPhysicalDeviceFeatures2 chain = features.chain();
        HostDevice described = host->described();
        described.features = &chain;
        const auto refused = adopt(described);
        ASSERT_FALSE(refused) << missing.name;
        EXPECT_EQ(refused.error().kind, ErrorKind::unsupported);
        EXPECT_EQ(refused.error().message, std::string("the host's device was made without ") + missing.name);
    }
    HostDevice described = host->described();
    described.features = nullptr;
    const auto refused = adopt(described);
    ASSERT_FALSE(refused);
    for (const Missing& missing : each) EXPECT_THAT(refused.error().message, HasSubstr(missing.name));
}

TEST(AdoptVulkanPage, ListsWhatIsRequired) {
    std::ifstream file(LUMO_SOURCE_DIR "/docs/porting.md");
    const std::string page((std::istreambuf_iterator<char>(file)), {});
    for (const auto& requirement : backends::vulkan::requirements()) {
        const size_t row = page.find("| `" + std::string(requirement.name) + "` |");
        ASSERT_NE(row, std::string::npos) << requirement.name;
        const std::string line = page.substr(row, page.find('\n', row) - row);
        EXPECT_EQ(line.ends_with("| required |"), requirement.required) << line;
    }
}

TEST_F(AdoptVulkan, WhatTheHostForgotToSayIsNamed) {
    OPEN_HOST();
    const auto error_with = [&](auto change) {
        HostDevice described = host->described();
        change(described);
        const auto refused = adopt(described);
        return refused ? std::string("it was taken") : to_string(refused.error());
    };
    EXPECT_THAT(error_with([](HostDevice& h) { h.get_instance_proc_addr = nullptr; }),
                HasSubstr("get_instance_proc_addr"));
    EXPECT_THAT(error_with([](HostDevice& h) { h.instance = VK_NULL_HANDLE; }),
                HasSubstr(": instance is not set"));
    EXPECT_THAT(error_with([](HostDevice& h) { h.physical_device = VK_NULL_HANDLE; }),
                HasSubstr("physical_device"));
    EXPECT_THAT(error_with([](HostDevice& h) { h.device = VK_NULL_HANDLE; }),
                HasSubstr(": device is not set"));
    EXPECT_THAT(error_with([](HostDevice& h) { h.queue = VK_NULL_HANDLE; }), HasSubstr(": queue is not set"));
    EXPECT_THAT(error_with([](HostDevice& h) { h.queue_family = 77; }), HasSubstr("family 77"));
    EXPECT_THAT(error_with([](HostDevice& h) { h.api_version = VK_API_VERSION_1_2; }),
                AllOf(HasSubstr("Vulkan 1.3"), HasSubstr("1.2")));
}

TEST_F(AdoptVulkan, ANamedDeviceIsThatOrNone) {
    OPEN_HOST();
    EXPECT_TRUE(adopt(host->described(), {.name = host->device_name()}));
    const auto refused = adopt(host->described(), {.name = "an abacus"});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::no_device);
    EXPECT_THAT(refused.error().message, HasSubstr(host->device_name()));
}

TEST_F(AdoptVulkan, ValidationIsTheHostsMatter) {
    OPEN_HOST();
    const auto refused = adopt(host->described(), {.validation = true});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::invalid_argument);
}

TEST_F(AdoptVulkan, WhatNeedsAFeatureThatIsOffIsRefusedByName) {
    OPEN_HOST();
    const auto clamped = device->create_raster_pipeline<pull>(
        {.color = {{.format = Format::rgba32_float}}, .cull = CullMode::none, .depth_clamp = true});
    ASSERT_FALSE(clamped);
    EXPECT_EQ(clamped.error().kind, ErrorKind::unsupported);
    EXPECT_THAT(clamped.error().message, HasSubstr("depthClamp"));
    const auto cubes = device->create_compute_pipeline<sample_cube_array>();
    ASSERT_FALSE(cubes);
    EXPECT_THAT(cubes.error().message, HasSubstr("imageCubeArray"));
    EXPECT_FALSE(device->create_texture(
        {.name = "cubes", .dimension = Dimension::cube_array, .extent = {8, 8}, .layers = 12}));
    EXPECT_EQ(device->format_caps(Format::bc7_rgba_unorm), FormatCaps::none);
    EXPECT_FALSE(device->info().geometry_shader);
    EXPECT_EQ(device->info().limits.max_anisotropy, 1);
}

// -- a host's images

TEST_F(AdoptVulkan, ImagesComeInOneLayoutAndAreLeftInAnother) {
    OPEN_HOST();
    constexpr VkImageUsageFlags usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT |
                                        VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    const VkImage from = host->image(VK_FORMAT_R32G32B32A32_SFLOAT, side, usage);
    const VkImage to = host->image(VK_FORMAT_R32G32B32A32_SFLOAT, side, usage);
    const Texture source = adopted(from, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_GENERAL);
    const Texture target =
        adopted(to, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, TextureUsage::storage);
    const auto store = must(device->create_compute_pipeline<store_d2>());
    const auto sample = must(device->create_compute_pipeline<sample_d2>());
    const Sampler sampler = must(device->create_sampler({}));
    const std::vector<glm::vec4> middle(1, {0.5f, 0.5f, 0, 0});
    Buffer points = must(device->create_buffer({.name = "points", .size = 16}));
    Buffer results = must(device->create_buffer({.name = "results", .size = 16}));
    must(device->upload(points.slice(), bytes_of(middle)));
    for (int frame = 0; frame < 3; ++frame) {
        const float level = 0.25f * float(frame + 1);
        host->submit([&](VkCommandBuffer commands) {
            const VkClearColorValue value{.float32 = {level, 0, 0, 1}};
            const VkImageSubresourceRange range{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
            transition(commands, from, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
            vkCmdClearColorImage(commands, from, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &value, 1, &range);
        });
        {
            Commands commands = device->begin();
            Pass pass = commands.pass("use");
            pass.dispatch(sample,
                          {.source = {source.view<Dimension::d2>(), sampler},
                           .Points = points.slice(),
                           .Results = results.slice()},
                          {.count = 1, .lod = 0}, {1});
            pass.dispatch(store, {.target = target.mip<Dimension::d2>(0)},
                          {.size = {side, side, 1}, .base = float(frame)}, {4, 4, 1});
        }
        // Read by the host in the layouts that it asked for; no other synchronization than the queue's order.
        const auto left = values_of<glm::vec4>(host->download(from, VK_IMAGE_LAYOUT_GENERAL, side, 16));
        EXPECT_THAT(left, Each(glm::vec4(level, 0, 0, 1)));
        const auto stored =
            values_of<glm::vec4>(host->download(to, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, side, 16));
        for (uint32_t i = 0; i < side * side; ++i)
            ASSERT_EQ(stored[i].r, float(frame) + float(i % side + 16 * (i / side))) << i;
        EXPECT_EQ(values_of<glm::vec4>(must(device->download(results.slice())))[0].r, level);
    }
}

TEST_F(AdoptVulkan, ImagesAreDrawnIntoWithWhatTheyHold) {
    OPEN_HOST();
    constexpr auto attachment = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    const VkImage image = host->image(VK_FORMAT_R32G32B32A32_SFLOAT, side,
                                      VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                          VK_IMAGE_USAGE_TRANSFER_DST_BIT);
    host->submit([&](VkCommandBuffer commands) {
        const VkClearColorValue blue{.float32 = {0, 0, 1, 1}};
        const VkImageSubresourceRange range{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
        transition(commands, image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
        vkCmdClearColorImage(commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &blue, 1, &range);
        transition(commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, attachment);
    });
    const Texture target =
        adopted(image, attachment, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, TextureUsage::attachment);
    const auto draw = must(device->create_raster_pipeline<pull>(
        {.color = {{.format = Format::rgba32_float}}, .cull = CullMode::none}));
    // A triangle over the half below the diagonal.
    const std::vector<glm::vec4> corners{{-1, -1, 0, 1}, {1, 0, 0, 1},  {1, -1, 0, 1},
                                         {1, 0, 0, 1},   {-1, 1, 0, 1}, {1, 0, 0, 1}};
    Buffer vertices = must(device->create_buffer({.name = "vertices", .size = corners.size() * 16}));
    must(device->upload(vertices.slice(), bytes_of(corners)));
    {
        Commands commands = device->begin();
        commands.raster_pass("draw", {.color = {{.view = target.view(), .load = Load::keep}}})
            .draw(draw, {.Vertices = vertices.slice()}, {.tint = {1, 1, 1, 1}, .offset = {0, 0}},
                  Draw{.vertices = 3});
    }
    const auto texels =
        values_of<glm::vec4>(host->download(image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, side, 16));
    EXPECT_EQ(texels.front(), glm::vec4(1, 0, 0, 1)) << "row 0 of memory is NDC y = -1";
    EXPECT_EQ(texels.back(), glm::vec4(0, 0, 1, 1)) << "what the host drew";
}

TEST_F(AdoptVulkan, AllMipsAreLeftInTheLayoutAfterOneIsUsed) {
    OPEN_HOST();
    const VkImage image =
        host->image(VK_FORMAT_R32G32B32A32_SFLOAT, side,
                    VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, full_mips({side, side}));
    const Texture target =
        must(device->adopt_texture({.name = "pyramid",
                                    .format = Format::rgba32_float,
                                    .extent = {side, side},
                                    .mips = full_mips({side, side}),
                                    .usage = TextureUsage::storage},
                                   {.object = uint64_t(image),
                                    .layout_before = VK_IMAGE_LAYOUT_GENERAL,
                                    .layout_after = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL}));
    const auto store = must(device->create_compute_pipeline<store_d2>());
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
    for (uint32_t mip : {1u, 0u}) {
        host->submit(
            [&](VkCommandBuffer commands) { transition(commands, image, layout, VK_IMAGE_LAYOUT_GENERAL); });
        Commands commands = device->begin();
        commands.pass("store").dispatch(store, {.target = target.mip<Dimension::d2>(mip)},
                                        {.size = {side >> mip, side >> mip, 1}, .base = 7}, {4, 4, 1});
        device->submit(std::move(commands));
        layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    }
    EXPECT_EQ(values_of<glm::vec4>(host->download(image, layout, side, 16))[17].r, 24);
}

TEST_F(AdoptVulkan, AHostMakesItsImagesAnewWhileTheDeviceGoesOn) {
    OPEN_HOST();
    constexpr auto layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    const auto store = must(device->create_compute_pipeline<store_d2>());
    for (int i = 0; i < 4; ++i) {
        const VkImage image = host->image(VK_FORMAT_R32G32B32A32_SFLOAT, side,
                                          VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
        {
            const Texture target = adopted(image, VK_IMAGE_LAYOUT_UNDEFINED, layout, TextureUsage::storage);
            Commands commands = device->begin();
            commands.pass("store").dispatch(store, {.target = target.mip<Dimension::d2>(0)},
                                            {.size = {side, side, 1}, .base = float(i)}, {4, 4, 1});
            must(device->wait(device->submit(std::move(commands))));
        }
        EXPECT_EQ(values_of<glm::vec4>(host->download(image, layout, side, 16))[1].r, float(i + 1));
        host->destroy(image);
    }
}

TEST_F(AdoptVulkan, ALayoutThatTheImageIsNotInIsNoticed) {
    OPEN_HOST();
    const VkImage image = host->image(
        VK_FORMAT_R32G32B32A32_SFLOAT, side,
        VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT);
    host->submit([&](VkCommandBuffer commands) {
        transition(commands, image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    });
    const Texture wrong =
        adopted(image, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    (void)must(device->download(wrong, whole_mip(wrong.desc())));
    EXPECT_THAT(*host->messages(), Contains(HasSubstr("layout")));
    host->messages()->clear();
}

TEST_F(AdoptVulkan, ImagesOutliveTheirTexturesAndTheDevice) {
    OPEN_HOST();
    constexpr auto layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    const VkImage image = host->image(VK_FORMAT_R32G32B32A32_SFLOAT, side,
                                      VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
    const auto store = must(device->create_compute_pipeline<store_d2>());
    for (int i = 0; i < 3; ++i) {
        const Texture target = adopted(image, VK_IMAGE_LAYOUT_UNDEFINED, layout, TextureUsage::storage);
        Commands commands = device->begin();
        commands.pass("store").dispatch(store, {.target = target.mip<Dimension::d2>(0)},
                                        {.size = {side, side, 1}, .base = 1000.0f * float(i)}, {4, 4, 1});
    }
    EXPECT_EQ(values_of<glm::vec4>(host->download(image, layout, side, 16))[17].r, 2017);
    device.emplace(
        must(adopt(host->described())));  // the first one goes, with its work and its pipeline's owner
    EXPECT_EQ(values_of<glm::vec4>(host->download(image, layout, side, 16))[17].r, 2017);
    messages.clear();  // the pipeline outlived its device, on purpose
}

TEST_F(AdoptVulkan, BuffersAreWrittenByBothInTurns) {
    OPEN_HOST();
    constexpr uint32_t words = 256;
    const VulkanHost::Buffer mine =
        host->buffer(words * 4, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    std::memset(mine.mapped, 0, words * 4);
    const auto step = must(device->create_compute_pipeline<advance>());
    {
        const Buffer values = must(
            device->adopt_buffer({.name = "values", .size = words * 4}, {.object = uint64_t(mine.buffer)}));
        for (uint32_t frame = 0; frame < 3; ++frame) {
            // Half of them begin anew; no barrier but lumo's orders this behind what lumo wrote.
            host->submit([&](VkCommandBuffer commands) {
                vkCmdFillBuffer(commands, mine.buffer, 0, words * 2, frame);
            });
            Commands commands = device->begin();
            Pass pass = commands.pass("step");
            for (int i = 0; i < 2; ++i) pass.dispatch(step, {.Values = values.slice()}, {}, {4});
        }
    }
    host->submit(show_to_cpu);
    host->wait_idle();
    const auto* values = static_cast<const uint32_t*>(mine.mapped);
    // Twice x -> 3 x + 1, from 2 by the host's last fill, or six times from 0.
    EXPECT_THAT(std::span(values, words / 2), Each(22u));
    EXPECT_THAT(std::span(values + words / 2, words / 2), Each(364u));
}

TEST_F(AdoptVulkan, WhatIsNoImageOfAHostsIsRefused) {
    OPEN_HOST();
    const VkImage image = host->image(VK_FORMAT_R8G8B8A8_UNORM, side, VK_IMAGE_USAGE_SAMPLED_BIT);
    const TextureDesc desc{.name = "picture", .extent = {side, side}};
    const auto undefined = device->adopt_texture(desc, {.object = uint64_t(image)});
    ASSERT_FALSE(undefined);
    EXPECT_EQ(undefined.error().kind, ErrorKind::invalid_argument);
    EXPECT_THAT(undefined.error().message, HasSubstr("layout_after"));
    const uint32_t general = VK_IMAGE_LAYOUT_GENERAL;
    EXPECT_FALSE(device->adopt_texture(desc, {.object = 0, .layout_after = general}));
    auto own = open_device(Api::vulkan, {.name = host->device_name()});
    ASSERT_TRUE(own);
    const auto stranger = own->device->adopt_texture(
        desc, {.object = uint64_t(image), .layout_before = general, .layout_after = general});
    ASSERT_FALSE(stranger);
    EXPECT_EQ(stranger.error().kind, ErrorKind::unsupported);
    EXPECT_FALSE(own->device->adopt_buffer({.name = "values", .size = 4}, {.object = uint64_t(image)}));
}

// -- semaphores

TEST_F(AdoptVulkan, WorkWaitsForTimelineSemaphoresAndSignalsThem) {
    OPEN_HOST();
    const VkSemaphore semaphore = host->semaphore(true);
    Buffer values = must(device->create_buffer({.name = "values", .size = 256}));
    Commands commands = device->begin();
    commands.wait({.object = uint64_t(semaphore), .value = 5});
    commands.signal({.object = uint64_t(semaphore), .value = 6});
    commands.pass("fill").fill(values.slice(), 9);
    const Submission waiting = device->submit(std::move(commands));
    uint64_t value = 6;
    const VkSemaphoreWaitInfo done{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO,
                                   .semaphoreCount = 1,
                                   .pSemaphores = &semaphore,
                                   .pValues = &value};
    EXPECT_EQ(vkWaitSemaphores(host->device(), &done, 50'000'000), VK_TIMEOUT) << "it did not wait";
    EXPECT_FALSE(device->finished(waiting));
    const VkSemaphoreSignalInfo go{
        .sType = VK_STRUCTURE_TYPE_SEMAPHORE_SIGNAL_INFO, .semaphore = semaphore, .value = 5};
    ASSERT_EQ(vkSignalSemaphore(host->device(), &go), VK_SUCCESS);
    constexpr uint64_t ten_seconds = 10'000'000'000;
    EXPECT_EQ(vkWaitSemaphores(host->device(), &done, ten_seconds), VK_SUCCESS) << "it did not signal";
    EXPECT_EQ(values_of<uint32_t>(must(device->download(values.slice())))[0], 9u);
}

TEST_F(AdoptVulkan, BinarySemaphoresGoBothWays) {
    OPEN_HOST();
    const VkSemaphore to_lumo = host->semaphore(false), to_host = host->semaphore(false);
    const VkImage image = host->image(VK_FORMAT_R32G32B32A32_SFLOAT, side,
                                      VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
    const Texture target =
        adopted(image, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_GENERAL, TextureUsage::storage);
    const auto store = must(device->create_compute_pipeline<store_d2>());
    for (int frame = 0; frame < 3; ++frame) {
        host->submit(
            [&](VkCommandBuffer commands) {
                transition(commands, image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
            },
            VK_NULL_HANDLE, to_lumo);
        Commands commands = device->begin();
        commands.wait({.object = uint64_t(to_lumo)});
        commands.pass("store").dispatch(store, {.target = target.mip<Dimension::d2>(0)},
                                        {.size = {side, side, 1}, .base = float(frame)}, {4, 4, 1});
        commands.signal({.object = uint64_t(to_host)});
        device->submit(std::move(commands));
        // The layers object to a binary semaphore that is waited for without a signal on its way.
        host->submit([](VkCommandBuffer) {}, to_host);
        EXPECT_EQ(values_of<glm::vec4>(host->download(image, VK_IMAGE_LAYOUT_GENERAL, side, 16))[3].r,
                  float(frame + 3));
    }
}

TEST_F(AdoptVulkan, SemaphoresOfNoHostAreRefused) {
    OPEN_HOST();
    auto own = open_device(Api::vulkan, {.name = host->device_name()});
    ASSERT_TRUE(own);
    const VkSemaphore semaphore = host->semaphore(false);
    own->device->begin().wait({.object = uint64_t(semaphore)});
    EXPECT_THAT(own->take_failures(), SizeIs(1));
}

// -- the host's own loader

std::map<std::string, int> looked_up;
std::map<std::string, int> called;

template <size_t name, class F>
struct Counted;
template <size_t name, class Result, class... Arguments>
struct Counted<name, Result (*)(Arguments...)> {
    static inline Result (*real)(Arguments...) = nullptr;
    static inline const char* function = nullptr;
    static Result call(Arguments... arguments) {
        ++called[function];
        return real(arguments...);
    }
};
template <size_t name, class F>
PFN_vkVoidFunction counted(const char* function, PFN_vkVoidFunction real) {
    Counted<name, F>::real = reinterpret_cast<F>(real);
    Counted<name, F>::function = function;
    return reinterpret_cast<PFN_vkVoidFunction>(&Counted<name, F>::call);
}

/// Pools that hold what they were made for and no more: software drivers do not count.
struct StrictPool {
    uint32_t sets, used;
};
std::map<VkDescriptorPool, StrictPool> strict_pools;

VkResult VKAPI_CALL create_strict_pool(VkDevice device, const VkDescriptorPoolCreateInfo* info,
                                       const VkAllocationCallbacks* memory, VkDescriptorPool* pool) {
    const VkResult result = vkCreateDescriptorPool(device, info, memory, pool);
    if (result == VK_SUCCESS) strict_pools[*pool] = {info->maxSets, 0};
    return result;
}

VkResult VKAPI_CALL reset_strict_pool(VkDevice device, VkDescriptorPool pool,
                                      VkDescriptorPoolResetFlags flags) {
    strict_pools.at(pool).used = 0;
    return vkResetDescriptorPool(device, pool, flags);
}

VkResult VKAPI_CALL allocate_strictly(VkDevice device, const VkDescriptorSetAllocateInfo* info,
                                      VkDescriptorSet* sets) {
    StrictPool& pool = strict_pools.at(info->descriptorPool);
    if (pool.used + info->descriptorSetCount > pool.sets) return VK_ERROR_OUT_OF_POOL_MEMORY;
    pool.used += info->descriptorSetCount;
    return vkAllocateDescriptorSets(device, info, sets);
}

PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice device, const char* name) {
    ++looked_up[name];
    const auto real = vkGetDeviceProcAddr(device, name);
    const std::string_view wanted = name;
    if (wanted == "vkQueueSubmit2") return counted<0, PFN_vkQueueSubmit2>("vkQueueSubmit2", real);
    if (wanted == "vkCreateBuffer") return counted<1, PFN_vkCreateBuffer>("vkCreateBuffer", real);
    if (wanted == "vkDestroyBuffer") return counted<2, PFN_vkDestroyBuffer>("vkDestroyBuffer", real);
    if (wanted == "vkDestroyDevice") return counted<3, PFN_vkDestroyDevice>("vkDestroyDevice", real);
    if (wanted == "vkDeviceWaitIdle") return counted<4, PFN_vkDeviceWaitIdle>("vkDeviceWaitIdle", real);
    if (wanted == "vkCreateDescriptorPool") return reinterpret_cast<PFN_vkVoidFunction>(create_strict_pool);
    if (wanted == "vkResetDescriptorPool") return reinterpret_cast<PFN_vkVoidFunction>(reset_strict_pool);
    if (wanted == "vkAllocateDescriptorSets") return reinterpret_cast<PFN_vkVoidFunction>(allocate_strictly);
    return real;
}

PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance instance, const char* name) {
    ++looked_up[name];
    const auto real = vkGetInstanceProcAddr(instance, name);
    const std::string_view wanted = name;
    if (wanted == "vkGetDeviceProcAddr") return reinterpret_cast<PFN_vkVoidFunction>(device_function);
    if (wanted == "vkDestroyInstance") return counted<5, PFN_vkDestroyInstance>("vkDestroyInstance", real);
    if (wanted == "vkGetPhysicalDeviceFeatures2")
        return counted<6, PFN_vkGetPhysicalDeviceFeatures2>("vkGetPhysicalDeviceFeatures2", real);
    return real;
}

TEST_F(AdoptVulkan, EveryCallGoesThroughTheHostsLoader) {
    OPEN_HOST();
    looked_up.clear();
    called.clear();
    HostDevice described = host->described();
    described.get_instance_proc_addr = instance_function;
    {
        Device counting = must(adopt(described));
        Buffer values = must(counting.create_buffer({.name = "values", .size = 256}));
        must(counting.upload(values.slice(), std::vector<std::byte>(256)));
    }
    EXPECT_EQ(looked_up["vkGetDeviceProcAddr"], 1);
    EXPECT_EQ(looked_up["vkCreateComputePipelines"], 1);
    EXPECT_EQ(called["vkQueueSubmit2"], 1);
    EXPECT_GT(called["vkCreateBuffer"], 0);
    EXPECT_EQ(called["vkCreateBuffer"], called["vkDestroyBuffer"]);
    EXPECT_EQ(called["vkGetPhysicalDeviceFeatures2"], 0) << "a host's features are those that it enabled";
    EXPECT_EQ(called["vkDeviceWaitIdle"], 0) << "the host's other queues are not lumo's to wait for";
    EXPECT_EQ(called["vkDestroyDevice"], 0);
    EXPECT_EQ(called["vkDestroyInstance"], 0);
}

TEST_F(AdoptVulkan, DescriptorPoolsGrowWithASubmissionAndAreUsedAgain) {
    OPEN_HOST();
    strict_pools.clear();
    HostDevice described = host->described();
    described.get_instance_proc_addr = instance_function;
    Device counting = must(adopt(described));
    const std::vector<uint32_t> first = work_on(counting);
    const size_t pools = strict_pools.size();
    EXPECT_GE(pools, 4u) << "one pool was enough for all";
    EXPECT_EQ(work_on(counting), first);
    EXPECT_EQ(strict_pools.size(), pools);
    EXPECT_EQ(work_on(*device), first);
}

TEST_F(AdoptVulkan, ALoaderWithoutFunctionsIsRefused) {
    OPEN_HOST();
    HostDevice described = host->described();
    described.get_instance_proc_addr = [](VkInstance, const char*) -> PFN_vkVoidFunction { return nullptr; };
    const auto refused = adopt(described);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("get_instance_proc_addr"));
}

TEST_F(AdoptVulkan, DevicesOfBothKindsWorkSideBySide) {
    OPEN_HOST();
    auto own = open_device(Api::vulkan, {.name = host->device_name()});
    ASSERT_TRUE(own);
    Device second = must(adopt(host->described()));
    std::vector<Device*> devices{&*device, &*own->device, &second};
    std::vector<Buffer> buffers;
    for (Device* each : devices)
        buffers.push_back(must(each->create_buffer({.name = "values", .size = 256})));
    for (uint32_t round = 0; round < 4; ++round)
        for (size_t i = 0; i < devices.size(); ++i) {
            Commands commands = devices[i]->begin();
            commands.pass("fill").fill(buffers[i].slice(), round * 10 + uint32_t(i));
        }
    for (size_t i = 0; i < devices.size(); ++i)
        EXPECT_THAT(values_of<uint32_t>(must(devices[i]->download(buffers[i].slice()))),
                    Each(30 + uint32_t(i)));
    buffers.clear();
    EXPECT_THAT(own->take_failures(), IsEmpty());
}

}  // namespace
}  // namespace lumo::rhi
