// lumo in a host's OpenGL context: what it draws, what it takes and refuses, and that the host finds all as it was.
#include <algorithm>
#include <glm/vec4.hpp>

#include "backends/gl/adopt.hpp"
#include "samples/embed-gl/state_dump.hpp"
#include "shaders/test_rhi/sample_d2.hpp"
#include "shaders/test_rhi/store_d2.hpp"
#include "tests/adopt/every_operation.hpp"
#include "tests/adopt/gl_host.hpp"
#include "tests/support/device_test.hpp"

namespace lumo::rhi {
namespace {

using namespace testing_support;
using namespace shaders::test_rhi;
using enum Dimension;
using backends::gl::adopt_current_context;
using embed::differences;
using testing::AllOf;
using testing::AnyOf;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;

/// A host of its own for each test, and what lumo says there.
struct AdoptGlTest : testing::Test {
    void SetUp() override {
        host = GlHost::make();
        if (!host) {
            ASSERT_FALSE(open_device(Api::gl)) << "EGL makes a context for lumo, and none for the host";
            GTEST_SKIP() << "there is no OpenGL device";
        }
    }
    void TearDown() override {
        for (const Message& message : *messages)
            if (is_failure(message)) ADD_FAILURE() << message.id << ": " << message.text;
    }

    DeviceDesc desc(bool validation = true, Timing timing = Timing::automatic) {
        return {.validation = validation, .timing = timing, .sink = [messages = messages](const Message& m) {
                    messages->push_back(m);
                }};
    }
    Result<Device> adopt() { return adopt_current_context(desc()); }
    std::vector<Message> take_messages() { return std::exchange(*messages, {}); }

