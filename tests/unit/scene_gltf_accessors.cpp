// Every form in which a glTF file may hold its numbers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/gltf_accessor.hpp"
#include "tests/unit/scene_gltf_file.hpp"

namespace lumo::scene {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::HasSubstr;

// The numbers of an accessor, read as the loader reads them.
Result<std::vector<float>> floats_of(GltfFile& file, int accessor) {
    const TemporaryFolder folder;
    auto document = gltf::read_document(file.write(folder), {});
    if (!document) return tl::unexpected(document.error());
    const auto bytes = gltf::Bytes::load(*document, {});
    if (!bytes) return tl::unexpected(bytes.error());
    if (auto checked = gltf::check_accessors(*document, {}); !checked) return tl::unexpected(checked.error());
    return gltf::read_floats(*document, *bytes, accessor);
}

std::vector<float> floats(GltfFile& file, int accessor) {
    auto values = floats_of(file, accessor);
    EXPECT_TRUE(values) << to_string(values.error());
    return values.value_or(std::vector<float>{});
}

template <class T>
std::string raw(std::initializer_list<T> values) {
    std::string bytes;
    append<T>(bytes, values);
    return bytes;
}

struct Form {
    const char* name;
    int component_type;
    bool normalized;
    std::string bytes;
    std::vector<float> values;
};

class AccessorForm : public testing::TestWithParam<Form> {};

TEST_P(AccessorForm, IsReadAsTheSpecificationSays) {
    GltfFile file;
    const Form& form = GetParam();
    const int accessor = file.accessor(file.view(form.bytes), form.component_type, form.values.size(),
                                       "SCALAR", {{"normalized", form.normalized}});
    EXPECT_THAT(floats(file, accessor), ElementsAreArray(form.values));
}

INSTANTIATE_TEST_SUITE_P(
    All, AccessorForm,
    testing::Values(
        Form{"Byte", byte_type, false, raw<int8_t>({-128, 0, 127}), {-128, 0, 127}},
        Form{"ByteNormalized", byte_type, true, raw<int8_t>({-128, -127, 0, 127}), {-1, -1, 0, 1}},
        Form{"UnsignedByte", ubyte_type, false, raw<uint8_t>({0, 255}), {0, 255}},
        Form{"UnsignedByteNormalized", ubyte_type, true, raw<uint8_t>({0, 51, 255}), {0, 0.2f, 1}},
        Form{"Short", short_type, false, raw<int16_t>({-32768, 7}), {-32768, 7}},
        Form{"ShortNormalized", short_type, true, raw<int16_t>({-32768, 0, 32767}), {-1, 0, 1}},
        Form{"UnsignedShort", ushort_type, false, raw<uint16_t>({65535, 1}), {65535, 1}},
        Form{"UnsignedShortNormalized", ushort_type, true, raw<uint16_t>({65535, 13107}), {1, 0.2f}},
        Form{"UnsignedInt", uint_type, false, raw<uint32_t>({1u << 31, 3}), {2147483648.0f, 3}},
        Form{"Float", float_type, false, raw<float>({-1.5f, 1e-40f}), {-1.5f, 1e-40f}}),
    [](const auto& info) { return info.param.name; });

TEST(Accessor, StrideAndOffsetSelectTheElements) {
    GltfFile file;
    // Interleaved: position, uv, position, uv.
    const int view = file.view(raw<float>({1, 2, 3, 10, 20, 4, 5, 6, 30, 40}), 20);
    const int positions = file.accessor(view, float_type, 2, "VEC3");
    const int uvs = file.accessor(view, float_type, 2, "VEC2", {{"byteOffset", 12}});
    EXPECT_THAT(floats(file, positions), ElementsAre(1, 2, 3, 4, 5, 6));
    EXPECT_THAT(floats(file, uvs), ElementsAre(10, 20, 30, 40));
}

TEST(Accessor, MatrixColumnsAreAlignedToFourBytes) {
    GltfFile file;
    const int mat2 = file.accessor(file.view(raw<int8_t>({1, 2, 0, 0, 3, 4})), byte_type, 1, "MAT2");
    const int mat3 =
        file.accessor(file.view(raw<int8_t>({1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9})), byte_type, 1, "MAT3");
    const int wide =
        file.accessor(file.view(raw<int16_t>({1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9})), short_type, 1, "MAT3");
    const int mat4 =
        file.accessor(file.view(raw<float>({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16})),
                      float_type, 1, "MAT4");
    EXPECT_THAT(floats(file, mat2), ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(floats(file, mat3), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9));
    EXPECT_THAT(floats(file, wide), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9));
    EXPECT_THAT(floats(file, mat4), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16));
}

