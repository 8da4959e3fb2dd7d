// Each kind of thing that the RHI can be told, small and by itself, with what comes of it as bytes.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "rhi/rhi.hpp"

namespace lumo::testing_support {

struct Operation {
    std::string name;
    /// What it makes is gone when it returns. The bytes are the same on every device of one driver.
    std::function<std::vector<std::byte>(rhi::Device&)> run;
};

std::vector<Operation> every_operation();

}  // namespace lumo::testing_support