    std::unique_ptr<GlHost> host;
    std::shared_ptr<std::vector<Message>> messages = std::make_shared<std::vector<Message>>();
};

// -- state

void expect_equal(const std::vector<std::byte>& adopted, const std::vector<std::byte>& own) {
    ASSERT_EQ(adopted.size(), own.size());
    const auto [a, o] = std::ranges::mismatch(adopted, own);
    if (a != adopted.end())
        ADD_FAILURE() << "byte " << a - adopted.begin() << " is " << int(*a) << ", not " << int(*o)
                      << " as on an own device";
}

TEST_F(AdoptGlTest, StateIsAsItWasAndResultsAreThoseOfAnOwnDevice) {
    const std::vector<Operation> operations = every_operation();
    std::vector<std::vector<std::byte>> own;
    {
        auto checked = open_device(Api::gl);
        ASSERT_TRUE(checked);
        for (const Operation& operation : operations) own.push_back(operation.run(*checked->device));
    }
    // Where there are but two values, lumo's is either the usual or the other.
    for (const auto& [unusual, timing] :
         {std::pair(false, Timing::serialised), {true, Timing::serialised}, {true, Timing::overlapped}}) {
        host = GlHost::make();
        if (unusual) set_unusual_state();
        const embed::StateDump before = embed::dump_state();
        for (size_t i = 0; i < operations.size(); ++i) {
            SCOPED_TRACE(operations[i].name);
            {
                Device device = must(adopt_current_context(desc(true, timing)));
                expect_equal(operations[i].run(device), own[i]);
                EXPECT_THAT(differences(before, embed::dump_state()), IsEmpty());
            }
            EXPECT_THAT(differences(before, embed::dump_state()), IsEmpty()) << "after the device went";
            for (const Message& message : take_messages())
                if (is_failure(message)) ADD_FAILURE() << message.id << ": " << message.text;
        }
    }
}

TEST_F(AdoptGlTest, MakingADeviceChangesNoState) {
    set_unusual_state();
    const embed::StateDump before = embed::dump_state();
    Device device = must(adopt());
    EXPECT_THAT(differences(before, embed::dump_state()), IsEmpty());
}

TEST_F(AdoptGlTest, NoObjectIsLeftBehind) {
    const auto before = named_objects();
    for (const Operation& operation : every_operation()) {
        {
            Device device = must(adopt_current_context(desc(true, Timing::overlapped)));
            operation.run(device);
        }
        EXPECT_THAT(named_objects(), before) << operation.name;
    }
}

/// Else a state that lumo forgets to give back could be the default, and not be missed.
TEST_F(AdoptGlTest, TheUnusualStateIsUnusualThroughout) {
    const embed::StateDump usual = embed::dump_state();
    const std::vector<std::string> constant = set_unusual_state();
    for (const auto& [name, value] : embed::dump_state()) {
        if (name.starts_with("texture ") || std::ranges::find(constant, name) != constant.end()) continue;
        const auto found = usual.find(name);
        if (found == usual.end()) continue;
        EXPECT_NE(value, found->second) << name;
    }
}

/// With no program in use, those of the pipeline object are, and their subroutines are reset as well.
TEST_F(AdoptGlTest, SubroutinesOfAPipelineObjectAreKept) {
    const char* vertex = R"(#version 450
        out gl_PerVertex { vec4 gl_Position; };
        subroutine vec4 Pick();
        layout(index = 0) subroutine(Pick) vec4 first() { return vec4(1); }
        layout(index = 1) subroutine(Pick) vec4 second() { return vec4(2); }
        layout(location = 0) subroutine uniform Pick pick;
        void main() { gl_Position = pick(); })";
    GLuint pipeline = 0;
    glCreateProgramPipelines(1, &pipeline);
    glUseProgramStages(pipeline, GL_VERTEX_SHADER_BIT, glCreateShaderProgramv(GL_VERTEX_SHADER, 1, &vertex));
    glBindProgramPipeline(pipeline);
    const GLuint second = 1;
    glUniformSubroutinesuiv(GL_VERTEX_SHADER, 1, &second);
    {
        Device device = must(adopt());
        for (const Operation& operation : every_operation())
            if (operation.name.starts_with("draw")) operation.run(device);
    }
    GLuint chosen = 0;
    glGetUniformSubroutineuiv(GL_VERTEX_SHADER, 0, &chosen);
    EXPECT_EQ(chosen, second);
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

TEST_F(AdoptGlTest, AnOpenSubmissionGivesBackWhenTheDeviceGoes) {
    set_unusual_state();
    const embed::StateDump before = embed::dump_state();
    {
        Device device = must(adopt());
        Buffer values = must(device.create_buffer({.name = "values", .size = 64}));
        Commands commands = device.begin();
        commands.pass("fill").fill(values.slice(), 1);
    }
    EXPECT_THAT(differences(before, embed::dump_state()), IsEmpty());
}

// -- refusals

/// What a host hears whose context is another.
std::string refusal_of(const HostDesc& host_desc) {
    const auto host = GlHost::make(host_desc);
    if (!host) return "the driver makes no such context";
    const auto refused = adopt_current_context();
    return refused ? "it is taken" : to_string(refused.error());
}

TEST(AdoptGlRefusalTest, OtherProfilesAreToldWhatIsRequired) {
    const auto required = HasSubstr("make an OpenGL 4.5 core context current");
    const auto none = HasSubstr("no such context");
    EXPECT_THAT(refusal_of({.compatibility = true}),
                AnyOf(none, AllOf(HasSubstr("compatibility profile"), required)));
    EXPECT_THAT(refusal_of({.major = 3, .minor = 2, .es = true}),
                AnyOf(none, AllOf(HasSubstr("OpenGL ES 3.2"), required)));
}

/// Mesa gives the newest version to whoever asks for an older one, unless the environment forbids it from the start.
TEST(AdoptGlRefusalTest, OlderVersionsAreToldWhatIsRequired) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    for (const auto& [version, host] :
         std::vector<std::pair<std::string, HostDesc>>{{"3.3", {.major = 3, .minor = 3, .debug = false}},
                                                       {"4.4", {.major = 4, .minor = 4, .debug = false}}}) {
        EXPECT_EXIT(
            {
                setenv("MESA_GL_VERSION_OVERRIDE", version.c_str(), 1);
                std::fprintf(stderr, "%s\n", refusal_of(host).c_str());
                std::_Exit(0);
            },
            testing::ExitedWithCode(0), "OpenGL " + version + ".*make an OpenGL 4.5 core context current");
    }
}

TEST_F(AdoptGlTest, NoCurrentContextIsRefused) {
    host->release();
    const auto refused = adopt();
    ASSERT_FALSE(refused);
    EXPECT_THAT(to_string(refused.error()), HasSubstr("current context"));
}

TEST_F(AdoptGlTest, AnotherDeviceThanTheNamedIsRefused) {
    const auto refused = adopt_current_context({.name = "no such device"});
    ASSERT_FALSE(refused);
    EXPECT_THAT(to_string(refused.error()), HasSubstr("no such device"));
}

TEST_F(AdoptGlTest, CallsWithoutTheHostsContextAreErrors) {
    Device device = must(adopt());
    {
        Buffer values = must(device.create_buffer({.name = "values", .size = 64}));
        host->release();
        const auto refused = device.create_buffer({.name = "more", .size = 64});
        ASSERT_FALSE(refused);
        EXPECT_THAT(to_string(refused.error()), HasSubstr("not current"));
        {
            Commands commands = device.begin();
            commands.pass("nothing").fill(values.slice(), 1);
        }
        const std::vector<Message> said = take_messages();
        ASSERT_FALSE(said.empty());
        EXPECT_THAT(said[0].text, HasSubstr("not current"));
        host->make_current();
        must(device.download(values.slice()));
    }
    must(device.create_buffer({.name = "more", .size = 64}));
}

// -- textures

struct AdoptGlTextureTest : AdoptGlTest {
    void SetUp() override {
        AdoptGlTest::SetUp();
        if (host) device.emplace(must(adopt()));
    }
    void TearDown() override {
        device.reset();
        AdoptGlTest::TearDown();
    }
    static GLuint make(GLenum target, GLsizei mips, GLenum format, GLsizei width, GLsizei height,
                       GLsizei depth = 0) {
        GLuint name = 0;
        glCreateTextures(target, 1, &name);
        if (depth) {
            glTextureStorage3D(name, mips, format, width, height, depth);
        } else {
            glTextureStorage2D(name, mips, format, width, height);
        }
        return name;
    }
    std::string refusal(GLuint name, const TextureDesc& desc) {
        const auto refused = device->adopt_texture(desc, {.object = name});
        return refused ? "none" : to_string(refused.error());
    }
    std::optional<Device> device;
    const TextureDesc flat{.name = "host's", .format = Format::rgba32_float, .extent = {8, 4, 1}};
};

TEST_F(AdoptGlTextureTest, WhatIsNotAsDescribedIsRefused) {
    const GLuint name = make(GL_TEXTURE_2D, 3, GL_RGBA32F, 8, 4);
    TextureDesc right = flat;
    right.mips = 3;
    EXPECT_EQ(refusal(name, right), "none");
    const auto with = [&](auto member, auto value) {
        TextureDesc wrong = right;
        wrong.*member = value;
        return wrong;
    };
    EXPECT_THAT(refusal(name, with(&TextureDesc::mips, 2u)), HasSubstr("its mips is 3, not 2"));
    EXPECT_THAT(refusal(name, with(&TextureDesc::format, Format::rgba16_float)),
                HasSubstr("its internal format is 0x8814, not 0x881a"));
    EXPECT_THAT(refusal(name, with(&TextureDesc::extent, Extent{9, 4, 1})),
                HasSubstr("its width is 8, not 9"));
    EXPECT_THAT(refusal(name, with(&TextureDesc::extent, Extent{8, 5, 1})),
                HasSubstr("its height is 4, not 5"));
    EXPECT_THAT(refusal(name, with(&TextureDesc::dimension, d3)), HasSubstr("its target is 0xde1"));
    EXPECT_THAT(refusal(name + 1000, right), HasSubstr("not the name of a texture"));
    EXPECT_THAT(refusal(0, right), HasSubstr("host's"));

    const GLuint layers = make(GL_TEXTURE_2D_ARRAY, 1, GL_RGBA32F, 8, 4, 3);
    TextureDesc array = flat;
    array.dimension = d2_array;
    array.layers = 2;
    EXPECT_THAT(refusal(layers, array), HasSubstr("its depth or layers is 3, not 2"));
    array.layers = 3;
    EXPECT_EQ(refusal(layers, array), "none");

    GLuint mutable_storage = 0;
    glGenTextures(1, &mutable_storage);
    glBindTexture(GL_TEXTURE_2D, mutable_storage);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 8, 4, 0, GL_RGBA, GL_FLOAT, nullptr);
    EXPECT_THAT(refusal(mutable_storage, flat), HasSubstr("its immutable storage is 0, not 1"));
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

TEST_F(AdoptGlTextureTest, EveryShapeIsTaken) {
    const auto taken = [&](GLuint name, Dimension dimension, Extent extent, uint32_t layers, uint32_t mips) {
        EXPECT_EQ(refusal(name, {.name = "shape",
                                 .dimension = dimension,
                                 .format = Format::rgba8_unorm,
                                 .extent = extent,
                                 .layers = layers,
                                 .mips = mips}),
                  "none");
    };
    taken(make(GL_TEXTURE_3D, 2, GL_RGBA8, 8, 4, 6), d3, {8, 4, 6}, 1, 2);
    taken(make(GL_TEXTURE_CUBE_MAP, 2, GL_RGBA8, 8, 8), cube, {8, 8, 1}, 6, 2);
    taken(make(GL_TEXTURE_CUBE_MAP_ARRAY, 1, GL_RGBA8, 8, 8, 12), cube_array, {8, 8, 1}, 12, 1);
    taken(make(GL_TEXTURE_1D_ARRAY, 2, GL_RGBA8, 8, 5), d1_array, {8, 1, 1}, 5, 2);
}

/// The host's texture, as it reads it by itself.
std::vector<glm::vec4> texels_of(GLuint name) {
    std::vector<glm::vec4> texels(8 * 4);
    glGetTextureImage(name, 0, GL_RGBA, GL_FLOAT, GLsizei(texels.size() * sizeof(glm::vec4)), texels.data());
    return texels;
}

TEST_F(AdoptGlTextureTest, WhatLumoStoresTheHostReadsAndTheOtherWayRound) {
    const GLuint name = make(GL_TEXTURE_2D, 1, GL_RGBA32F, 8, 4);
    const std::vector<glm::vec4> given(8 * 4, glm::vec4(1, 2, 3, 4));
    glTextureSubImage2D(name, 0, 0, 0, 8, 4, GL_RGBA, GL_FLOAT, given.data());

    TextureDesc desc = flat;
    desc.usage = TextureUsage::sampled | TextureUsage::storage;
    const Texture texture = must(device->adopt_texture(desc, {.object = name}));
    EXPECT_THAT(values_of<glm::vec4>(must(device->download(texture, whole_mip(desc)))),
                Each(glm::vec4(1, 2, 3, 4)));

    const auto pipeline = must(device->create_compute_pipeline<store_d2>());
    Commands commands = device->begin();
    commands.pass("store").dispatch(pipeline, {texture.view<d2>()}, {.size = {8, 4, 1}, .base = 100},
                                    {2, 1, 1});
    device->submit(std::move(commands));
    const auto texels = texels_of(name);
    for (size_t i = 0; i < texels.size(); ++i)
        EXPECT_EQ(texels[i].r, 100.0f + float(i % 8) + 16.0f * float(i / 8)) << i;
}

TEST_F(AdoptGlTextureTest, TheHostsParametersAndNameStayItsOwn) {
    const GLuint name = make(GL_TEXTURE_2D, 2, GL_RGBA32F, 8, 4);
    const std::vector<glm::vec4> given(8 * 4, glm::vec4(1, 2, 3, 4));
    glTextureSubImage2D(name, 0, 0, 0, 8, 4, GL_RGBA, GL_FLOAT, given.data());
    glTextureParameteri(name, GL_TEXTURE_BASE_LEVEL, 1);
    glTextureParameteri(name, GL_TEXTURE_SWIZZLE_R, GL_ZERO);
    const char label[] = "the host's label";
    glObjectLabel(GL_TEXTURE, name, -1, label);

    TextureDesc desc = flat;
    desc.mips = 2;
    desc.usage = TextureUsage::sampled | TextureUsage::attachment;
    Texture texture = must(device->adopt_texture(desc, {.object = name}));
    Buffer points = must(device->create_buffer({.name = "points", .size = 16}));
    Buffer results = must(device->create_buffer({.name = "results", .size = 16}));
    must(device->upload(points.slice(), bytes_of(std::vector<glm::vec4>{{0.5f, 0.5f, 0, 0}})));
    const Sampler sampler = must(device->create_sampler({}));
    const auto pipeline = must(device->create_compute_pipeline<sample_d2>());
    Commands commands = device->begin();
    {
        Pass pass = commands.pass("sample");
        pass.dispatch(
            pipeline,
            {.source = {texture.view<d2>(), sampler}, .Points = points.slice(), .Results = results.slice()},
            {.count = 1, .lod = 0}, {1});
        pass.generate_mips(texture);
    }
    device->submit(std::move(commands));
    EXPECT_THAT(values_of<glm::vec4>(must(device->download(results.slice()))), Each(glm::vec4(1, 2, 3, 4)));

    GLint base = 0, swizzle = 0;
    glGetTextureParameteriv(name, GL_TEXTURE_BASE_LEVEL, &base);
    glGetTextureParameteriv(name, GL_TEXTURE_SWIZZLE_R, &swizzle);
    std::array<char, 64> found{};
    glGetObjectLabel(GL_TEXTURE, name, found.size(), nullptr, found.data());
    EXPECT_EQ(base, 1);
    EXPECT_EQ(swizzle, GL_ZERO);
    EXPECT_STREQ(found.data(), label);

    texture = {};
    EXPECT_EQ(texels_of(name)[0], glm::vec4(1, 2, 3, 4)) << "it lives";
    texture = must(device->adopt_texture(desc, {.object = name}));
    glDeleteTextures(1, &name);
    EXPECT_THAT(values_of<glm::vec4>(must(device->download(texture, whole_mip(desc)))),
                Each(glm::vec4(1, 2, 3, 4)))
        << "the host may delete its name first";
}

TEST_F(AdoptGlTest, AnOwnDeviceTakesNoTextureOfAHost) {
    auto checked = open_device(Api::gl);
    ASSERT_TRUE(checked);
    const auto refused = checked->device->adopt_texture({.name = "texture"}, {.object = 1});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::unsupported);
}

