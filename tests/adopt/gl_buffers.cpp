// A host's buffers in its OpenGL context, written by it and by lumo in turns.
#include "backends/gl/adopt.hpp"
#include "shaders/test_rhi/advance.hpp"
#include "tests/adopt/gl_host.hpp"
#include "tests/support/device_test.hpp"

namespace lumo::rhi {
namespace {

using namespace testing_support;
using shaders::test_rhi::advance;
using testing::Each;
using testing::HasSubstr;

TEST(AdoptGlBuffers, AreWrittenByBothInTurns) {
    const auto host = GlHost::make();
    if (!host) {
        ASSERT_FALSE(open_device(Api::gl)) << "EGL makes a context for lumo, and none for the host";
        GTEST_SKIP() << "there is no OpenGL device";
    }
    constexpr uint32_t words = 256;
    std::vector<Message> messages;
    GLuint mine = 0;
    glCreateBuffers(1, &mine);
    glNamedBufferStorage(mine, words * 4, nullptr, 0);
    const auto clear = [&](GLuint first, GLuint count, GLuint value) {
        glClearNamedBufferSubData(mine, GL_R32UI, GLintptr(first) * 4, GLsizeiptr(count) * 4, GL_RED_INTEGER,
                                  GL_UNSIGNED_INT, &value);
    };
    clear(0, words, 0);
    {
        Device device = must(backends::gl::adopt_current_context(
            {.sink = [&](const Message& message) { messages.push_back(message); }}));
        const auto step = must(device.create_compute_pipeline<advance>());
        {
            const Buffer values =
                must(device.adopt_buffer({.name = "values", .size = words * 4}, {.object = mine}));
            for (uint32_t frame = 0; frame < 3; ++frame) {
                clear(0, words / 2, frame);  // half of them begin anew
                Commands commands = device.begin();
                Pass pass = commands.pass("step");
                for (int i = 0; i < 2; ++i) pass.dispatch(step, {.Values = values.slice()}, {}, {4});
            }
        }
        const auto none = device.adopt_buffer({.name = "none", .size = 4}, {.object = 4095});
        ASSERT_FALSE(none);
        EXPECT_THAT(none.error().message, HasSubstr("no buffer"));
        const auto small = device.adopt_buffer({.name = "small", .size = words * 4 + 4}, {.object = mine});
        ASSERT_FALSE(small);
        EXPECT_THAT(small.error().message, HasSubstr("1024"));
        EXPECT_EQ(small.error().kind, ErrorKind::invalid_argument);
    }
    ASSERT_TRUE(glIsBuffer(mine)) << "it is the host's to delete";
    std::vector<uint32_t> values(words);
    glGetNamedBufferSubData(mine, 0, words * 4, values.data());
    // Twice x -> 3 x + 1, from 2 by the host's last fill, or six times from 0.
    EXPECT_THAT(std::span(values).first(words / 2), Each(22u));
    EXPECT_THAT(std::span(values).last(words / 2), Each(364u));
    glDeleteBuffers(1, &mine);
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
    for (const Message& message : messages) EXPECT_FALSE(is_failure(message)) << message.text;
}

}  // namespace
}  // namespace lumo::rhi
