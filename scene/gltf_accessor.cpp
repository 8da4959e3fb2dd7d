#include "scene/gltf_accessor.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

#include "scene/printable.hpp"

namespace lumo::scene::gltf {
namespace {

struct Layout {
    uint32_t rows = 1;
    uint32_t columns = 1;
    uint32_t component_size = 4;

    uint32_t components() const { return rows * columns; }
    // Each column of a matrix begins on a multiple of 4 bytes (glTF 2.0, section 3.6.2.4, "Data Alignment").
    uint32_t column_stride() const {
        const uint32_t packed = rows * component_size;
        return columns > 1 ? (packed + 3) / 4 * 4 : packed;
    }
    uint32_t size() const { return column_stride() * columns; }
    // Up to the last number: what pads the last column need not be there.
    uint32_t extent() const { return offset(components() - 1) + component_size; }
    uint32_t offset(uint32_t component) const {
        return component / rows * column_stride() + component % rows * component_size;
    }
};

uint32_t component_size(int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        default:
            return 4;
    }
}

Layout layout_of(const tinygltf::Accessor& accessor) {
    const uint32_t size = component_size(accessor.componentType);
    switch (accessor.type) {
        case TINYGLTF_TYPE_VEC2:
            return {2, 1, size};
        case TINYGLTF_TYPE_VEC3:
            return {3, 1, size};
        case TINYGLTF_TYPE_VEC4:
            return {4, 1, size};
        case TINYGLTF_TYPE_MAT2:
            return {2, 2, size};
        case TINYGLTF_TYPE_MAT3:
            return {3, 3, size};
        case TINYGLTF_TYPE_MAT4:
            return {4, 4, size};
        default:
            return {1, 1, size};
    }
}

template <class T>
T load(const std::byte* from) {
    T value;
    std::memcpy(&value, from, sizeof(T));
    return value;
}

template <class T>
float load_normalized(const std::byte* from) {
    return std::max(float(load<T>(from)) / float(std::numeric_limits<T>::max()), -1.0f);
}

float load_float(const std::byte* from, int type, bool normalized) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return normalized ? load_normalized<int8_t>(from) : float(load<int8_t>(from));
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return normalized ? load_normalized<uint8_t>(from) : float(load<uint8_t>(from));
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return normalized ? load_normalized<int16_t>(from) : float(load<int16_t>(from));
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return normalized ? load_normalized<uint16_t>(from) : float(load<uint16_t>(from));
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return float(load<uint32_t>(from));
        default:
            return load<float>(from);
    }
}

uint32_t load_index(const std::byte* from, int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return load<uint8_t>(from);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return load<uint16_t>(from);
        default:
            return load<uint32_t>(from);
    }
}

std::string name_of(const Document& document, int accessor) {
    const std::string& name = document.model.accessors[size_t(accessor)].name;
    return name.empty() ? fmt::format("accessors[{}]", accessor)
                        : fmt::format("accessors[{}] ('{}')", accessor, printable(name, 60));
}

tl::unexpected<Error> invalid(const Document& document, std::string message) {
    return fail(ErrorKind::invalid_file, document.file, std::move(message), "export the file again");
}

// Whether count elements of size bytes, stride apart, from offset fit into so many bytes; free of overflow.
bool fits(uint64_t offset, uint64_t count, uint64_t stride, uint64_t size, uint64_t bytes) {
    if (offset > bytes || size > bytes - offset) return false;
    return count <= 1 || (count - 1) <= (bytes - offset - size) / stride;
}

Result<void> check_dense(Document& document, int index, const Layout& layout) {
    const tinygltf::Accessor& accessor = document.model.accessors[size_t(index)];
    const tinygltf::BufferView& view = document.model.bufferViews[size_t(accessor.bufferView)];
    const uint64_t stride = view.byteStride ? view.byteStride : layout.size();
    if (stride < layout.size())
        return invalid(document,
                       fmt::format("{} has elements of {} bytes, but bufferViews[{}].byteStride is {}",
                                   name_of(document, index), layout.size(), accessor.bufferView, stride));
    if (!fits(accessor.byteOffset, accessor.count, stride, layout.extent(), view.byteLength))
        return invalid(
            document,
            fmt::format("{} has {} elements of {} bytes, {} apart, from {}, but bufferViews[{}] has {}",
                        name_of(document, index), accessor.count, layout.size(), stride, accessor.byteOffset,
                        accessor.bufferView, view.byteLength));
    const uint64_t alignment = layout.columns > 1 ? 4 : layout.component_size;
    if (accessor.byteOffset % alignment != 0 || (view.byteOffset + accessor.byteOffset) % alignment != 0 ||
        stride % alignment != 0)
        document.warnings.add(
            fmt::format("{} is not aligned to {} bytes", name_of(document, index), alignment));
    return {};
}

