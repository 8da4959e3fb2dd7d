// What can go wrong because of the environment: a value, never an exception (misuse of an interface is a
// Check instead, see rhi/check.hpp).
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace lumo {

enum class ErrorKind {
    invalid_argument,  ///< a value given by the caller is outside its range
    io,                ///< a file cannot be read or written
    invalid_file,      ///< a file was read and breaks its own format
    unsupported,       ///< valid, but lumo or this device does not do it
    limit,             ///< beyond a stated limit
    no_device,         ///< no device, or not the one that was asked for
    out_of_memory,
    shader,  ///< a shader does not compile, link or fit
    device_lost,
};

/// An error with what is needed to act on it.
struct Error {
    ErrorKind kind = ErrorKind::invalid_argument;
    std::string subject;  ///< the file, device, option or resource that it is about
    std::string message;  ///< what is wrong, with the offending value
    std::string remedy;   ///< what to do about it; may be empty
};

/// One line: "subject: message (remedy)".
std::string to_string(const Error& error);

template <class T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> fail(ErrorKind kind, std::string subject, std::string message,
                                  std::string remedy = {}) {
    return tl::unexpected<Error>(Error{kind, std::move(subject), std::move(message), std::move(remedy)});
}

}  // namespace lumo
