// Each image format by itself: its forms, and files that are cut off, damaged or lie about their size.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

// After <cstdio>, which it needs and does not include.
#include <jpeglib.h>

#include "scene/image.hpp"
#include "tests/unit/scene_files.hpp"

namespace lumo::scene {
namespace {

using test::append;
using test::make_png;
using test::TemporaryFolder;
using testing::Each;
using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::HasSubstr;

std::span<const std::byte> bytes_of(const std::string& text) {
    return std::as_bytes(std::span(text.data(), text.size()));
}

std::string content_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

template <class T>
void expect_error(const Result<T>& result, ErrorKind kind, const std::string& text) {
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().kind, kind) << to_string(result.error());
    EXPECT_THAT(result.error().message, HasSubstr(text));
}

TEST(Png, DamagedChunksFail) {
    const std::string whole = make_png(8, 8, 8, 2, std::string(192, 'x'));
    ASSERT_TRUE(decode_image8(bytes_of(whole), "whole"));
    const auto size_before = [&](size_t type) { return size_t(uint8_t(whole[type - 1])); };
    for (const char* chunk : {"IHDR", "IDAT"}) {
        const size_t type = whole.find(chunk), checksum = type + 4 + size_before(type);
        std::string damaged = whole;
        damaged[checksum] ^= 0x10;
        const auto image = decode_image8(bytes_of(damaged), "crc");
        ASSERT_FALSE(image) << chunk;
        EXPECT_EQ(image.error().kind, ErrorKind::invalid_file) << chunk;
        EXPECT_THAT(image.error().message, HasSubstr("CRC")) << chunk;
    }
}

TEST(Png, LyingChunksFailBeforeMemoryIsTaken) {
    std::string lie = make_png(8, 8, 8, 2, std::string(192, 'x'));
    const size_t pixels = lie.find("IDAT") - 4;
    lie.insert(pixels, std::string("\x78\0\0\0tEXt", 8));
    expect_error(decode_image8(bytes_of(lie), "lie"), ErrorKind::invalid_file, "chunks");
}

TEST(Png, SixteenBitsAreKeptAsFloats) {
    TemporaryFolder folder;
    const auto file = folder.write("wide.png", make_png(2, 1, 16, 0, std::string("\0\1\xff\xfe", 4)));
    const auto image = read_image_float(file);
    ASSERT_TRUE(image) << to_string(image.error());
    EXPECT_THAT(image->values,
                ElementsAre(testing::FloatEq(1 / 65535.0f), testing::FloatEq(65534 / 65535.0f)));
}

struct JpegForm {
    J_COLOR_SPACE space = JCS_RGB;
    bool progressive = false;
};

// One colour everywhere, so that nothing but rounding is lost.
std::string make_jpeg(uint32_t width, uint32_t height, std::vector<JSAMPLE> color, JpegForm form = {}) {
    jpeg_compress_struct jpeg = {};
    jpeg_error_mgr errors = {};
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&jpeg, &bytes, &size);
    jpeg.image_width = width;
    jpeg.image_height = height;
    jpeg.input_components = int(color.size());
    jpeg.in_color_space = form.space;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, 100, TRUE);
    if (form.progressive) jpeg_simple_progression(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    std::vector<JSAMPLE> row;
    for (uint32_t x = 0; x < width; ++x) row.insert(row.end(), color.begin(), color.end());
    for (JSAMPROW rows[1] = {row.data()}; jpeg.next_scanline < height;) jpeg_write_scanlines(&jpeg, rows, 1);
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    std::string file(reinterpret_cast<const char*>(bytes), size);
    std::free(bytes);
    return file;
}

class JpegForms : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(BaselineAndProgressive, JpegForms, testing::Bool());