Result<void> check_sparse(Document& document, int index, const Layout& layout) {
    const tinygltf::Accessor& accessor = document.model.accessors[size_t(index)];
    const auto& sparse = accessor.sparse;
    const uint64_t count = uint64_t(sparse.count);
    if (count > accessor.count)
        return invalid(document, fmt::format("{} has {} elements, but {} sparse ones",
                                             name_of(document, index), accessor.count, count));
    const auto check = [&](std::string_view part, int view_index, int offset, uint64_t size,
                           uint64_t extent) -> Result<void> {
        const uint64_t bytes = document.model.bufferViews[size_t(view_index)].byteLength;
        if (fits(uint64_t(offset), count, size, extent, bytes)) return {};
        return invalid(
            document,
            fmt::format("{}.sparse.{} has {} elements of {} bytes from {}, but bufferViews[{}] has {}",
                        name_of(document, index), part, count, size, offset, view_index, bytes));
    };
    const uint64_t index_size = component_size(sparse.indices.componentType);
    if (auto checked =
            check("indices", sparse.indices.bufferView, sparse.indices.byteOffset, index_size, index_size);
        !checked)
        return checked;
    return check("values", sparse.values.bufferView, sparse.values.byteOffset, layout.size(),
                 layout.extent());
}

// Calls read(element, bytes) for each element whose bytes there are, the sparse ones last.
template <class Read>
Result<void> for_each_element(const Document& document, const Bytes& bytes, int index, Read read) {
    const tinygltf::Accessor& accessor = document.model.accessors[size_t(index)];
    const Layout layout = layout_of(accessor);
    if (accessor.bufferView >= 0) {
        const auto view = bytes.view(accessor.bufferView);
        if (!view) return tl::unexpected(view.error());
        const uint64_t view_stride = document.model.bufferViews[size_t(accessor.bufferView)].byteStride;
        const uint64_t stride = view_stride ? view_stride : layout.size();
        for (uint64_t i = 0; i < accessor.count; ++i)
            read(i, view->data() + accessor.byteOffset + i * stride);
    }
    if (!accessor.sparse.isSparse) return {};
    const auto indices = bytes.view(accessor.sparse.indices.bufferView);
    if (!indices) return tl::unexpected(indices.error());
    const auto values = bytes.view(accessor.sparse.values.bufferView);
    if (!values) return tl::unexpected(values.error());
    const uint32_t index_size = component_size(accessor.sparse.indices.componentType);
    for (uint64_t i = 0; i < uint64_t(accessor.sparse.count); ++i) {
        const uint32_t element =
            load_index(indices->data() + uint64_t(accessor.sparse.indices.byteOffset) + i * index_size,
                       accessor.sparse.indices.componentType);
        if (element >= accessor.count)
            return invalid(document, fmt::format("{}.sparse.indices has {} at {}, but there are {} elements",
                                                 name_of(document, index), element, i, accessor.count));
        read(element, values->data() + uint64_t(accessor.sparse.values.byteOffset) + i * layout.size());
    }
    return {};
}

}  // namespace

