// PNG by libpng.
#include <array>
#include <csetjmp>
#include <cstring>
#include <optional>
#include <png.h>

#include "scene/image_codec.hpp"
#include "scene/printable.hpp"

namespace lumo::scene::codec {
namespace {

// Whether the chunks lead up to the one that ends the image. libpng allocates what each says to be its size.
bool is_whole(std::span<const std::byte> bytes) {
    for (uint64_t at = 8; at + 12 <= bytes.size(); at += 12 + uint64_t(big_endian(bytes, at, 4)))
        if (big_endian(bytes, at + 4, 4) == 0x49454e44) return true;
    return false;
}

std::optional<Header> header_of(std::span<const std::byte> bytes) {
    if (bytes.size() < 26 || big_endian(bytes, 12, 4) != 0x49484452 || !is_whole(bytes)) return std::nullopt;
    Header header{.width = big_endian(bytes, 16, 4), .height = big_endian(bytes, 20, 4)};
    const uint32_t depth = big_endian(bytes, 24, 1), color_type = big_endian(bytes, 25, 1);
    const uint64_t channels = color_type == 2 ? 3 : color_type == 4 ? 2 : color_type == 6 ? 4 : 1;
    // Deflate makes 1032 bytes of one at most.
    header.least_bytes = header.width * channels * depth / 8 * header.height / 1032;
    return header;
}

// libpng reports errors by longjmp, which runs no destructor: what owns memory is here, and the functions that call
// setjmp have plain values only.
struct Reader {
    explicit Reader(std::span<const std::byte> file)
        : rest(file), png(png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning)) {
        if (png) info = png_create_info_struct(png);
        if (!info) throw std::bad_alloc();
        png_set_read_fn(png, this, on_read);
    }
    ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    [[noreturn]] static void on_error(png_structp png, png_const_charp message) {
        auto& reader = *static_cast<Reader*>(png_get_error_ptr(png));
        std::strncpy(reader.error.data(), message, reader.error.size() - 1);
        png_longjmp(png, 1);
    }
    static void on_warning(png_structp, png_const_charp) {}
    static void on_read(png_structp png, png_bytep to, size_t size) {
        auto& reader = *static_cast<Reader*>(png_get_io_ptr(png));
        if (size > reader.rest.size()) png_error(png, "the file is cut off");
        std::memcpy(to, reader.rest.data(), size);
        reader.rest = reader.rest.subspan(size);
    }

    std::span<const std::byte> rest;
    std::array<char, 128> error = {};
    png_structp png = nullptr;
    png_infop info = nullptr;
};

// Every form becomes grey, grey and alpha, RGB or RGBA of 8 or, if they are kept, 16 bits.
bool read_header(Reader& reader, uint32_t max_side, bool keep_16_bits) {
    if (setjmp(png_jmpbuf(reader.png))) return false;
    png_set_user_limits(reader.png, max_side, max_side);
    png_read_info(reader.png, reader.info);
    png_set_expand(reader.png);
    if (keep_16_bits)
        png_set_swap(reader.png);
    else
        png_set_scale_16(reader.png);
    png_set_interlace_handling(reader.png);
    png_read_update_info(reader.png, reader.info);
    return true;
}

bool read_rows(Reader& reader, png_bytepp rows) {
    if (setjmp(png_jmpbuf(reader.png))) return false;
    png_read_image(reader.png, rows);
    png_read_end(reader.png, nullptr);
    return true;
}

tl::unexpected<Error> damaged(const Source& source, const Reader& reader) {
    return codec::damaged(source, printable(reader.error.data()));
}

struct Pixels {
    Image8 image;  ///< of bytes: channels * bytes_per_sample of each pixel
    size_t bytes_per_sample = 1;
};

Result<Pixels> decode(const Source& source, bool to_float) {
    auto header = header_of(source.bytes);
    if (!header) return codec::damaged(source, "its chunks do not lead from a header to an end");
    if (const auto checked = check(*header, source); !checked) return tl::unexpected(checked.error());

    Reader reader(source.bytes);
    if (!read_header(reader, source.limits.max_side, to_float)) return damaged(source, reader);
    const size_t bytes_per_sample = png_get_bit_depth(reader.png, reader.info) / 8;
    const uint32_t channels = png_get_channels(reader.png, reader.info);
    header->bytes_per_pixel = to_float ? sizeof(float) * channels : 4;
    if (const auto checked = check(*header, source); !checked) return tl::unexpected(checked.error());

    Image8 image{.width = uint32_t(header->width), .height = uint32_t(header->height), .channels = channels};
    const size_t pitch = image.width * channels * bytes_per_sample;
    image.values.resize(pitch * image.height);
    std::vector<png_bytep> rows(image.height);
    for (size_t y = 0; y < rows.size(); ++y) rows[y] = image.values.data() + y * pitch;
    if (!read_rows(reader, rows.data())) return damaged(source, reader);
    return Pixels{std::move(image), bytes_per_sample};
}

struct Writer {
    Writer() : png(png_create_write_struct(PNG_LIBPNG_VER_STRING, this, on_error, nullptr)) {
        if (png) info = png_create_info_struct(png);
        if (!info) throw std::bad_alloc();
        png_set_write_fn(png, this, on_write, nullptr);
    }
    ~Writer() { png_destroy_write_struct(&png, &info); }
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;

