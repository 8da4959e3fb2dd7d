#include "scene/gltf_bytes.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fmt/format.h>
#include <utility>

#include "scene/file.hpp"
#include "scene/printable.hpp"

namespace lumo::scene::gltf {
namespace {

constexpr std::string_view data_scheme = "data:";
constexpr std::array<std::string_view, 2> buffer_types = {"application/octet-stream",
                                                          "application/gltf-buffer"};
constexpr std::array<std::string_view, 2> image_types = {"image/png", "image/jpeg"};

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

int base64_digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

// "http" of "http://…"; empty for a relative reference (RFC 3986, section 3.1).
std::string_view scheme_of(std::string_view uri) {
    const size_t end =
        std::min(uri.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789+-."),
                 uri.size());
    const bool is_scheme = end > 0 && end < uri.size() && uri[end] == ':' && std::isalpha(uint8_t(uri[0]));
    return is_scheme ? uri.substr(0, end) : std::string_view();
}

struct DataUri {
    std::string_view mime_type;
    std::vector<std::byte> bytes;
};

// RFC 2397.
Result<DataUri> decode_data_uri(std::string_view uri) {
    uri.remove_prefix(data_scheme.size());
    const size_t comma = uri.find(',');
    if (comma == uri.npos)
        return fail(ErrorKind::invalid_file, "", "is a data URI without a comma", "export the file again");
    std::string_view head = uri.substr(0, comma);
    const std::string_view body = uri.substr(comma + 1);
    const bool is_base64 = head.ends_with(";base64");
    if (is_base64) head.remove_suffix(std::string_view(";base64").size());
    DataUri data{.mime_type = head.substr(0, head.find(';')), .bytes = {}};
    for (size_t at = head.find(';'); at != head.npos; at = head.find(';', at + 1))
        if (head.substr(at + 1, head.find(';', at + 1) - at - 1).find('=') == head.npos)
            return fail(ErrorKind::invalid_file, "", "is a data URI with a parameter that has no value",
                        "export the file again");
    if (is_base64) {
        auto bytes = base64_decoded(body);
        if (!bytes) return tl::unexpected(bytes.error());
        data.bytes = std::move(*bytes);
        return data;
    }
    auto text = percent_decoded(body);
    if (!text) return tl::unexpected(text.error());
    const auto bytes = std::as_bytes(std::span(*text));
    data.bytes.assign(bytes.begin(), bytes.end());
    return data;
}

tl::unexpected<Error> located(const Document& document, std::string_view where, Error error) {
    error.message = fmt::format("{} {}", where, error.message);
    error.subject = document.file;
    return tl::unexpected<Error>(std::move(error));
}

}  // namespace

Result<std::string> percent_decoded(std::string_view text) {
    std::string decoded;
    for (size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            decoded += text[i];
            continue;
        }
        const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
        const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
        if (high < 0 || low < 0)
            return fail(ErrorKind::invalid_file, "", "has a '%' that two hexadecimal digits do not follow",
                        "write '%' itself as %25");
        decoded += char(high * 16 + low);
        i += 2;
    }
    return decoded;
}

Result<std::vector<std::byte>> base64_decoded(std::string_view text) {
    const auto invalid = [](std::string message) {
        return fail(ErrorKind::invalid_file, "", std::move(message), "export the file again");
    };
    if (text.size() % 4 != 0)
        return invalid(fmt::format("holds {} characters of base64, not a multiple of 4", text.size()));
    const size_t padding = text.ends_with("==") ? 2 : text.ends_with("=") ? 1 : 0;
    std::vector<std::byte> bytes;
    bytes.reserve(text.size() / 4 * 3);
    uint32_t bits = 0;
    for (size_t i = 0; i < text.size(); ++i) {
        const bool is_padding = i >= text.size() - padding;
        const int digit = is_padding ? 0 : base64_digit(text[i]);
        if (digit < 0)
            return invalid(fmt::format("holds '{}', which is not base64", printable(text.substr(i, 1))));
        bits = bits << 6 | uint32_t(digit);
        if (i % 4 == 3)
            for (const int shift : {16, 8, 0}) bytes.push_back(std::byte(uint8_t(bits >> shift)));
    }
    bytes.resize(bytes.size() - padding);
    return bytes;
}

