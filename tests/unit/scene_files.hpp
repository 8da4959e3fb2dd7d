// What the scene tests share: a folder of their own, and files written into it.
#pragma once

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <unistd.h>
#include <vector>

namespace lumo::scene::test {

/// A new folder that goes away with the object.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "lumo-test-XXXXXX").string();
        if (!mkdtemp(name.data())) std::abort();
        path_ = name;
    }
    ~TemporaryFolder() { std::filesystem::remove_all(path_); }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

    std::filesystem::path write(const std::string& name, std::string_view content) const {
        auto file = path_ / name;
        std::filesystem::create_directories(file.parent_path());
        std::filesystem::remove(file);  // some file systems wait for the disk when a file is overwritten
        std::ofstream(file, std::ios::binary).write(content.data(), std::streamsize(content.size()));
        return file;
    }

  private:
    std::filesystem::path path_;
};

/// Appends the bytes of values as this (little-endian) machine has them.
template <class T>
void append(std::string& bytes, std::initializer_list<T> values) {
    for (const T& value : values) {
        char raw[sizeof(T)];
        std::memcpy(raw, &value, sizeof(T));
        bytes.append(raw, sizeof(T));
    }
}

/// A PNG file with stored (uncompressed) pixels: rows are what PNG's rows are without their filter byte.
inline std::string make_png(uint32_t width, uint32_t height, uint8_t bit_depth, uint8_t color_type,
                            std::string_view rows, std::string_view palette = {}) {
    const auto big = [](uint32_t v) {
        return std::string{char(v >> 24), char(v >> 16), char(v >> 8), char(v)};
    };
    const auto chunk = [&](std::string_view type, std::string_view content) {
        const std::string checked = std::string(type) + std::string(content);
        uint32_t crc = ~0u;
        for (const char c : checked) {
            crc ^= uint8_t(c);
            for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0u);
        }
        return big(uint32_t(content.size())) + checked + big(~crc);
    };
    std::string filtered;
    const size_t row_size = height ? rows.size() / height : 0;
    for (uint32_t y = 0; y < height && row_size; ++y) {
        filtered += '\0';
        filtered += rows.substr(y * row_size, row_size);
    }
    uint32_t a = 1, b = 0;
    for (const char c : filtered) {
        a = (a + uint8_t(c)) % 65521;
        b = (b + a) % 65521;
    }
    const uint16_t size = uint16_t(filtered.size());
    std::string stream = "\x78\x01\x01";
    append<uint16_t>(stream, {size, uint16_t(~size)});
    stream += filtered + big(b << 16 | a);

    std::string header = big(width) + big(height);
    header += {char(bit_depth), char(color_type), 0, 0, 0};
    std::string file = "\x89PNG\r\n\x1a\n" + chunk("IHDR", header);
    if (!palette.empty()) file += chunk("PLTE", palette);
    return file + chunk("IDAT", stream) + chunk("IEND", "");
}

}  // namespace lumo::scene::test