TEST_F(AdoptGlTest, TheHostGoesOnWhenLumoIsGone) {
    GLuint name = AdoptGlTextureTest::make(GL_TEXTURE_2D, 1, GL_RGBA32F, 8, 4);
    const std::vector<glm::vec4> given(8 * 4, glm::vec4(4, 3, 2, 1));
    {
        Device device = must(adopt());
        const TextureDesc desc{.name = "host's", .format = Format::rgba32_float, .extent = {8, 4, 1}};
        const Texture texture = must(device.adopt_texture(desc, {.object = name}));
        must(device.upload(texture, whole_mip(desc), bytes_of(given)));
    }
    EXPECT_EQ(texels_of(name), given);
    Device again = must(adopt());
    EXPECT_TRUE(again.create_buffer({.name = "values", .size = 64}));
}

// -- what the host hears and waits for

void GLAPIENTRY count(GLenum, GLenum, GLuint, GLenum severity, GLsizei, const GLchar*, const void* counter) {
    if (severity != GL_DEBUG_SEVERITY_NOTIFICATION) ++*static_cast<int*>(const_cast<void*>(counter));
}

TEST_F(AdoptGlTest, TheHostsCallbackStaysAndHearsNothingBad) {
    int heard = 0;
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(count, &heard);
    {
        Device device = must(adopt());
        EXPECT_FALSE(device.info().validation) << "messages go to the host";
        for (const Operation& operation : every_operation()) {
            operation.run(device);
            EXPECT_EQ(std::exchange(heard, 0), 0) << operation.name;
        }
        GLvoid* callback = nullptr;
        glGetPointerv(GL_DEBUG_CALLBACK_FUNCTION, &callback);
        EXPECT_EQ(callback, reinterpret_cast<GLvoid*>(count));
    }
    EXPECT_EQ(heard, 0);
    EXPECT_THAT(take_messages(), IsEmpty());
}

