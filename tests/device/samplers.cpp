// Filters and address modes against the specification's arithmetic on the CPU.
#include <algorithm>
#include <cmath>
#include <glm/vec4.hpp>
#include <random>

#include "shaders/test_rhi/sample_cube.hpp"
#include "shaders/test_rhi/sample_d2.hpp"
#include "shaders/test_rhi/sample_d3.hpp"
#include "tests/support/device_test.hpp"

namespace lumo::rhi {
namespace {

using namespace testing_support;
using namespace shaders::test_rhi;
using enum Dimension;

struct SamplerTest : DeviceTest {
    template <class P, Dimension D>
    std::vector<float> sample(View<D> view, const SamplerDesc& desc, const std::vector<glm::vec4>& points,
                              float lod) {
        Buffer at = buffer_with(points);
        Buffer results = buffer(points.size() * sizeof(glm::vec4));
        const Sampler with = sampler(desc);
        run(compute<P>(), {.source = {view, with}, .Points = at.slice(), .Results = results.slice()},
            {.count = uint32_t(points.size()), .lod = lod}, {groups_for(uint32_t(points.size()), 64)});
        std::vector<float> reds;
        for (const glm::vec4& texel : contents<glm::vec4>(results)) reds.push_back(texel.r);
        return reds;
    }
};
INSTANTIATE_TEST_SUITE_P(Device, SamplerTest, both_apis, api_name);

/// A chain of random texels in [0, 1], of which each mip is its own.
struct Picture {
    Extent extent;
    std::vector<std::vector<float>> mips;

