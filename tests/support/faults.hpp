// Makes a driver's calls fail, and counts what was made through it and not given back. It stands between lumo
// and the driver, outside of lumo: OpenGL's entry points are replaced in epoxy's table, Vulkan's where the
// loader's first function is looked up.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "rhi/device_info.hpp"

namespace lumo::testing_support {

/// The faults of this process. Calls that may fail are numbered from the moment of arming.
class Faults {
  public:
    /// The call number `n` fails for want of memory; of those to `function` alone if it is given.
    void arm(int n, std::string_view function = {});
    /// The next call to `function` finds fault with what it is given.
    void arm_refusal(std::string_view function);
    /// The call number `n` of those that wait or submit finds the device lost, and so do all after it.
    void arm_loss(int n);
    /// Calls succeed again. The function that failed, or nothing where none did.
    std::string disarm();

    /// What was made and not given back since start_counting, by kind; kinds of which nothing is left are absent.
    const std::map<std::string, int64_t>& live() const { return live_; }
    void start_counting() { live_.clear(); }

    /// Devices made from here on have no push descriptors.
    void hide_push_descriptors(bool hidden) { hidden_ = hidden; }

    // For the calls that stand in for the driver's.
    bool hides_push_descriptors() const { return hidden_; }
    bool fails(std::string_view function);
    bool lost(std::string_view function);
    bool refuses() const { return refusing_; }
    bool is_lost() const { return lost_; }
    void count(std::string_view kind, int64_t change);

  private:
    std::optional<int> countdown_;
    std::string only_;
    std::string failed_;
    bool losing_ = false;
    bool refusing_ = false;
    bool lost_ = false;
    bool hidden_ = false;
    std::map<std::string, int64_t> live_;
};
Faults& faults();

/// Stands between lumo and an API's driver while it lives.
class FaultyDriver {
  public:
    explicit FaultyDriver(rhi::Api api);
    FaultyDriver(const FaultyDriver&) = delete;
    FaultyDriver& operator=(const FaultyDriver&) = delete;
    ~FaultyDriver();

  private:
    rhi::Api api_;
};

/// A function's name as a template argument.
template <size_t size>
struct FunctionName {
    std::array<char, size> text{};

    // NOLINTNEXTLINE(google-explicit-constructor): a literal is a name
    constexpr FunctionName(const char (&name)[size]) { std::copy_n(name, size, text.begin()); }
    constexpr std::string_view view() const { return {text.data(), size - 1}; }
};

void install_gl_faults();
void remove_gl_faults();
void install_vulkan_faults();
void remove_vulkan_faults();

}  // namespace lumo::testing_support
