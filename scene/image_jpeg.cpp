// JPEG by libjpeg.
#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdio>
#include <optional>

// After <cstdio>, which these need and do not include.
#include <jerror.h>
#include <jpeglib.h>

#include "scene/image_codec.hpp"
#include "scene/printable.hpp"

namespace lumo::scene::codec {
namespace {

// Each scan of a progressive file may pass over all of its pixels for a few bytes.
constexpr int max_scans = 100;

// Walks the segments up to the frame header (SOF0 to SOF15 but for DHT, JPG and DAC).
std::optional<Header> header_of(std::span<const std::byte> bytes) {
    for (size_t at = 2; at + 4 <= bytes.size();) {
        if (bytes[at] != std::byte(0xff)) return std::nullopt;
        const uint32_t marker = big_endian(bytes, at + 1, 1);
        if (marker == 0xff) {
            ++at;
            continue;
        }
        if (marker == 0x01 || (marker >= 0xd0 && marker <= 0xd8)) {
            at += 2;
            continue;
        }
        const bool frame =
            marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
        if (frame) {
            if (at + 9 > bytes.size()) return std::nullopt;
            Header header{.width = big_endian(bytes, at + 7, 2), .height = big_endian(bytes, at + 5, 2)};
            // A block of 8 x 8 pixels takes a bit at least.
            header.least_bytes = header.width / 8 * (header.height / 8) / 8;
            return header;
        }
        if (marker == 0xd9 || marker == 0xda) return std::nullopt;
        at += 2 + std::max(big_endian(bytes, at + 2, 2), 2u);
    }
    return std::nullopt;
}

// libjpeg reports errors by a function that must not return: a longjmp, which runs no destructor. What owns memory is
// here, and the functions that call setjmp have plain values only.
struct Reader {
    explicit Reader(std::span<const std::byte> file) : bytes(file) {
        jpeg.err = jpeg_std_error(&errors);
        jpeg.client_data = this;
        errors.error_exit = on_error;
        errors.emit_message = on_message;
        progress.progress_monitor = on_progress;
    }
    ~Reader() { jpeg_destroy_decompress(&jpeg); }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    [[noreturn]] static void on_error(j_common_ptr jpeg) {
        auto& reader = *static_cast<Reader*>(jpeg->client_data);
        jpeg->err->format_message(jpeg, reader.error.data());
        std::longjmp(reader.escape, 1);
    }
    // Of what libjpeg would go on from, missing pixels are an error here.
    static void on_message(j_common_ptr jpeg, int level) {
        const int code = jpeg->err->msg_code;
        if (level < 0 && (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER)) on_error(jpeg);
    }
    static void on_progress(j_common_ptr jpeg) {
        auto& reader = *static_cast<Reader*>(jpeg->client_data);
        if (reader.jpeg.input_scan_number <= max_scans) return;
        std::snprintf(reader.error.data(), reader.error.size(), "it has more than %d scans", max_scans);
        std::longjmp(reader.escape, 1);
    }

    std::span<const std::byte> bytes;
    std::array<char, JMSG_LENGTH_MAX> error = {};
    std::jmp_buf escape = {};
    jpeg_error_mgr errors = {};
    jpeg_progress_mgr progress = {};
    jpeg_decompress_struct jpeg = {};
};

bool read_header(Reader& reader) {
    if (setjmp(reader.escape)) return false;
    jpeg_create_decompress(&reader.jpeg);
    reader.jpeg.progress = &reader.progress;
    jpeg_mem_src(&reader.jpeg, reinterpret_cast<const unsigned char*>(reader.bytes.data()),
                 reader.bytes.size());
    jpeg_read_header(&reader.jpeg, TRUE);
    const bool four = reader.jpeg.jpeg_color_space == JCS_CMYK || reader.jpeg.jpeg_color_space == JCS_YCCK;
    const bool one = reader.jpeg.jpeg_color_space == JCS_GRAYSCALE;
    reader.jpeg.out_color_space = one ? JCS_GRAYSCALE : four ? JCS_CMYK : JCS_RGB;
    jpeg_calc_output_dimensions(&reader.jpeg);
    return true;
}

bool read_rows(Reader& reader, JSAMPARRAY rows) {
    if (setjmp(reader.escape)) return false;
    jpeg_start_decompress(&reader.jpeg);
    while (reader.jpeg.output_scanline < reader.jpeg.output_height)
        jpeg_read_scanlines(&reader.jpeg, rows + reader.jpeg.output_scanline,
                            reader.jpeg.output_height - reader.jpeg.output_scanline);
    jpeg_finish_decompress(&reader.jpeg);
    return true;
}

tl::unexpected<Error> damaged(const Source& source, const Reader& reader) {
    return codec::damaged(source, printable(reader.error.data()));
}

// Adobe's files, which are nearly all there are, hold 255 minus the ink.
Image8 rgb_of_cmyk(const Image8& cmyk) {
    Image8 rgb{.width = cmyk.width, .height = cmyk.height, .channels = 3};
    rgb.values.resize(cmyk.values.size() / 4 * 3);
    for (size_t i = 0; i < cmyk.values.size() / 4; ++i)
        for (size_t c = 0; c < 3; ++c)
            rgb.values[3 * i + c] =
                uint8_t((uint32_t(cmyk.values[4 * i + c]) * cmyk.values[4 * i + 3] + 127) / 255);
    return rgb;
}

}  // namespace

Result<Image8> decode_jpeg(const Source& source) {
    const auto header = header_of(source.bytes);
    if (!header) return codec::damaged(source, "its header is no JPEG header, or cut off");
    if (const auto checked = check(*header, source); !checked) return tl::unexpected(checked.error());

    Reader reader(source.bytes);
    if (!read_header(reader)) return damaged(source, reader);
    if (reader.jpeg.output_width != header->width || reader.jpeg.output_height != header->height)
        return codec::damaged(source, "it has two headers");
    Image8 image{.width = reader.jpeg.output_width,
                 .height = reader.jpeg.output_height,
                 .channels = uint32_t(reader.jpeg.output_components)};
    image.values.resize(size_t(image.width) * image.height * image.channels);
    std::vector<JSAMPROW> rows(image.height);
    for (uint32_t y = 0; y < image.height; ++y) rows[y] = image.at(0, y);
    if (!read_rows(reader, rows.data())) return damaged(source, reader);
    return image.channels == 4 ? rgb_of_cmyk(image) : std::move(image);
}

}  // namespace lumo::scene::codec
