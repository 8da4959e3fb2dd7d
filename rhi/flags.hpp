// Bit-flag operators for the enumerations that ask for them.
#pragma once

#include <type_traits>

namespace lumo::rhi {

/// Specialise to true to give an enum class the operators below.
template <class E>
inline constexpr bool is_flags = false;

template <class E>
requires is_flags<E>
constexpr E operator|(E a, E b) {
    using U = std::underlying_type_t<E>;
    return E(U(a) | U(b));
}

template <class E>
requires is_flags<E>
constexpr E& operator|=(E& a, E b) { return a = a | b; }

/// True when any bit of `bits` is set in `set`.
template <class E>
requires is_flags<E>
constexpr bool has(E set, E bits) {
    using U = std::underlying_type_t<E>;
    return (U(set) & U(bits)) != 0;
}

}  // namespace lumo::rhi
