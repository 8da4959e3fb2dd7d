#include "tests/support/faults.hpp"

namespace lumo::testing_support {

Faults& faults() {
    static Faults all;
    return all;
}

void Faults::arm(int n, std::string_view function) {
    countdown_ = n;
    only_ = function;
    failed_.clear();
    losing_ = false;
    refusing_ = false;
}

void Faults::arm_refusal(std::string_view function) {
    arm(0, function);
    refusing_ = true;
}

void Faults::arm_loss(int n) {
    arm(n);
    losing_ = true;
}

std::string Faults::disarm() {
    countdown_.reset();
    lost_ = false;
    return std::exchange(failed_, {});
}

bool Faults::fails(std::string_view function) {
    if (!countdown_ || losing_ || (!only_.empty() && function != only_)) return false;
    if ((*countdown_)-- > 0) return false;
    countdown_.reset();
    failed_ = function;
    return true;
}

bool Faults::lost(std::string_view function) {
    if (lost_) return true;
    if (!countdown_ || !losing_ || (*countdown_)-- > 0) return false;
    countdown_.reset();
    failed_ = function;
    return lost_ = true;
}

void Faults::count(std::string_view kind, int64_t change) {
    int64_t& number = live_[std::string(kind)];
    number += change;
    if (number == 0) live_.erase(std::string(kind));
}

FaultyDriver::FaultyDriver(rhi::Api api) : api_(api) {
    faults().disarm();
    faults().start_counting();
    if (api == rhi::Api::gl)
        install_gl_faults();
    else
        install_vulkan_faults();
}

FaultyDriver::~FaultyDriver() {
    faults().disarm();
    if (api_ == rhi::Api::gl)
        remove_gl_faults();
    else
        remove_vulkan_faults();
}

}  // namespace lumo::testing_support