    [[noreturn]] static void on_error(png_structp png, png_const_charp) { png_longjmp(png, 1); }
    // No exception may pass through libpng, and no longjmp leave a handler.
    static void on_write(png_structp png, png_bytep from, size_t size) {
        auto& writer = *static_cast<Writer*>(png_get_io_ptr(png));
        const auto* bytes = reinterpret_cast<const std::byte*>(from);
        bool fits = true;
        try {
            writer.bytes.insert(writer.bytes.end(), bytes, bytes + size);
        } catch (const std::bad_alloc&) {
            fits = false;
        }
        if (!fits) png_error(png, "out of memory");
    }

    std::vector<std::byte> bytes;
    png_structp png = nullptr;
    png_infop info = nullptr;
};

bool write(Writer& writer, uint32_t width, uint32_t height, int color_type, png_bytepp rows) {
    if (setjmp(png_jmpbuf(writer.png))) return false;
    png_set_IHDR(writer.png, writer.info, width, height, 8, color_type, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_rows(writer.png, writer.info, rows);
    png_write_png(writer.png, writer.info, PNG_TRANSFORM_IDENTITY, nullptr);
    return true;
}

}  // namespace

Result<Image8> decode_png8(const Source& source) {
    return decode(source, false).map([](Pixels&& pixels) { return std::move(pixels.image); });
}

Result<ImageF> decode_png_float(const Source& source) {
    return decode(source, true).map([](const Pixels& pixels) {
        const Image8& image = pixels.image;
        if (pixels.bytes_per_sample == 1) return to_float(image);
        ImageF result{.width = image.width, .height = image.height, .channels = image.channels};
        result.values.resize(image.values.size() / 2);
        for (size_t i = 0; i < result.values.size(); ++i) {
            uint16_t value = 0;
            std::memcpy(&value, image.values.data() + 2 * i, 2);
            result.values[i] = float(value) * (1.0f / 65535);
        }
        return result;
    });
}

std::vector<std::byte> encode_png(const Image8& image) {
    const int color_type = image.channels == 1   ? PNG_COLOR_TYPE_GRAY
                           : image.channels == 3 ? PNG_COLOR_TYPE_RGB
                                                 : PNG_COLOR_TYPE_RGB_ALPHA;
    std::vector<png_bytep> rows(image.height);
    for (uint32_t y = 0; y < image.height; ++y) rows[y] = const_cast<png_bytep>(image.at(0, y));
    Writer writer;
    // The arguments are right and nothing is written to disk: what is left is memory.
    if (!write(writer, image.width, image.height, color_type, rows.data())) throw std::bad_alloc();
    return std::move(writer.bytes);
}

}  // namespace lumo::scene::codec