Result<std::filesystem::path> resolve_uri(const std::filesystem::path& folder, std::string_view uri) {
    const std::string shown = "'" + printable(uri, 100) + "'";
    if (const std::string_view scheme = scheme_of(uri); !scheme.empty())
        return fail(ErrorKind::unsupported, "", shown + " is not a relative path; lumo only reads files",
                    "put the file beside the glTF and name it by its relative path");
    auto decoded = percent_decoded(uri);
    if (!decoded) {
        decoded.error().message = shown + " " + decoded.error().message;
        return tl::unexpected(decoded.error());
    }
    const std::filesystem::path relative(*decoded);
    if (decoded->empty() || decoded->find('\0') != std::string::npos)
        return fail(ErrorKind::invalid_file, "", shown + " is not the name of a file",
                    "export the file again");

    constexpr std::string_view beside = "put the file into the glTF's folder or below it";
    const std::string outside = shown + " leads out of the glTF's folder, where lumo reads nothing";
    if (relative.is_absolute()) return fail(ErrorKind::invalid_file, "", outside, std::string(beside));
    std::error_code error;
    const std::filesystem::path root = std::filesystem::canonical(folder, error);
    if (error) return fail(ErrorKind::io, "", "cannot be found: " + error.message(), "check the path");
    // Before the file system is asked, so that what exists elsewhere cannot be felt out.
    if (const auto plain = relative.lexically_normal();
        plain.begin() != plain.end() && *plain.begin() == "..")
        return fail(ErrorKind::invalid_file, "", outside, std::string(beside));
    const std::filesystem::path target = std::filesystem::canonical(root / relative, error);
    if (error)
        return fail(ErrorKind::io, "", shown + " cannot be found: " + error.message(), std::string(beside));
    const auto mismatch = std::mismatch(root.begin(), root.end(), target.begin(), target.end());
    if (mismatch.first != root.end()) return fail(ErrorKind::invalid_file, "", outside, std::string(beside));
    if (!std::filesystem::is_regular_file(target, error))
        return fail(ErrorKind::io, "", shown + " is not a regular file", std::string(beside));
    return target;
}

Result<Bytes> Bytes::load(Document& document, const Limits& limits) {
    Bytes bytes(document, limits);
    bytes.buffers_.resize(document.buffers.size());
    for (size_t i = 0; i < document.buffers.size(); ++i)
        if (auto loaded = bytes.load_buffer(i); !loaded) return tl::unexpected(loaded.error());
    for (size_t i = 0; i < document.model.bufferViews.size(); ++i)
        if (auto checked = bytes.check_view(i); !checked) return tl::unexpected(checked.error());
    return bytes;
}

Result<void> Bytes::load_buffer(size_t index) {
    const BufferSource& source = document_->buffers[index];
    const std::string where = fmt::format("buffers[{}]", index);
    std::span<const std::byte> bytes;
    if (!source.uri) {
        const bool takes_chunk = index == 0 && document_->binary_chunk;
        if (!takes_chunk) {
            document_->warnings.add(where + " has neither a uri nor a GLB's binary chunk");
            return {};
        }
        bytes = *document_->binary_chunk;
        // Up to three bytes pad a chunk.
        if (bytes.size() > source.byte_length + 3)
            document_->warnings.add(fmt::format("{} has {} bytes, fewer than the {} of the GLB's chunk",
                                                where, source.byte_length, bytes.size()));
    } else if (source.uri->starts_with(data_scheme)) {
        auto embedded = from_uri(*source.uri, where + ".uri", buffer_types);
        if (!embedded) return tl::unexpected(embedded.error());
        embedded_.push_back(std::move(*embedded));
        bytes = embedded_.back();
    } else {
        const auto path = resolve_uri(document_->folder, *source.uri);
        if (!path) return located(*document_, where + ".uri", path.error());
        auto file = files_.find(*path);
        if (file == files_.end()) {
            auto content = from_uri(*source.uri, where + ".uri", buffer_types);
            if (!content) return tl::unexpected(content.error());
            file = files_.emplace(*path, std::move(*content)).first;
        }
        bytes = file->second;
    }
    if (bytes.size() < source.byte_length)
        return fail(ErrorKind::invalid_file, document_->file,
                    fmt::format("{}.byteLength is {}, but its data has {} bytes", where, source.byte_length,
                                bytes.size()),
                    "export the file again");
    buffers_[index] = bytes.first(source.byte_length);
    return {};
}

