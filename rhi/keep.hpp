#pragma once

#include <utility>

namespace lumo {

/// For Result::map: moves what was made to its place, which has to outlive the call.
template <class T>
auto keep(T& place) {
    return [&place](auto made) { place = std::move(made); };
}

}  // namespace lumo
