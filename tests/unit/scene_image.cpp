#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>

#include "scene/image.hpp"
#include "tests/unit/scene_files.hpp"

namespace lumo::scene {
namespace {

using test::make_png;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::HasSubstr;

std::span<const std::byte> bytes_of(const std::string& text) {
    return std::as_bytes(std::span(text.data(), text.size()));
}

Image8 decoded(const std::string& png) {
    auto image = decode_image8(bytes_of(png), "test");
    EXPECT_TRUE(image) << to_string(image.error());
    return image.value_or(Image8{});
}

TEST(Image, PngKeepsColourUnderZeroAlphaAndRowOrder) {
    TemporaryFolder folder;
    Image8 image{.width = 2, .height = 2, .channels = 4};
    image.values = {255, 0, 0, 0, 0, 255, 0, 128, 0, 0, 255, 255, 9, 8, 7, 6};
    ASSERT_TRUE(write_png(folder.path() / "a.png", image));
    const auto back = read_image8(folder.path() / "a.png");
    ASSERT_TRUE(back) << to_string(back.error());
    EXPECT_EQ(back->width, 2u);
    EXPECT_THAT(back->values, ElementsAreArray(image.values));
}

TEST(Image, PngOfOneAndThreeChannelsComesBackAsFour) {
    TemporaryFolder folder;
    const Image8 grey{.width = 2, .height = 1, .channels = 1, .values = {7, 200}};
    ASSERT_TRUE(write_png(folder.path() / "grey.png", grey));
    EXPECT_THAT(read_image8(folder.path() / "grey.png")->values,
                ElementsAre(7, 7, 7, 255, 200, 200, 200, 255));
    const Image8 color{.width = 1, .height = 1, .channels = 3, .values = {1, 2, 3}};
    ASSERT_TRUE(write_png(folder.path() / "color.png", color));
    EXPECT_THAT(read_image8(folder.path() / "color.png")->values, ElementsAre(1, 2, 3, 255));
}

TEST(Image, PngFormsAreExpanded) {
    EXPECT_THAT(decoded(make_png(2, 1, 8, 4, std::string("\x10\x20\x30\x00", 4))).values,
                ElementsAre(16, 16, 16, 32, 48, 48, 48, 0));  // grey and alpha
    EXPECT_THAT(decoded(make_png(2, 1, 1, 0, "\x40")).values, ElementsAre(0, 0, 0, 255, 255, 255, 255, 255));
    EXPECT_THAT(decoded(make_png(2, 1, 8, 3, std::string("\1\0", 2), "abcdef")).values,
                ElementsAre('d', 'e', 'f', 255, 'a', 'b', 'c', 255));  // palette
    // 16 bits, rounded to the nearest of 257 steps: 128.49 and 128.51.
    EXPECT_THAT(decoded(make_png(2, 1, 16, 0, "\x80\xfe\x81\x04")).values,
                ElementsAre(128, 128, 128, 255, 129, 129, 129, 255));
}

TEST(Image, WrongArgumentsAreNamed) {
    const Image8 two{.width = 1, .height = 1, .channels = 2, .values = {1, 2}};
    const auto written = write_png("never.png", two);
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().kind, ErrorKind::invalid_argument);
    const Image8 short_of_values{.width = 4, .height = 4, .channels = 1, .values = {1}};
    EXPECT_FALSE(write_png("never.png", short_of_values));
}

TEST(Image, ErrorsNameTheFile) {
    TemporaryFolder folder;
    const auto missing = read_image8(folder.path() / "none.png");
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().kind, ErrorKind::io);
    EXPECT_THAT(missing.error().subject, HasSubstr("none.png"));

    const auto text = read_image8(folder.write("text.png", "not an image"));
    ASSERT_FALSE(text);
    EXPECT_EQ(text.error().kind, ErrorKind::unsupported);

    const auto unwritable = write_png(folder.path() / "no/such/folder.png",
                                      Image8{.width = 1, .height = 1, .channels = 1, .values = {0}});
    ASSERT_FALSE(unwritable);
    EXPECT_EQ(unwritable.error().kind, ErrorKind::io);

    EXPECT_FALSE(read_image8(folder.path()));
}

TEST(Image, TruncatedFilesFail) {
    const std::string whole = make_png(8, 8, 8, 2, std::string(192, 'x'));
    for (size_t size = 0; size + 13 < whole.size(); size += 19) {
        const auto image = decode_image8(bytes_of(whole.substr(0, size)), "cut");
        EXPECT_FALSE(image) << size;
    }
}

// The header's word alone must not make anything large: these files hold a few bytes of pixels.
TEST(Image, LimitsAreCheckedOnTheHeader) {
    const auto wide = decode_image8(bytes_of(make_png(1'000'000, 1, 8, 0, "x")), "wide");
    ASSERT_FALSE(wide);
    EXPECT_EQ(wide.error().kind, ErrorKind::limit);
    EXPECT_THAT(wide.error().message, HasSubstr("16384"));

    const auto large =
        decode_image8(bytes_of(make_png(16384, 16384, 8, 0, "x")), "large", {.max_bytes = 1 << 20});
    ASSERT_FALSE(large);
    EXPECT_EQ(large.error().kind, ErrorKind::limit);

    const auto hollow = decode_image8(bytes_of(make_png(16384, 16384, 8, 6, "x")), "hollow");
    ASSERT_FALSE(hollow);
    EXPECT_THAT(hollow.error().message, HasSubstr("but has only"));

    const auto empty = decode_image8(bytes_of(make_png(0, 4, 8, 0, "")), "empty");
    ASSERT_FALSE(empty);
    EXPECT_EQ(empty.error().kind, ErrorKind::invalid_file);

    std::string jpeg = "\xff\xd8\xff\xe0";
    jpeg +=
        std::string("\x00\x04", 2) + "ab" + "\xff\xc2" + std::string("\x00\x11\x08\xff\xdc\xff\xdc\x03", 8);
    jpeg += std::string(16, '\1');
    const auto progressive = decode_image8(bytes_of(jpeg), "jpeg");
    ASSERT_FALSE(progressive);
    EXPECT_EQ(progressive.error().kind, ErrorKind::limit);
}