TEST_P(JpegForms, ColoursComeBack) {
    const auto rgb = decode_image8(
        bytes_of(make_jpeg(19, 7, {200, 100, 50}, {.space = JCS_RGB, .progressive = GetParam()})), "rgb");
    ASSERT_TRUE(rgb) << to_string(rgb.error());
    EXPECT_EQ(rgb->width, 19u);
    EXPECT_EQ(rgb->height, 7u);
    for (size_t i = 0; i < rgb->values.size(); i += 4) {
        EXPECT_NEAR(rgb->values[i], 200, 1);
        EXPECT_NEAR(rgb->values[i + 1], 100, 1);
        EXPECT_NEAR(rgb->values[i + 2], 50, 1);
        EXPECT_EQ(rgb->values[i + 3], 255);
    }
    const auto grey = decode_image8(
        bytes_of(make_jpeg(8, 8, {77}, {.space = JCS_GRAYSCALE, .progressive = GetParam()})), "grey");
    ASSERT_TRUE(grey) << to_string(grey.error());
    EXPECT_THAT(std::span(grey->values).first(4), ElementsAre(77, 77, 77, 255));
    // 255 minus the ink: 200/255 of the light passes cyan, 128/255 passes black.
    const auto cmyk = decode_image8(
        bytes_of(make_jpeg(8, 8, {200, 255, 0, 128}, {.space = JCS_CMYK, .progressive = GetParam()})),
        "cmyk");
    ASSERT_TRUE(cmyk) << to_string(cmyk.error());
    EXPECT_NEAR(cmyk->values[0], 100.4, 1.5);
    EXPECT_NEAR(cmyk->values[1], 128, 1);
    EXPECT_NEAR(cmyk->values[2], 0, 1);
}

TEST_P(JpegForms, CutOffFilesFail) {
    const std::string whole =
        make_jpeg(64, 64, {200, 100, 50}, {.space = JCS_RGB, .progressive = GetParam()});
    for (size_t size = 0; size + 2 < whole.size(); size += 7)
        EXPECT_FALSE(decode_image8(bytes_of(whole.substr(0, size)), "cut")) << size << " of " << whole.size();
}

TEST(Jpeg, LyingSizesFailBeforeMemoryIsTaken) {
    std::string lie = make_jpeg(8, 8, {1, 2, 3});
    const size_t frame = lie.find("\xff\xc0");
    ASSERT_NE(frame, std::string::npos);
    lie.replace(frame + 5, 4, std::string("\x40\x00\x40\x00", 4));  // 16384 x 16384
    expect_error(decode_image8(bytes_of(lie), "lie"), ErrorKind::invalid_file, "but has only");
}

// Every scan passes over the whole picture: a few hundred bytes could keep a processor busy for minutes.
TEST(Jpeg, EndlessScansFail) {
    const std::string whole = make_jpeg(64, 64, {77}, {.space = JCS_GRAYSCALE, .progressive = true});
    const size_t last_scan = whole.rfind("\xff\xda");
    std::string bomb = whole.substr(0, whole.size() - 2);
    for (int i = 0; i < 2000; ++i) bomb += whole.substr(last_scan, whole.size() - 2 - last_scan);
    bomb += "\xff\xd9";
    expect_error(decode_image8(bytes_of(bomb), "bomb"), ErrorKind::invalid_file, "scans");
}

std::string hdr_header(const std::string& size) {
    return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + size + "\n";
}

TEST(Hdr, PackedAndPlainRowsGiveTheSameRadiance) {
    TemporaryFolder folder;
    std::string plain = hdr_header("-Y 1 +X 8"), packed = plain;
    for (int i = 0; i < 8; ++i) plain += {char(128), char(64 + i), char(32), char(i < 4 ? 129 : 0)};
    packed += {2, 2, 0, 8};
    packed += {char(128 + 8), char(128)};                     // a run
    packed += {8, 64, 65, 66, 67, 68, 69, 70, 71};            // literals
    packed += {char(128 + 3), 32, 1, 32, char(128 + 4), 32};  // both
    packed += {char(128 + 4), char(129), char(128 + 4), 0};
    const auto a = read_image_float(folder.write("plain.hdr", plain));
    const auto b = read_image_float(folder.write("packed.hdr", packed));
    ASSERT_TRUE(a) << to_string(a.error());
    ASSERT_TRUE(b) << to_string(b.error());
    EXPECT_EQ(a->values, b->values);
    EXPECT_EQ(a->channels, 3u);
    // Radiance's rule: mantissa / 256 * 2^(exponent - 128).
    EXPECT_THAT(std::span(a->values).first(6), ElementsAre(1, 0.5f, 0.25f, 1, 65 / 128.0f, 0.25f));
    EXPECT_THAT(std::span(a->values).subspan(12), Each(0.0f));  // exponent 0
}

