#include "backends/gl/timeline.hpp"

#include <algorithm>
#include <utility>

#include "backends/gl/resources.hpp"

namespace lumo::backends::gl {
namespace {

using rhi::PassStamp;

constexpr size_t kept_submissions = 16;

}  // namespace

Result<void> wait_for(GLsync fence) {
    constexpr GLuint64 second = 1'000'000'000;
    for (;;) {
        switch (glClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, second)) {
            case GL_ALREADY_SIGNALED:
            case GL_CONDITION_SATISFIED:
                // A reset ends waiting as well.
                if (glGetGraphicsResetStatus() == GL_NO_ERROR) return {};
                return context_lost();
            case GL_TIMEOUT_EXPIRED:
                if (glGetGraphicsResetStatus() == GL_NO_ERROR) continue;
                return context_lost();
            default:
                return context_lost();
        }
    }
}

Result<void> Timeline::begin(uint64_t serial) {
    if (serial > rhi::max_in_flight) {
        if (auto waited = wait(serial - rhi::max_in_flight); !waited) return waited;
    }
    if (submissions_.size() > kept_submissions) {
        for (const Stamp& stamp : submissions_.front().stamps) {
            if (stamp.query) spare_queries_.push_back(stamp.query);
        }
        submissions_.pop_front();
    }
    submissions_.push_back({.serial = serial});
    recording_ = true;
    return {};
}

/// A software driver stamps a command when it takes it, not when it is done. So serialised stamps are taken
/// while the device is idle; one behind each pass is enough, since nothing runs between passes.
void Timeline::begin_pass() { submissions_.back().stamps.push_back(stamp()); }

void Timeline::end_pass() {
    if (timing_ == rhi::Timing::serialised) glFinish();
    submissions_.back().stamps.push_back(stamp());
}

Timeline::Stamp Timeline::stamp() {
    if (timing_ == rhi::Timing::serialised) {
        GLint64 now = 0;
        glGetInteger64v(GL_TIMESTAMP, &now);
        return {.time_ns = uint64_t(now)};
    }
    if (spare_queries_.empty()) {
        spare_queries_.resize(64);
        glCreateQueries(GL_TIMESTAMP, GLsizei(spare_queries_.size()), spare_queries_.data());
        if (spare_queries_.front() == 0) {
            spare_queries_.clear();
            return {};
        }
    }
    const GLuint query = spare_queries_.back();
    spare_queries_.pop_back();
    glQueryCounter(query, GL_TIMESTAMP);
    return {.query = query};
}

Result<void> Timeline::submit() {
    recording_ = false;
    submissions_.back().fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();
    if (!submissions_.back().fence) {
        // Where there is no memory to wait for it later, it is waited for at once.
        glFinish();
        (void)check_errors("fence");
        for (Submission& submission : submissions_) glDeleteSync(std::exchange(submission.fence, nullptr));
        completed_ = submissions_.back().serial;
    }
    if (glGetGraphicsResetStatus() == GL_NO_ERROR) return {};
    return context_lost();
}

void Timeline::finish_oldest() {
    auto oldest = std::ranges::find_if(submissions_, [](const Submission& s) { return s.fence != nullptr; });
    glDeleteSync(std::exchange(oldest->fence, nullptr));
    completed_ = oldest->serial;
}

uint64_t Timeline::completed() {
    for (const Submission& submission : submissions_) {
        if (!submission.fence) continue;
        const GLenum state = glClientWaitSync(submission.fence, 0, 0);
        if (state != GL_ALREADY_SIGNALED && state != GL_CONDITION_SATISFIED) break;
        finish_oldest();
    }
    return completed_;
}

Result<void> Timeline::wait(uint64_t serial) {
    for (const Submission& submission : submissions_) {
        if (submission.serial > serial) break;
        if (!submission.fence) continue;
        if (auto waited = wait_for(submission.fence); !waited) return waited;
        finish_oldest();
    }
    return {};
}

std::vector<rhi::PassStamp> Timeline::stamps(uint64_t serial) {
    std::vector<rhi::PassStamp> passes;
    auto found = std::ranges::find(submissions_, serial, &Submission::serial);
    if (found == submissions_.end()) return passes;
    for (Stamp& stamp : found->stamps) {
        if (!stamp.query) continue;
        GLuint64 time = 0;
        glGetQueryObjectui64v(stamp.query, GL_QUERY_RESULT, &time);
        spare_queries_.push_back(std::exchange(stamp.query, 0));
        stamp.time_ns = time;
    }
    for (size_t i = 0; i + 1 < found->stamps.size(); i += 2) {
        const PassStamp pass{found->stamps[i].time_ns, found->stamps[i + 1].time_ns};
        passes.push_back(pass.begin_ns && pass.end_ns ? pass : PassStamp{});
    }
    return passes;
}

void Timeline::clear() {
    for (const Submission& submission : submissions_) {
        glDeleteSync(submission.fence);
        for (const Stamp& stamp : submission.stamps)
            if (stamp.query) spare_queries_.push_back(stamp.query);
    }
    submissions_.clear();
    glDeleteQueries(GLsizei(spare_queries_.size()), spare_queries_.data());
    spare_queries_.clear();
}

}  // namespace lumo::backends::gl