TEST(Accessor, SparseReplacesElements) {
    for (const int index_type : {ubyte_type, ushort_type, uint_type}) {
        GltfFile file;
        const std::string indices = index_type == ubyte_type    ? raw<uint8_t>({1, 3})
                                    : index_type == ushort_type ? raw<uint16_t>({1, 3})
                                                                : raw<uint32_t>({1, 3});
        const nlohmann::json sparse = {
            {"count", 2},
            {"indices",
             {{"bufferView", file.view("abcd" + indices)}, {"byteOffset", 4}, {"componentType", index_type}}},
            {"values", {{"bufferView", file.view(raw<float>({0, 50, 60, 70, 80}))}, {"byteOffset", 4}}}};
        const int dense = file.accessor(file.view(raw<float>({1, 2, 3, 4, 5, 6, 7, 8})), float_type, 4,
                                        "VEC2", {{"sparse", sparse}});
        const int zeros = file.accessor(-1, float_type, 4, "VEC2", {{"sparse", sparse}});
        EXPECT_THAT(floats(file, dense), ElementsAre(1, 2, 50, 60, 5, 6, 70, 80));
        EXPECT_THAT(floats(file, zeros), ElementsAre(0, 0, 50, 60, 0, 0, 70, 80));
    }
}

TEST(Accessor, WithoutAnythingIsZeros) {
    GltfFile file;
    EXPECT_THAT(floats(file, file.accessor(-1, short_type, 3, "SCALAR")), ElementsAre(0, 0, 0));
}

// One byte short, or one element too many, in each of the ways in which an accessor can reach out of its view.
TEST(Accessor, BeyondItsViewIsAnError) {
    const auto error = [](auto make) {
        GltfFile file;
        const int accessor = make(file);
        const auto values = floats_of(file, accessor);
        EXPECT_FALSE(values);
        return values ? std::string() : values.error().message;
    };
    EXPECT_THAT(
        error([](GltfFile& f) { return f.accessor(f.view(std::string(11, 'a')), float_type, 1, "VEC3"); }),
        HasSubstr("accessors[0]"));
    EXPECT_THAT(
        error([](GltfFile& f) { return f.accessor(f.view(std::string(24, 'a')), float_type, 3, "VEC3"); }),
        HasSubstr("has 3 elements of 12 bytes"));
    EXPECT_THAT(
        error([](GltfFile& f) {
            return f.accessor(f.view(std::string(24, 'a')), float_type, 2, "VEC3", {{"byteOffset", 4}});
        }),
        HasSubstr("from 4"));
    EXPECT_THAT(error([](GltfFile& f) {
                    return f.accessor(f.view(std::string(24, 'a'), 16), float_type, 2, "VEC3");
                }),
                HasSubstr("16 apart"));
    EXPECT_THAT(
        error([](GltfFile& f) { return f.accessor(f.view(std::string(64, 'a'), 8), float_type, 2, "VEC3"); }),
        HasSubstr("byteStride is 8"));
    // count * stride overflows 64 bits.
    EXPECT_THAT(error([](GltfFile& f) {
                    return f.accessor(f.view(std::string(64, 'a'), 252), float_type, 9007199254740992,
                                      "VEC3");
                }),
                HasSubstr("accessors[0]"));
    EXPECT_THAT(
        error([](GltfFile& f) {
            return f.accessor(f.view("abcd"), ubyte_type, 1, "SCALAR", {{"byteOffset", 9007199254740992}});
        }),
        HasSubstr("accessors[0]"));
    // The last element just fits, though the stride would go on.
    GltfFile fits;
    const int accessor = fits.accessor(fits.view(std::string(28, '\0'), 16), float_type, 2, "VEC3");
    EXPECT_TRUE(floats_of(fits, accessor));
}

TEST(Accessor, SparseFaultsAreErrors) {
    const auto error = [](int count, uint8_t index, size_t value_bytes) {
        GltfFile file;
        const nlohmann::json sparse = {
            {"count", count},
            {"indices", {{"bufferView", file.view(raw<uint8_t>({0, index}))}, {"componentType", ubyte_type}}},
            {"values", {{"bufferView", file.view(std::string(value_bytes, '\0'))}}}};
        const auto values = floats_of(file, file.accessor(-1, float_type, 3, "SCALAR", {{"sparse", sparse}}));
        return values ? std::string() : values.error().message;
    };
    EXPECT_EQ(error(2, 2, 8), "");
    EXPECT_THAT(error(2, 3, 8), HasSubstr("sparse.indices has 3 at 1"));
    EXPECT_THAT(error(2, 2, 7), HasSubstr("sparse.values"));
    EXPECT_THAT(error(3, 2, 12), HasSubstr("sparse.indices"));
    EXPECT_THAT(error(4, 2, 16), HasSubstr("4 sparse ones"));
}

TEST(Accessor, NumbersThatAreNotFiniteAreNamed) {
    for (const float bad : {INFINITY, -INFINITY, NAN}) {
        GltfFile file;
        const int accessor = file.accessor(file.view(raw<float>({0, 1, 2, 3, bad, 5})), float_type, 2, "VEC3",
                                           {{"name", "points"}});
        const auto values = floats_of(file, accessor);
        ASSERT_FALSE(values);
        EXPECT_EQ(values.error().kind, ErrorKind::invalid_file);
        EXPECT_THAT(values.error().message, HasSubstr("accessors[0] ('points')"));
        EXPECT_THAT(values.error().message, HasSubstr("element 1"));
    }
}

}  // namespace
}  // namespace lumo::scene
