#include "scene/file.hpp"

#include <fmt/format.h>
#include <fstream>

#include "scene/printable.hpp"

namespace lumo::scene {

Result<std::vector<std::byte>> read_file(const std::filesystem::path& file, uint64_t max_bytes) {
    const std::string name = printable(file.string());
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    if (status.type() == std::filesystem::file_type::not_found)
        return fail(ErrorKind::io, name, "does not exist", "check the path");
    if (error) return fail(ErrorKind::io, name, "cannot be opened: " + error.message(), "check the path");
    if (status.type() != std::filesystem::file_type::regular)
        return fail(ErrorKind::io, name, "is not a regular file", "check the path");
    const uint64_t size = std::filesystem::file_size(file, error);
    std::ifstream stream(file, std::ios::binary);
    if (error || !stream) return fail(ErrorKind::io, name, "cannot be opened", "check its permissions");
    if (size > max_bytes)
        return fail(ErrorKind::limit, name,
                    fmt::format("has {} bytes, beyond the limit of {}", size, max_bytes), "make it smaller");
    std::vector<std::byte> bytes(size);
    stream.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(size));
    if (uint64_t(stream.gcount()) != size) return fail(ErrorKind::io, name, "cannot be read to its end");
    return bytes;
}

Result<void> write_file(const std::filesystem::path& file, std::span<const std::byte> bytes) {
    std::ofstream stream(file, std::ios::binary);
    const bool opened = stream.is_open();
    stream.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    stream.close();
    if (stream) return {};
    std::error_code ignored;
    if (opened && std::filesystem::is_regular_file(file, ignored)) std::filesystem::remove(file, ignored);
    return fail(ErrorKind::io, printable(file.string()), "cannot be written",
                "check that its folder exists, may be written to and has room");
}

}  // namespace lumo::scene