Result<void> Bytes::check_view(size_t index) const {
    const tinygltf::BufferView& view = document_->model.bufferViews[index];
    const uint64_t buffer_size = document_->buffers[size_t(view.buffer)].byte_length;
    const std::string where = fmt::format("bufferViews[{}]", index);
    if (view.byteOffset > buffer_size || view.byteLength > buffer_size - view.byteOffset)
        return fail(ErrorKind::invalid_file, document_->file,
                    fmt::format("{} has {} bytes from {}, but buffers[{}] has {}", where, view.byteLength,
                                view.byteOffset, view.buffer, buffer_size),
                    "export the file again");
    if (view.byteStride > 0 && view.target == TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER)
        document_->warnings.add(where + " holds indices and has a byteStride");
    if (view.byteStride > view.byteLength)
        document_->warnings.add(fmt::format("{}.byteStride is {}, more than its {} bytes", where,
                                            view.byteStride, view.byteLength));
    return {};
}

Result<std::span<const std::byte>> Bytes::view(int index) const {
    const tinygltf::BufferView& view = document_->model.bufferViews[size_t(index)];
    const auto& buffer = buffers_[size_t(view.buffer)];
    if (!buffer)
        return fail(ErrorKind::invalid_file, document_->file,
                    fmt::format("bufferViews[{}] is in buffers[{}], which has no data", index, view.buffer),
                    "export the file again");
    return buffer->subspan(view.byteOffset, view.byteLength);
}

Result<std::span<const std::byte>> Bytes::image(size_t index) {
    const ImageSource& source = document_->images[index];
    const std::string where = fmt::format("images[{}]", index);
    if (source.uri) {
        auto bytes = from_uri(*source.uri, where + ".uri", image_types);
        if (!bytes) return tl::unexpected(bytes.error());
        // The next image takes this one's place in memory.
        left_ += bytes->size();
        image_ = std::move(*bytes);
        return image_;
    }
    if (source.buffer_view < 0)
        return fail(ErrorKind::invalid_file, document_->file, where + " has neither a uri nor a bufferView",
                    "export the file again");
    return view(source.buffer_view);
}

Result<std::vector<std::byte>> Bytes::from_uri(const std::string& uri, std::string_view where,
                                               std::span<const std::string_view> mime_types) {
    Result<std::vector<std::byte>> bytes;
    if (uri.starts_with(data_scheme)) {
        auto data = decode_data_uri(uri);
        if (!data) return located(*document_, where, data.error());
        if (std::ranges::find(mime_types, data->mime_type) == mime_types.end())
            document_->warnings.add(fmt::format("{} is of the media type '{}', not {}", where,
                                                printable(data->mime_type, 60),
                                                fmt::join(mime_types, " or ")));
        bytes = std::move(data->bytes);
    } else {
        const auto path = resolve_uri(document_->folder, uri);
        if (!path) return located(*document_, where, path.error());
        bytes = read_file(*path, left_);
        if (!bytes) return bytes;
    }
    if (bytes->size() > left_)
        return fail(ErrorKind::limit, document_->file,
                    fmt::format("{} goes beyond the limit of all buffers together", where), "split the file");
    left_ -= bytes->size();
    return bytes;
}

}  // namespace lumo::scene::gltf