Result<void> check_accessors(Document& document, const Limits& limits) {
    uint64_t unbacked = 0;
    for (int i = 0; i < int(document.model.accessors.size()); ++i) {
        tinygltf::Accessor& accessor = document.model.accessors[size_t(i)];
        const Layout layout = layout_of(accessor);
        if (accessor.bufferView >= 0) {
            if (auto checked = check_dense(document, i, layout); !checked) return checked;
        } else {
            if (accessor.count > limits.max_unbacked_elements - unbacked)
                return fail(ErrorKind::limit, document.file,
                            fmt::format("{} brings the elements without a bufferView beyond the limit of {}",
                                        name_of(document, i), limits.max_unbacked_elements),
                            "store them in a buffer");
            unbacked += accessor.count;
        }
        if (accessor.sparse.isSparse)
            if (auto checked = check_sparse(document, i, layout); !checked) return checked;
        const bool is_wide = accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT ||
                             accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
        if (accessor.normalized && is_wide) {
            document.warnings.add(name_of(document, i) +
                                  " is normalized, which its component type cannot be");
            accessor.normalized = false;
        }
    }
    return {};
}

void check_values(Document& document, const Bytes& bytes) {
    uint64_t left = uint64_t(1) << 26;
    for (int i = 0; i < int(document.model.accessors.size()); ++i) {
        const tinygltf::Accessor& accessor = document.model.accessors[size_t(i)];
        const Layout layout = layout_of(accessor);
        const uint32_t components = layout.components();
        const uint64_t total = accessor.count * components;
        if (total > left) return;
        left -= total;
        for (const auto* bounds : {&accessor.minValues, &accessor.maxValues})
            if (!bounds->empty() && bounds->size() != components)
                document.warnings.add(fmt::format("{} has elements of {} numbers, but a bound of {}",
                                                  name_of(document, i), components, bounds->size()));
        const bool is_bounded =
            accessor.minValues.size() == components && accessor.maxValues.size() == components;
        bool is_inside = true, is_finite = true;
        const auto read = for_each_element(document, bytes, i, [&](uint64_t, const std::byte* from) {
            for (uint32_t c = 0; c < components; ++c) {
                const float value = load_float(from + layout.offset(c), accessor.componentType, false);
                is_finite &= std::isfinite(value);
                // Bounds have often been rounded on their way through text.
                is_inside &=
                    !is_bounded || (value >= float(accessor.minValues[c]) - 1e-6f * std::abs(value) &&
                                    value <= float(accessor.maxValues[c]) + 1e-6f * std::abs(value));
            }
        });
        if (!read) document.warnings.add(read.error().message);
        if (!is_finite) document.warnings.add(name_of(document, i) + " has numbers that are not finite");
        if (!is_inside) document.warnings.add(name_of(document, i) + " has elements outside its min and max");
    }
}

uint32_t component_count(const tinygltf::Accessor& accessor) { return layout_of(accessor).components(); }

Result<std::vector<float>> read_floats(const Document& document, const Bytes& bytes, int index) {
    const tinygltf::Accessor& accessor = document.model.accessors[size_t(index)];
    const Layout layout = layout_of(accessor);
    const uint32_t components = layout.components();
    std::vector<float> values(accessor.count * components, 0.0f);
    auto read = for_each_element(document, bytes, index, [&](uint64_t element, const std::byte* from) {
        for (uint32_t c = 0; c < components; ++c)
            values[element * components + c] =
                load_float(from + layout.offset(c), accessor.componentType, accessor.normalized);
    });
    if (!read) return tl::unexpected(read.error());
    const auto infinite = std::ranges::find_if_not(values, [](float v) { return std::isfinite(v); });
    if (infinite != values.end())
        return invalid(document, fmt::format("{} has {} in element {}", name_of(document, index), *infinite,
                                             uint64_t(infinite - values.begin()) / components));
    return values;
}

Result<std::vector<uint32_t>> read_indices(const Document& document, const Bytes& bytes, int index) {
    const tinygltf::Accessor& accessor = document.model.accessors[size_t(index)];
    const int type = accessor.componentType;
    const bool is_unsigned = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                             type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                             type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    if (accessor.type != TINYGLTF_TYPE_SCALAR || !is_unsigned || accessor.normalized)
        return invalid(document, name_of(document, index) +
                                     " is used as indices, but is not SCALAR of plain "
                                     "unsigned integers");
    std::vector<uint32_t> indices(accessor.count, 0);
    auto read = for_each_element(document, bytes, index, [&](uint64_t element, const std::byte* from) {
        indices[element] = load_index(from, type);
    });
    if (!read) return tl::unexpected(read.error());
    return indices;
}

}  // namespace lumo::scene::gltf