    Picture(Extent size, uint32_t count) : extent(size) {
        std::mt19937 random(11);
        std::uniform_real_distribution<float> range(0, 1);
        for (uint32_t mip = 0; mip < count; ++mip) {
            const Extent own = mip_extent(extent, mip);
            auto& texels = mips.emplace_back(own.width * own.height * own.depth);
            for (float& texel : texels) texel = range(random);
        }
    }
};

/// The texel that a coordinate beyond the edge stands for; -1 for the border.
int wrap(AddressMode mode, int i, int size) {
    const auto modulo = [](int a, int b) { return ((a % b) + b) % b; };
    switch (mode) {
        case AddressMode::repeat:
            return modulo(i, size);
        case AddressMode::mirrored_repeat: {
            const int twice = modulo(i, 2 * size);
            return twice < size ? twice : 2 * size - 1 - twice;
        }
        case AddressMode::clamp_to_edge:
            return std::clamp(i, 0, size - 1);
        case AddressMode::clamp_to_border:
            return i < 0 || i >= size ? -1 : i;
    }
    return 0;
}

double filtered(const Picture& picture, uint32_t mip, const SamplerDesc& desc, FilterMode mode,
                const glm::vec4& at) {
    const Extent size = mip_extent(picture.extent, mip);
    const double border = desc.border == BorderColor::opaque_white ? 1 : 0;
    const int sides[] = {int(size.width), int(size.height), int(size.depth)};
    const AddressMode modes[] = {desc.address_u, desc.address_v, desc.address_w};
    int first[3];
    double fraction[3];
    for (int axis = 0; axis < 3; ++axis) {
        const double x = double(at[axis]) * sides[axis] - (mode == FilterMode::linear ? 0.5 : 0);
        first[axis] = int(std::floor(x));
        fraction[axis] = mode == FilterMode::linear ? x - std::floor(x) : 0;
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        int texel[3];
        bool outside = false;
        for (int axis = 0; axis < 3; ++axis) {
            const int step = corner >> axis & 1;
            weight *= step ? fraction[axis] : 1 - fraction[axis];
            texel[axis] = wrap(modes[axis], first[axis] + step, sides[axis]);
            outside = outside || texel[axis] < 0;
        }
        const int index = (texel[2] * sides[1] + texel[1]) * sides[0] + texel[0];
        if (weight > 0) sum += weight * (outside ? border : double(picture.mips[mip][size_t(index)]));
    }
    return sum;
}

double expected(const Picture& picture, const SamplerDesc& desc, const glm::vec4& at, float lod) {
    lod = std::clamp(lod, desc.min_lod, desc.max_lod);
    const FilterMode mode = lod > 0 ? desc.minification : desc.magnification;
    const double last = double(picture.mips.size()) - 1;
    if (desc.mip == FilterMode::nearest) {
        // Halves go down, by both specifications' formula.
        const auto mip = uint32_t(std::clamp(std::ceil(double(lod) + 0.5) - 1, 0.0, last));
        return filtered(picture, mip, desc, mode, at);
    }
    const double level = std::clamp(double(lod), 0.0, last);
    const double fraction = level - std::floor(level);
    const auto mip = uint32_t(level);
    const double fine = filtered(picture, mip, desc, mode, at);
    return fraction == 0
               ? fine
               : fine * (1 - fraction) +
                     fraction * filtered(picture, std::min(mip + 1, uint32_t(last)), desc, mode, at);
}

/// Points within [-1.6, 2.6], none near the middle between two texels, where either is right.
std::vector<glm::vec4> scattered(bool volume) {
    std::mt19937 random(5);
    std::vector<glm::vec4> points;
    while (points.size() < 400) {
        glm::vec4 point{0, 0, volume ? 0 : 0.5f, 0};
        bool clear = true;
        for (int axis = 0; axis < (volume ? 3 : 2); ++axis) {
            point[axis] = float(random() % 4200) / 1000 - 1.6f;
            for (int side : {8, 4, 2}) {
                const float x = point[axis] * float(side);
                clear = clear && std::abs(x - std::round(x)) > 0.02f;
            }
        }
        if (clear) points.push_back(point);
    }
    return points;
}

TEST_P(SamplerTest, FiltersAndAddressesFollowTheSpecification) {
    const Format format = Format::r32_float;
    const bool linear = has(device().format_caps(format), FormatCaps::linear_filter);
    for (const bool volume : {false, true}) {
        const Picture picture({8, 8, volume ? 8u : 1u}, 3);
        const TextureDesc desc{.name = "picture",
                               .dimension = volume ? d3 : d2,
                               .format = format,
                               .extent = picture.extent,
                               .mips = 3};
        Texture made = texture(desc);
        for (uint32_t mip = 0; mip < 3; ++mip)
            must(device().upload(made, whole_mip(desc, mip), bytes_of(picture.mips[mip])));
        const auto points = scattered(volume);

        std::vector<SamplerDesc> samplers;
        const auto filter = [&](bool on) { return on && linear ? FilterMode::linear : FilterMode::nearest; };
        for (AddressMode mode : {AddressMode::repeat, AddressMode::mirrored_repeat,
                                 AddressMode::clamp_to_edge, AddressMode::clamp_to_border})
            for (bool smooth : {false, true})
                samplers.push_back(
                    {.magnification = filter(smooth),
                     .minification = filter(!smooth),
                     .mip = filter(smooth),
                     .address_u = mode,
                     .address_v = AddressMode::clamp_to_edge,
                     .address_w = smooth ? mode : AddressMode::repeat,
                     .border = smooth ? BorderColor::opaque_white : BorderColor::opaque_black});
        samplers.push_back(
            {.mip = filter(true), .address_v = AddressMode::repeat, .min_lod = 0.75f, .max_lod = 1.25f});
        if (!linear) samplers.back().magnification = samplers.back().minification = FilterMode::nearest;

        for (const SamplerDesc& with : samplers) {
            for (float lod : {-1.0f, 0.0f, 0.3f, 0.8f, 1.0f, 1.9f, 7.0f}) {
                const std::vector<float> read = volume
                                                    ? sample<sample_d3>(made.view<d3>(), with, points, lod)
                                                    : sample<sample_d2>(made.view<d2>(), with, points, lod);
                for (size_t i = 0; i < points.size(); ++i)
                    // Weights may have as little as 8 bits.
                    ASSERT_NEAR(read[i], expected(picture, with, points[i], lod), 1.5 / 256)
                        << (volume ? "3D" : "2D") << ", u mode " << int(with.address_u) << ", lod " << lod
                        << ", at " << points[i].x << " " << points[i].y << " " << points[i].z;
            }
        }
    }
}

TEST_P(SamplerTest, LinearFiltersCrossTheEdgesOfCubes) {
    const TextureDesc desc{
        .name = "cube", .dimension = cube, .format = Format::rgba16_float, .extent = {4, 4, 1}, .layers = 6};
    Texture made = texture(desc);
    Commands commands = device().begin();
    {
        Pass pass = commands.pass("faces");
        for (uint32_t face = 0; face < 6; ++face)
            pass.clear(made.view<d2>({.first_layer = face, .layers = 1}),
                       std::array<float, 4>{face == 0 ? 1.0f : 0.0f, 0, 0, 0});
    }
    device().submit(std::move(commands));
    // On the edge between +x and +z, half of each; one step inside, only +x.
    const auto read = sample<sample_cube>(made.view<cube>(), {}, {{1, 0.1f, 0.9999f, 0}, {1, 0.1f, 0, 0}}, 0);
    EXPECT_NEAR(read[0], 0.5, 0.02);
    EXPECT_EQ(read[1], 1);
}

TEST_P(SamplerTest, AnisotropyIsAccepted) {
    Texture made = texture({.name = "picture", .format = Format::r16_float, .extent = {8, 8, 1}});
    must(device().upload(made, whole_mip(made.desc()), std::vector<std::byte>(128)));
    const auto read = sample<sample_d2>(made.view<d2>(), {.mip = FilterMode::linear, .max_anisotropy = 16},
                                        {{0.5f, 0.5f, 0, 0}}, 0);
    EXPECT_EQ(read[0], 0);
}

}  // namespace
}  // namespace lumo::rhi