TEST(Hdr, DamagedFilesFail) {
    TemporaryFolder folder;
    const auto read = [&](const std::string& text) {
        return read_image_float(folder.write("bad.hdr", text));
    };
    const std::string head = hdr_header("-Y 1 +X 8") + std::string{2, 2, 0, 8};
    const std::string runs =
        head + std::string{char(136), 1, char(136), 2, char(136), 3, char(136), char(129)};
    ASSERT_TRUE(read(runs));
    for (size_t size = 0; size < runs.size(); ++size) EXPECT_FALSE(read(runs.substr(0, size))) << size;
    const std::string zeros(64, '\0');
    expect_error(read(head + zeros), ErrorKind::invalid_file, "packed wrongly");  // runs of no length
    expect_error(read(head + std::string{char(137), 1} + zeros), ErrorKind::invalid_file, "packed wrongly");
    expect_error(read(hdr_header("-Y 16384 +X 16384") + zeros), ErrorKind::limit, "bytes");
    expect_error(read(hdr_header("-Y 8000 +X 8000") + zeros), ErrorKind::invalid_file, "but has only");
    expect_error(read(hdr_header("-Y 1 +X 4000000000") + zeros), ErrorKind::limit, "a side");
    expect_error(read(hdr_header("-Y 1 +X 99999999999999999999") + zeros), ErrorKind::unsupported, "rows");
    expect_error(read(hdr_header("-Y 0 +X 8") + zeros), ErrorKind::invalid_file, "no pixels");
    expect_error(read(hdr_header("+Y 1 +X 8") + zeros), ErrorKind::unsupported, "rows");
    expect_error(read("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n" + zeros), ErrorKind::unsupported,
                 "RGBE");
}

// Two rows of three pixels, as the libraries of others write them.
const std::array<float, 6> exr_values = {0.5f, 1, 2, 4, 0.25f, 65504};

