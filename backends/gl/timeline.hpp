// Submissions in flight: their fences and the time stamps of their passes.
#pragma once

#include <cstdint>
#include <deque>
#include <epoxy/gl.h>
#include <vector>

#include "rhi/backend.hpp"

namespace lumo::backends::gl {

/// Waits on the device for what was flushed or not. Error: device_lost.
Result<void> wait_for(GLsync fence);

class Timeline {
  public:
    explicit Timeline(rhi::Timing timing) : timing_(timing) {}

    /// Error: device_lost, while waiting for an older submission.
    Result<void> begin(uint64_t serial);
    /// Around the commands of a pass.
    void begin_pass();
    void end_pass();
    /// Fences the open submission.
    Result<void> submit();

    uint64_t completed();
    Result<void> wait(uint64_t serial);
    std::vector<rhi::PassStamp> stamps(uint64_t serial);
    /// A submission is open.
    bool recording() const { return recording_; }

    /// Deletes its objects.
    void clear();

  private:
    /// Serialised stamps are times already; overlapped ones are queries until someone asks. Without either, the
    /// pass is not timed.
    struct Stamp {
        GLuint query = 0;
        uint64_t time_ns = 0;
    };
    struct Submission {
        uint64_t serial = 0;
        GLsync fence = nullptr;  ///< null: open, or done
        std::vector<Stamp> stamps{};
    };

    Stamp stamp();
    void finish_oldest();

    rhi::Timing timing_;
    bool recording_ = false;
    uint64_t completed_ = 0;
    std::deque<Submission> submissions_;  ///< by ascending serial: unfinished, and kept for their stamps
    std::vector<GLuint> spare_queries_;
};

}  // namespace lumo::backends::gl
