#include <algorithm>
#include <cstdio>
#include <fmt/format.h>

#include "rhi/core.hpp"

namespace lumo::rhi {
namespace {

/// Submissions whose pass times and trace are kept.
constexpr uint64_t kept_records = 16;

/// Spreads a core's address so that the handles of two devices do not name each other's resources.
uint32_t handle_seed(const void* core) {
    return uint32_t((uint64_t(reinterpret_cast<uintptr_t>(core)) * 0x9e3779b97f4a7c15u) >> 32);
}

}  // namespace

// -- resources

DeviceCore::DeviceCore(std::unique_ptr<Backend> backend, MessageSink sink)
    : backend_(std::move(backend)),
      sink_(std::move(sink)),
      resources_(*backend_, handle_seed(this)),
      uploads_(resources_, *backend_),
      readbacks_(resources_) {}

DeviceCore::~DeviceCore() = default;

template <class Make>
auto DeviceCore::create(Make make) -> decltype(make()) {
    if (lost_) return tl::unexpected(*lost_);
    auto made = make();
    if (!made && made.error().kind == ErrorKind::device_lost) return refuse(open_serial_, made.error());
    return made;
}

Result<Buffer> DeviceCore::create_buffer(const BufferDesc& desc) {
    if (auto fine = check_desc(desc); !fine) return tl::unexpected(fine.error());
    return create([&] { return resources_.create(desc, false); }).map([&](BufferHandle handle) {
        tracker_.forget(MemoryId::Kind::buffer, handle.index);
        ++owners_;
        return Buffer(*this, handle, desc.size, resources_.find(handle)->mapped);
    });
}

Result<Texture> DeviceCore::create_texture(const TextureDesc& desc) {
    if (auto fine = check_desc(desc, format_caps(desc.format), info().limits); !fine)
        return tl::unexpected(fine.error());
    return create([&] { return resources_.create(desc); }).map([&](TextureHandle handle) {
        tracker_.forget(MemoryId::Kind::texture, handle.index);
        ++owners_;
        return Texture(*this, handle, desc);
    });
}

Result<Texture> DeviceCore::adopt_texture(const TextureDesc& desc, const NativeTexture& native) {
    if (auto fine = check_desc(desc, format_caps(desc.format), info().limits); !fine)
        return tl::unexpected(fine.error());
    if (native.object == 0)
        return fail(ErrorKind::invalid_argument, desc.name, "no texture of the host's is named");
    return create([&] { return resources_.adopt(desc, native); }).map([&](TextureHandle handle) {
        tracker_.forget(MemoryId::Kind::texture, handle.index);
        for (uint32_t mip = 0; mip < desc.mips; ++mip)
            tracker_.adopt({MemoryId::Kind::texture, handle.index, mip});
        ++owners_;
        return Texture(*this, handle, desc);
    });
}

Result<Buffer> DeviceCore::adopt_buffer(const BufferDesc& desc, const NativeBuffer& native) {
    if (auto fine = check_desc(desc); !fine) return tl::unexpected(fine.error());
    if (desc.memory != Memory::device)
        return fail(ErrorKind::invalid_argument, desc.name, "a host's buffer is not mapped by lumo",
                    "describe it as Memory::device");
    if (native.object == 0)
        return fail(ErrorKind::invalid_argument, desc.name, "no buffer of the host's is named");
    return create([&] { return resources_.adopt(desc, native); }).map([&](BufferHandle handle) {
        tracker_.forget(MemoryId::Kind::buffer, handle.index);
        tracker_.adopt({MemoryId::Kind::buffer, handle.index});
        ++owners_;
        return Buffer(*this, handle, desc.size, nullptr);
    });
}

Result<Sampler> DeviceCore::create_sampler(const SamplerDesc& desc) {
    if (auto fine = check_desc(desc); !fine) return tl::unexpected(fine.error());
    SamplerDesc possible = desc;
    possible.max_anisotropy = std::min(desc.max_anisotropy, info().limits.max_anisotropy);
    return create([&] { return resources_.create(possible); }).map([&](SamplerHandle handle) {
        ++owners_;
        return Sampler(*this, handle);
    });
}

Result<PipelineHandle> DeviceCore::create_pipeline(const ProgramInfo& program,
                                                   std::span<const uint32_t> options,
                                                   const RasterState* raster) {
    auto fine =
        check_pipeline(program, raster, info(), [this](Format format) { return format_caps(format); });
    if (!fine) return tl::unexpected(fine.error());
    auto handle = create([&] { return resources_.create(program, options, raster); });
    if (handle) ++owners_;
    return handle;
}

template <class HandleType>
void DeviceCore::release(HandleType handle) {
    --owners_;
    if (closed_) {
        if (owners_ == 0) delete this;
        return;
    }
    resources_.release(handle, last_serial());
    resources_.collect(backend_->completed());
}

void detail::release(DeviceCore& core, BufferHandle handle) { core.release(handle); }
void detail::release(DeviceCore& core, TextureHandle handle) { core.release(handle); }
void detail::release(DeviceCore& core, SamplerHandle handle) { core.release(handle); }
void detail::release(DeviceCore& core, PipelineHandle handle) { core.release(handle); }

// -- messages

void DeviceCore::report(const Message& message) const {
    if (sink_) return sink_(message);
    if (is_failure(message)) std::fprintf(stderr, "lumo: %s: %s\n", message.id.c_str(), message.text.c_str());
}

tl::unexpected<Error> DeviceCore::drop(std::string_view where, const Fault& fault) {
    if (fault.check == Check::none)
        return refuse(open_serial_, {fault.kind, std::string(where), fault.text, {}});
    const std::string id(to_string(fault.check));
    report({Severity::error, fault.check, id, fmt::format("{}: {}", where, fault.text)});
    return fail(fault.kind, std::string(where), id + ": " + fault.text);
}

// -- submissions

tl::unexpected<Error> DeviceCore::refuse(uint64_t serial, Error error) {
    if (lost_) return tl::unexpected(*lost_);
    if (error.kind == ErrorKind::device_lost) lost_ = error;
    if (serial && !records_[serial].failure) records_[serial].failure = error;
    report({Severity::error, Check::none, "device", to_string(error)});
    return tl::unexpected(std::move(error));
}

uint64_t DeviceCore::begin() {
    if (open_serial_) {
        drop("begin", {Check::pass_open, "another submission is being recorded"});
        return 0;
    }
    open_serial_ = submitted_ + 1;
    presented_ = false;
    records_[open_serial_];
    tracker_.mark();
    auto begun = lost_ ? tl::unexpected(*lost_) : backend_->begin(open_serial_);
    idle_ = !begun;
    if (!begun) refuse(open_serial_, within("begin", begun.error()));
    resources_.collect(backend_->completed());
    if (open_serial_ > kept_records)
        records_.erase(records_.begin(), records_.upper_bound(open_serial_ - kept_records));
    return open_serial_;
}

Submission DeviceCore::submit(uint64_t serial) {
    if (!recording(serial)) return {};
    if (pass_) {
        drop("submit", {Check::pass_open, fmt::format("pass \"{}\" is still open", pass_->name)});
        end_pass(pass_->id);
    }
    const std::vector<Barrier> back = hand_back();
    submitted_ = std::exchange(open_serial_, 0);
    if (!lost_ && !idle_) {
        if (auto done = backend_->submit(back); !done) {
            idle_ = true;
            refuse(submitted_, within("submit", done.error()));
        }
    }
    if (idle_) tracker_.rewind();
    if (const auto& failure = records_[submitted_].failure) readbacks_.fail(submitted_, *failure);
    return {submitted_};
}

/// What the open submission used of the host's is put back as the host expects it.
std::vector<Barrier> DeviceCore::hand_back() {
    if (borrowed_.empty()) return {};
    Scope scope{.label = "hand back", .uses = {}};
    for (const MemoryId& memory : std::exchange(borrowed_, {})) scope.uses.push_back(external_use(memory));
    std::vector<Barrier> barriers = tracker_.enter(scope);
    if (tracing_) keep_trace({&scope, 1}, {&barriers, 1});
    return barriers;
}

Result<void> DeviceCore::finish(uint64_t serial) {
    if (serial > submitted_)
        return fail(ErrorKind::invalid_argument, "wait",
                    fmt::format("submission {} was not submitted", serial));
    if (lost_) return tl::unexpected(*lost_);
    auto done = backend_->wait(serial);
    if (done)
        resources_.collect(backend_->completed());
    else if (done.error().kind == ErrorKind::device_lost)
        refuse(0, within("wait", done.error()));
    return done;
}

Result<void> DeviceCore::wait(uint64_t serial) {
    return finish(serial).and_then([&]() -> Result<void> {
        const auto found = records_.find(serial);
        if (found == records_.end() || !found->second.failure) return {};
        return tl::unexpected(*found->second.failure);
    });
}

Result<std::vector<std::byte>> DeviceCore::take(Readback readback) {
    if (lost_) return tl::unexpected(*lost_);
    const ReadbackPool::Ticket* ticket = readbacks_.find(readback);
    if (!ticket)
        return drop("take",
                    {Check::ticket_unknown, fmt::format("readback {} was taken or never made", readback.id)});
    if (ticket->serial > submitted_)
        return drop("take", {Check::ticket_unknown,
                             fmt::format("readback {} is part of submission {}, which was not submitted",
                                         readback.id, ticket->serial)});
    return finish(ticket->serial).and_then([&] { return readbacks_.take(readback); });
}

std::vector<PassTime> DeviceCore::pass_times(uint64_t serial) {
    const auto found = records_.find(serial);
    if (found == records_.end() || !finish(serial)) return {};
    const std::vector<PassStamp> stamps = backend_->stamps(serial);
    std::vector<PassTime> times;
    for (size_t i = 0; i < std::min(stamps.size(), found->second.passes.size()); ++i)
        times.push_back({found->second.passes[i], double(stamps[i].end_ns - stamps[i].begin_ns) * 1e-6});
    return times;
}

std::string DeviceCore::trace(uint64_t serial) const {
    const auto found = records_.find(serial);
    return found == records_.end() ? std::string{} : found->second.trace;
}

bool DeviceCore::close() {
    closed_ = true;
    if (open_serial_) submit(open_serial_);
    if (submitted_ && !lost_) (void)backend_->wait(submitted_);
    for (const std::string& owned : resources_.owned())
        drop("device", {Check::leaked_resource, owned + " outlives its device"});
    resources_.release_all();
    resources_.collect(~uint64_t{0});
    backend_.reset();
    return owners_ == 0;
}

// -- Device

Device::Device(std::unique_ptr<Backend> backend, const DeviceDesc& desc)
    : core_(new DeviceCore(std::move(backend), desc.sink)) {}
Device::Device(Device&&) noexcept = default;
Device& Device::operator=(Device&&) noexcept = default;
Device::~Device() = default;

void Device::Close::operator()(DeviceCore* core) const {
    if (core->close()) delete core;
}

const DeviceInfo& Device::info() const { return core_->info(); }
FormatCaps Device::format_caps(Format format) const { return core_->format_caps(format); }
Result<Buffer> Device::create_buffer(const BufferDesc& desc) { return core_->create_buffer(desc); }
Result<Texture> Device::create_texture(const TextureDesc& desc) { return core_->create_texture(desc); }
Result<Sampler> Device::create_sampler(const SamplerDesc& desc) { return core_->create_sampler(desc); }
Result<Texture> Device::adopt_texture(const TextureDesc& desc, const NativeTexture& native) {
    return core_->adopt_texture(desc, native);
}
Result<Buffer> Device::adopt_buffer(const BufferDesc& desc, const NativeBuffer& native) {
    return core_->adopt_buffer(desc, native);
}
Result<PipelineHandle> Device::create_pipeline(const ProgramInfo& program, std::span<const uint32_t> options,
                                               const RasterState* state) {
    return core_->create_pipeline(program, options, state);
}

Commands Device::begin() { return {core_.get(), core_->begin()}; }
Submission Device::submit(Commands&& commands) { return core_->submit(std::exchange(commands.serial_, 0)); }
Result<void> Device::wait(Submission submission) { return core_->wait(submission.serial); }
bool Device::finished(Submission submission) { return core_->finished(submission.serial); }
Result<std::vector<std::byte>> Device::take(Readback readback) { return core_->take(readback); }

namespace {

/// One pass in a submission of its own. `record` takes the pass's id and returns a Result<void>.
template <class Record>
Result<Submission> at_once(DeviceCore& core, std::string_view name, Record record) {
    const uint64_t serial = core.begin();
    if (!serial)
        return fail(ErrorKind::invalid_argument, std::string(name), "a submission is being recorded");
    const uint64_t pass = core.open_pass(serial, name);
    const Result<void> recorded = record(pass);
    core.end_pass(pass);
    const Submission submission = core.submit(serial);
    return recorded.map([&] { return submission; });
}

/// At once, and waited for.
template <class Record>
Result<void> upload_at_once(DeviceCore& core, Record record) {
    return at_once(core, "upload", record).and_then([&](Submission done) { return core.wait(done.serial); });
}

/// The bytes of the ticket that `read` takes from a pass.
template <class Read>
Result<std::vector<std::byte>> download_at_once(DeviceCore& core, Read read) {
    Readback ticket;
    return at_once(core, "download",
                   [&](uint64_t pass) { return read(pass).map([&](Readback opened) { ticket = opened; }); })
        .and_then([&](Submission) { return core.take(ticket); });
}

}  // namespace

Result<void> Device::upload(BufferSlice destination, std::span<const std::byte> bytes) {
    return upload_at_once(*core_, [&](uint64_t pass) { return core_->upload(pass, destination, bytes); });
}

Result<void> Device::upload(const Texture& destination, const TextureRegion& region,
                            std::span<const std::byte> texels) {
    return upload_at_once(
        *core_, [&](uint64_t pass) { return core_->upload(pass, destination.handle(), region, texels); });
}

Result<std::vector<std::byte>> Device::download(BufferSlice source) {
    return download_at_once(*core_, [&](uint64_t pass) { return core_->read(pass, source); });
}

Result<std::vector<std::byte>> Device::download(const Texture& source, const TextureRegion& region) {
    return download_at_once(*core_,
                            [&](uint64_t pass) { return core_->read(pass, source.handle(), region); });
}

std::vector<PassTime> Device::pass_times(Submission submission) {
    return core_->pass_times(submission.serial);
}
std::string Device::trace(Submission submission) const { return core_->trace(submission.serial); }
void Device::set_tracing(bool on) { core_->set_tracing(on); }
std::vector<MemoryEntry> Device::memory() const { return core_->memory(); }
MemoryBudget Device::memory_budget() const { return core_->memory_budget(); }
void Device::report(const Message& message) const { core_->report(message); }

}  // namespace lumo::rhi