TEST(Exr, HalfAndIntegerChannelsKeepTheirValues) {
    TemporaryFolder folder;
    const auto file = folder.path() / "a.exr";
    {
        std::array<half, 6> halves;
        std::array<uint32_t, 6> ids = {0, 1, 2, 3, 70'000, 16'777'215};
        std::ranges::copy(exr_values, halves.begin());
        Imf::Header header(3, 2);
        header.compression() = Imf::PIZ_COMPRESSION;
        header.channels().insert("G", Imf::Channel(Imf::HALF));
        header.channels().insert("R", Imf::Channel(Imf::FLOAT));
        header.channels().insert("Diffuse.id", Imf::Channel(Imf::UINT));
        Imf::FrameBuffer pixels;
        pixels.insert("G", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(halves.data()), 2, 6));
        pixels.insert(
            "R", Imf::Slice(Imf::FLOAT, const_cast<char*>(reinterpret_cast<const char*>(exr_values.data())),
                            4, 12));
        pixels.insert("Diffuse.id", Imf::Slice(Imf::UINT, reinterpret_cast<char*>(ids.data()), 4, 12));
        Imf::OutputFile output(file.c_str(), header);
        output.setFrameBuffer(pixels);
        output.writePixels(2);
    }
    const auto layers = read_exr(file);
    ASSERT_TRUE(layers) << to_string(layers.error());
    ASSERT_EQ(layers->size(), 2u);
    EXPECT_EQ((*layers)[0].name, "");
    EXPECT_THAT((*layers)[0].image.values,
                ElementsAre(0.5f, 0.5f, 1, 1, 2, 2, 4, 4, 0.25f, 0.25f, 65504, 65504));
    EXPECT_EQ((*layers)[1].name, "Diffuse");
    EXPECT_THAT((*layers)[1].image.values, ElementsAre(0, 1, 2, 3, 70'000, 16'777'215));
}

// With a window that is not at the origin, and the rows from the bottom.
std::filesystem::path tiled_exr(const TemporaryFolder& folder) {
    const auto file = folder.path() / "tiled.exr";
    const Imath::Box2i window({-2, 5}, {0, 6});
    Imf::Header header(window, window);
    header.lineOrder() = Imf::DECREASING_Y;
    header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
    header.setTileDescription(Imf::TileDescription(2, 2));
    Imf::FrameBuffer pixels;
    pixels.insert("Y", Imf::Slice::Make(Imf::FLOAT, exr_values.data(), window));
    Imf::TiledOutputFile output(file.c_str(), header);
    output.setFrameBuffer(pixels);
    output.writeTiles(0, output.numXTiles() - 1, 0, output.numYTiles() - 1);
    return file;
}

TEST(Exr, TilesAndWindowsAreRead) {
    TemporaryFolder folder;
    const auto image = read_image_float(tiled_exr(folder));
    ASSERT_TRUE(image) << to_string(image.error());
    EXPECT_EQ(image->width, 3u);
    EXPECT_EQ(image->height, 2u);
    EXPECT_THAT(image->values, ElementsAreArray(exr_values));
}

std::string plain_exr(const TemporaryFolder& folder) {
    const ImageF image{.width = 16, .height = 64, .channels = 3, .values = std::vector<float>(3072, 0.5f)};
    EXPECT_TRUE(write_exr(folder.path() / "plain.exr", std::vector<ExrLayer>{{"", image}}));
    return content_of(folder.path() / "plain.exr");
}

TEST(Exr, CutOffFilesFail) {
    TemporaryFolder folder;
    const std::string whole = plain_exr(folder);
    for (size_t size = 0; size < whole.size(); size += whole.size() / 40)
        EXPECT_FALSE(read_exr(folder.write("cut.exr", whole.substr(0, size))))
            << size << " of " << whole.size();
}

TEST(Exr, LyingSizesFailBeforeMemoryIsTaken) {
    TemporaryFolder folder;
    const auto with = [&](std::string file, const std::string& attribute,
                          std::initializer_list<int32_t> values, size_t at) {
        std::string raw;
        append<int32_t>(raw, values);
        file.replace(file.find(attribute) + at, raw.size(), raw);
        return folder.write("lie.exr", file);
    };
    const std::string plain = plain_exr(folder);
    const std::string window = std::string("dataWindow\0box2i\0", 17);
    expect_error(read_exr(with(plain, window, {0, 0, 1'000'000, 3}, 21)), ErrorKind::limit, "a side");
    expect_error(read_exr(with(plain, window, {0, 0, 16'383, 16'383}, 21)), ErrorKind::limit, "bytes");
    expect_error(read_exr(with(plain, window, {0, 0, 8'000, 8'000}, 21)), ErrorKind::invalid_file,
                 "but has only");
    expect_error(read_exr(with(plain, window, {0, 0, -1, 3}, 21)), ErrorKind::invalid_file, "no pixels");
    expect_error(read_exr(with(plain, window, {INT32_MIN, 0, INT32_MAX, 3}, 21)), ErrorKind::limit, "a side");
    // An attribute that says to be larger than the file.
    expect_error(read_exr(with(plain, window, {0x7fffffff}, 17)), ErrorKind::invalid_file, "header");
    const std::string tiles = std::string("tiles\0tiledesc\0", 15);
    const std::string tiled = content_of(tiled_exr(folder));
    expect_error(read_exr(with(tiled, tiles, {0x7fffffff, 0x7fffffff}, 19)), ErrorKind::invalid_file,
                 "tiles");
}

TEST(Exr, NothingIsLeftOfAFileThatDoesNotFit) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
    const ImageF image{.width = 2, .height = 1, .channels = 1, .values = {1, 2}};
    expect_error(write_exr("/dev/full", std::vector<ExrLayer>{{"", image}}), ErrorKind::io,
                 "cannot be written");
    expect_error(write_png("/dev/full", {.width = 1, .height = 1, .channels = 1, .values = {1}}),
                 ErrorKind::io, "cannot be written");
}

// A TIFF of one strip without compression; little-endian.
std::string make_tiff(uint32_t width, uint32_t height, const std::string& rgb) {
    std::string file = "II";
    append<uint16_t>(file, {42});
    append<uint32_t>(file, {8});
    const std::vector<std::array<uint32_t, 4>> tags = {
        {256, 4, 1, width}, {257, 4, 1, height}, {258, 3, 1, 8},
        {259, 3, 1, 1},     {262, 3, 1, 2},      {273, 4, 1, 200},
        {277, 3, 1, 3},     {278, 4, 1, height}, {279, 4, 1, uint32_t(rgb.size())},
        {284, 3, 1, 1}};
    append<uint16_t>(file, {uint16_t(tags.size())});
    for (const auto& [tag, type, count, value] : tags) {
        append<uint16_t>(file, {uint16_t(tag), uint16_t(type)});
        append<uint32_t>(file, {count, value});
    }
    file.resize(200);
    return file + rgb;
}

class ImageModule : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(LUMO_IMAGE_MODULE_FILE)) GTEST_SKIP() << "built without OpenImageIO";
        setenv("LUMO_IMAGE_MODULE", LUMO_IMAGE_MODULE_FILE, 1);
    }
    void TearDown() override { unsetenv("LUMO_IMAGE_MODULE"); }
    TemporaryFolder folder_;
};