TEST_F(AdoptGlTest, WithoutACallbackLumoListensWhileItRecords) {
    Device device = must(adopt());
    EXPECT_TRUE(device.info().validation);
    Commands commands = device.begin();
    glEnable(0xffff);  // as if lumo had done it
    glGetError();
    device.submit(std::move(commands));
    std::vector<Message> said = take_messages();
    ASSERT_EQ(said.size(), 1u);
    EXPECT_EQ(said[0].severity, Severity::error);
    glEnable(0xffff);
    glGetError();
    EXPECT_THAT(take_messages(), IsEmpty()) << "between submissions nobody listens";
}

TEST_F(AdoptGlTest, ErrorsThatTheHostLeftAreNotLumos) {
    Device device = must(adopt());
    glEnable(0xffff);
    Buffer values = must(device.create_buffer({.name = "values", .size = 64}));
    std::vector<Message> said = take_messages();
    ASSERT_EQ(said.size(), 1u);
    EXPECT_EQ(said[0].severity, Severity::low);
    EXPECT_THAT(said[0].text, HasSubstr("0x500"));
    glEnable(0xffff);
    must(device.download(values.slice()));
}

TEST_F(AdoptGlTest, ASubmissionWaitsForAnotherContextsFence) {
    const GLuint name = AdoptGlTextureTest::make(GL_TEXTURE_2D, 1, GL_RGBA32F, 8, 4);
    Device device = must(adopt());
    const TextureDesc desc{.name = "host's", .format = Format::rgba32_float, .extent = {8, 4, 1}};
    const Texture texture = must(device.adopt_texture(desc, {.object = name}));

    auto loader = GlHost::make({}, host.get());
    ASSERT_TRUE(loader);
    const std::array<float, 4> value{5, 6, 7, 8};
    glClearTexImage(name, 0, GL_RGBA, GL_FLOAT, value.data());
    GLsync fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();
    host->make_current();

    Commands commands = device.begin();
    commands.wait({.object = reinterpret_cast<uint64_t>(fence)});
    Readback ticket;
    {
        Pass pass = commands.pass("read");
        ticket = pass.read(texture, whole_mip(desc));
    }
    device.submit(std::move(commands));
    EXPECT_THAT(values_of<glm::vec4>(must(device.take(ticket))), Each(glm::vec4(5, 6, 7, 8)));
    glDeleteSync(fence);
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

TEST_F(AdoptGlTest, WhatIsNoFenceIsNotWaitedForAndNothingIsSignalled) {
    Device device = must(adopt());
    Commands commands = device.begin();
    commands.wait({.object = 12345});
    EXPECT_THAT(take_messages(), testing::ElementsAre(testing::Field(&Message::text, HasSubstr("GLsync"))));
    commands.signal({.object = 12345});
    EXPECT_THAT(take_messages(),
                testing::ElementsAre(testing::Field(&Message::text, HasSubstr("glFenceSync"))));
    device.submit(std::move(commands));
    EXPECT_TRUE(device.create_buffer({.name = "values", .size = 64}));
}

}  // namespace
}  // namespace lumo::rhi