TEST(Image, ExrKeepsLayersAndFloatBits) {
    TemporaryFolder folder;
    ImageF plain{.width = 2, .height = 1, .channels = 4};
    plain.values = {1e-30f, -2, 3e30f, 0.1f, 5, 6, 7, INFINITY};
    const ImageF depth{.width = 2, .height = 1, .channels = 1, .values = {0.25f, 1e6f}};
    const ImageF normal{.width = 2, .height = 1, .channels = 3, .values = {1, 2, 3, 4, 5, 6}};
    const std::vector<ExrLayer> layers = {{"", plain}, {"depth", depth}, {"surface.normal", normal}};
    const auto file = folder.path() / "a.exr";
    const auto written = write_exr(file, layers);
    ASSERT_TRUE(written) << to_string(written.error());

    const auto back = read_exr(file);
    ASSERT_TRUE(back) << to_string(back.error());
    ASSERT_EQ(back->size(), layers.size());
    for (const ExrLayer& layer : layers) {
        const auto found = std::ranges::find(*back, layer.name, &ExrLayer::name);
        ASSERT_NE(found, back->end()) << layer.name;
        EXPECT_EQ(found->image.channels, layer.image.channels) << layer.name;
        EXPECT_THAT(found->image.values, ElementsAreArray(layer.image.values)) << layer.name;
    }
    EXPECT_THAT(read_image_float(file)->values, ElementsAreArray(plain.values));

    const auto limited = read_exr(file, {.max_side = 1});
    ASSERT_FALSE(limited);
    EXPECT_EQ(limited.error().kind, ErrorKind::limit);
}

TEST(Image, ExrRefusesUnequalLayers) {
    const ImageF one{.width = 1, .height = 1, .channels = 1, .values = {1}};
    const ImageF two{.width = 2, .height = 1, .channels = 1, .values = {1, 2}};
    const std::vector<ExrLayer> sizes = {{"a", one}, {"b", two}};
    EXPECT_EQ(write_exr("never.exr", sizes).error().kind, ErrorKind::invalid_argument);
    const std::vector<ExrLayer> names = {{"a", one}, {"a", one}};
    EXPECT_EQ(write_exr("never.exr", names).error().kind, ErrorKind::invalid_argument);
}

TEST(Image, HdrIsRadianceInRgb) {
    const std::filesystem::path file = std::filesystem::path(LUMO_SHARED_DATA) / "hdr/royal_esplanade_1k.hdr";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "needs the shared test data";
    const auto image = read_image_float(file);
    ASSERT_TRUE(image) << to_string(image.error());
    EXPECT_EQ(image->width, 1024u);
    EXPECT_EQ(image->height, 512u);
    EXPECT_EQ(image->channels, 3u);
    EXPECT_NEAR(*std::ranges::max_element(image->values), 49'664, 1);
}

TEST(Image, PngReadsAsFloatWithoutColourConversion) {
    TemporaryFolder folder;
    const Image8 pixel{.width = 1, .height = 1, .channels = 3, .values = {0, 128, 255}};
    ASSERT_TRUE(write_png(folder.path() / "b.png", pixel));
    const auto back = read_image_float(folder.path() / "b.png");
    ASSERT_TRUE(back) << to_string(back.error());
    EXPECT_THAT(back->values, ElementsAre(0.0f, 128 / 255.0f, 1.0f));
}

// Files with bytes flipped either decode to an image that is whole or end in an error.
TEST(Image, FlippedFilesEndWell) {
    TemporaryFolder folder;
    std::vector<std::string> files = {make_png(8, 8, 8, 6, std::string(256, 'x'))};
    const ImageF pixels{.width = 8, .height = 8, .channels = 3, .values = std::vector<float>(192, 0.5f)};
    ASSERT_TRUE(write_exr(folder.path() / "a.exr", std::vector<ExrLayer>{{"", pixels}}));
    const auto shared = std::filesystem::path(LUMO_SHARED_DATA);
    for (const auto& file :
         {folder.path() / "a.exr", shared / "gltf-invalid/khronos-validator/image/cyan.jpg"}) {
        std::ifstream stream(file, std::ios::binary);
        if (stream)
            files.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
    }
    const ImageLimits limits{.max_side = 4096, .max_bytes = 1 << 24};
    std::minstd_rand random(7);
    for (const std::string& whole : files)
        for (int i = 0; i < 300; ++i) {
            std::string flipped = whole;
            for (int k = 0; k < 4; ++k) flipped[8 + random() % (flipped.size() - 8)] = char(random() >> 8);
            const auto file = folder.write("flipped", flipped);
            if (const auto image = read_image_float(file, limits))
                EXPECT_EQ(image->values.size(), size_t(image->width) * image->height * image->channels);
            else
                EXPECT_FALSE(image.error().message.empty());
            if (const auto image = read_image8(file, limits)) {
                EXPECT_EQ(image->values.size(), size_t(image->width) * image->height * 4);
            }
        }
}

}  // namespace
}  // namespace lumo::scene