TEST_F(ImageModule, OtherFormatsAreReadByIt) {
    const auto file = folder_.write("a.tif", make_tiff(2, 1, "abcdef"));
    const auto bytes = read_image8(file);
    ASSERT_TRUE(bytes) << to_string(bytes.error());
    EXPECT_THAT(bytes->values, ElementsAre('a', 'b', 'c', 255, 'd', 'e', 'f', 255));
    const auto floats = read_image_float(file);
    ASSERT_TRUE(floats) << to_string(floats.error());
    EXPECT_EQ(floats->channels, 3u);
    EXPECT_FLOAT_EQ(floats->values[5], 'f' / 255.0f);
}

TEST_F(ImageModule, ItsImagesAreHeldToTheLimits) {
    const auto file = folder_.write("a.tif", make_tiff(20'000, 1, std::string(60'000, 'x')));
    expect_error(read_image8(file), ErrorKind::limit, "a side");
    const auto small = folder_.write("b.tif", make_tiff(2, 1, "abcdef"));
    expect_error(read_image_float(small, {.max_bytes = 23}), ErrorKind::limit, "bytes");
    expect_error(read_image8(folder_.write("c.tif", "no image")), ErrorKind::unsupported, "known format");
}

TEST_F(ImageModule, BytesFromOutsideNeverReachIt) {
    expect_error(decode_image8(bytes_of(make_tiff(2, 1, "abcdef")), "a.tif"), ErrorKind::unsupported,
                 "neither PNG nor JPEG");
}

TEST_F(ImageModule, AbsenceIsNamedWithARemedy) {
    setenv("LUMO_IMAGE_MODULE", "/nowhere/module.so", 1);
    TemporaryFolder folder;
    const auto image = read_image8(folder.write("a.tif", make_tiff(2, 1, "abcdef")));
    expect_error(image, ErrorKind::unsupported, "cannot be loaded");
    EXPECT_THAT(image.error().remedy, HasSubstr("LUMO_IMAGE_MODULE"));
    unsetenv("LUMO_IMAGE_MODULE");
}

}  // namespace
}  // namespace lumo::scene
