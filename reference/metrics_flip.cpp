// ꟻLIP, written from the formulas of Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating
// Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2). Section numbers are that paper's.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <glm/glm.hpp>
#include <numbers>

#include "reference/metrics.hpp"

namespace lumo::reference {
namespace {

using scene::ImageF;
using std::numbers::pi;

/// Four filtered quantities at each pixel.
struct Planes {
    int width = 0;
    int height = 0;
    std::vector<glm::vec4> values;
};

/// The taps of four one-dimensional filters from -radius to radius.
using Kernel = std::vector<glm::vec4>;

/// Rec. 709 primaries with white D65, from linear RGB to XYZ (columns are the primaries).
const glm::mat3 xyz_from_rgb{
    {0.412391f, 0.212639f, 0.019331f}, {0.357584f, 0.715169f, 0.119195f}, {0.180481f, 0.072192f, 0.950532f}};
const glm::mat3 rgb_from_xyz = glm::inverse(xyz_from_rgb);
const glm::vec3 white = xyz_from_rgb * glm::vec3(1);

/// The linear opponent space of section 4.1.
glm::vec3 ycxcz_from_rgb(glm::vec3 rgb) {
    const glm::vec3 n = xyz_from_rgb * rgb / white;
    return {116 * n.y - 16, 500 * (n.x - n.y), 200 * (n.y - n.z)};
}

glm::vec3 rgb_from_ycxcz(glm::vec3 c) {
    const float y = (c.x + 16) / 116;
    return rgb_from_xyz * (white * glm::vec3(y + c.y / 500, y, y - c.z / 200));
}

/// CIE 1976 L*a*b* whose chroma is scaled by 0.01 L*, for the Hunt effect (section 4.1).
glm::vec3 hunt_lab_from_rgb(glm::vec3 rgb) {
    constexpr float delta = 6.0f / 29;
    const auto compress = [](float t) {
        return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0f / 29;
    };
    const glm::vec3 n = xyz_from_rgb * rgb / white;
    const glm::vec3 f{compress(n.x), compress(n.y), compress(n.z)};
    const float lightness = 116 * f.y - 16;
    return {lightness, 0.01f * lightness * 500 * (f.x - f.y), 0.01f * lightness * 200 * (f.y - f.z)};
}

/// The distance of Abasi et al. 2020, to the power 0.7 of section 4.1.
float color_distance(glm::vec3 lab_a, glm::vec3 lab_b) {
    const glm::vec3 d = lab_a - lab_b;
    return std::pow(std::abs(d.x) + std::hypot(d.y, d.z), 0.7f);
}

/// Filters rows, then columns. Pixels beyond the border repeat it.
Planes convolved(const Planes& image, const Kernel& along_x, const Kernel& along_y) {
    const int radius = int(along_x.size() / 2);
    const auto pass = [&](const Planes& in, const Kernel& kernel, int step_x, int step_y) {
        Planes out{in.width, in.height, std::vector<glm::vec4>(in.values.size(), glm::vec4(0))};
        for (int y = 0; y < in.height; ++y) {
            for (int x = 0; x < in.width; ++x) {
                glm::vec4& sum = out.values[size_t(y) * in.width + x];
                for (size_t tap = 0; tap < kernel.size(); ++tap) {
                    const int offset = int(tap) - radius;
                    const int from_x = std::clamp(x + offset * step_x, 0, in.width - 1);
                    const int from_y = std::clamp(y + offset * step_y, 0, in.height - 1);
                    sum += kernel[tap] * in.values[size_t(from_y) * in.width + from_x];
                }
            }
        }
        return out;
    };
    return pass(pass(image, along_x, 1, 0), along_y, 0, 1);
}

/// The contrast sensitivity filters of section 4.1, table 1: a Gaussian each for Y and Cx, two for Cz.
struct Sensitivity {
    Kernel kernel;     ///< Y, Cx, Cz's first, Cz's second, each of sum 1
    float second = 0;  ///< weight of Cz's second
};

Sensitivity sensitivity(double pixels_per_degree) {
    const glm::dvec4 b{0.0047, 0.0053, 0.04, 0.025};
    const int radius = int(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * pixels_per_degree));
    std::vector<glm::dvec4> taps;
    glm::dvec4 sum{0};
    for (int i = -radius; i <= radius; ++i) {
        const double degrees = i / pixels_per_degree;
        taps.push_back(glm::exp(-pi * pi * degrees * degrees / b));
        sum += taps.back();
    }
    Sensitivity result;
    for (const glm::dvec4& tap : taps) result.kernel.emplace_back(tap / sum);
    const double first = 34.1 * std::sqrt(pi / b.z) * sum.z * sum.z;
    const double second = 13.5 * std::sqrt(pi / b.w) * sum.w * sum.w;
    result.second = float(second / (first + second));
    return result;
}

/// The detectors of section 4.2, as wide as 0.082 degrees: first and second derivative of a Gaussian, whose
/// positive and whose negative taps each sum to 1 in magnitude. With the Gaussian across they make the
/// planes: edge along x, edge along y, point along x, point along y.
struct Detectors {
    Kernel along_x;
    Kernel along_y;
};

Detectors detectors(double pixels_per_degree) {
    const double deviation = 0.5 * 0.082 * pixels_per_degree;
    const int radius = int(std::ceil(3 * deviation));
    std::vector<glm::dvec3> taps;  // Gaussian, edge, point
    glm::dvec3 positive{0};
    glm::dvec3 negative{0};
    for (int i = -radius; i <= radius; ++i) {
        const double s = i / deviation;
        const double g = std::exp(-0.5 * s * s);
        taps.emplace_back(g, -s * g, (s * s - 1) * g);
        positive += glm::max(taps.back(), 0.0);
        negative -= glm::min(taps.back(), 0.0);
    }
    negative.x = 1;  // a Gaussian has no negative tap
    Detectors result;
    for (const glm::dvec3& tap : taps) {
        const glm::vec3 t = glm::max(tap, 0.0) / positive + glm::min(tap, 0.0) / negative;
        result.along_x.emplace_back(t.y, t.x, t.z, t.x);
        result.along_y.emplace_back(t.x, t.y, t.x, t.z);
    }
    return result;
}

/// A picture as ꟻLIP sees it.
struct Percept {
    std::vector<glm::vec3> color;     ///< filtered, Hunt-adjusted L*a*b*
    std::vector<glm::vec2> features;  ///< strength of edge and of point
};

Percept percept(const ImageF& image, const Sensitivity& csf, const Detectors& detect) {
    const auto width = int(image.width);
    const auto height = int(image.height);
    const size_t pixels = size_t(width) * size_t(height);
    Planes opponents{width, height, {}};
    Planes lightness{width, height, {}};
    opponents.values.reserve(pixels);
    lightness.values.reserve(pixels);
    for (size_t i = 0; i < pixels; ++i) {
        const float* p = image.values.data() + i * image.channels;
        const glm::vec3 c = ycxcz_from_rgb(glm::clamp(glm::vec3(p[0], p[1], p[2]), 0.0f, 1.0f));
        opponents.values.emplace_back(c, c.z);
        lightness.values.emplace_back((c.x + 16) / 116);
    }

    Percept result;
    result.color.reserve(pixels);
    result.features.reserve(pixels);
    for (const glm::vec4& c : convolved(opponents, csf.kernel, csf.kernel).values) {
        const glm::vec3 rgb = rgb_from_ycxcz({c.x, c.y, glm::mix(c.z, c.w, csf.second)});
        result.color.push_back(hunt_lab_from_rgb(glm::clamp(rgb, 0.0f, 1.0f)));
    }
    for (const glm::vec4& d : convolved(lightness, detect.along_x, detect.along_y).values) {
        result.features.emplace_back(std::hypot(d.x, d.y), std::hypot(d.z, d.w));
    }
    return result;
}

/// Section 4.1's redistribution: the small differences, up to 0.4 of the greatest, take up 0.95 of the range.
float redistributed(float distance, float greatest) {
    constexpr float knee = 0.4f;
    constexpr float knee_value = 0.95f;
    const float t = distance / greatest;
    return t < knee ? t * knee_value / knee : knee_value + (t - knee) / (1 - knee) * (1 - knee_value);
}

}  // namespace

Result<ImageF> flip(const ImageF& reference, const ImageF& test, double pixels_per_degree) {
    const size_t values = size_t(reference.width) * reference.height * reference.channels;
    if (reference.width != test.width || reference.height != test.height ||
        reference.channels != test.channels || reference.channels < 3 || values == 0 ||
        reference.values.size() != values || test.values.size() != values) {
        return fail(ErrorKind::invalid_argument, "pictures",
                    fmt::format("{}x{} with {} channels against {}x{} with {}", reference.width,
                                reference.height, reference.channels, test.width, test.height, test.channels),
                    "ꟻLIP compares RGB pictures of one size");
    }
    // Below 1 the filters are narrower than a pixel; above 1000 they are wider than any picture is worth.
    if (!(pixels_per_degree >= 1 && pixels_per_degree <= 1000)) {
        return fail(ErrorKind::invalid_argument, "pixels per degree", fmt::format("{}", pixels_per_degree),
                    "1 to 1000");
    }
    const Sensitivity csf = sensitivity(pixels_per_degree);
    const Detectors detect = detectors(pixels_per_degree);
    const Percept a = percept(reference, csf, detect);
    const Percept b = percept(test, csf, detect);
    const float greatest = color_distance(hunt_lab_from_rgb({0, 1, 0}), hunt_lab_from_rgb({0, 0, 1}));

    ImageF errors{reference.width, reference.height, 1, std::vector<float>(a.color.size())};
    for (size_t i = 0; i < errors.values.size(); ++i) {
        const float color = redistributed(color_distance(a.color[i], b.color[i]), greatest);
        const glm::vec2 change = glm::abs(a.features[i] - b.features[i]);
        const float feature = std::sqrt(std::max(change.x, change.y) / std::numbers::sqrt2_v<float>);
        errors.values[i] = std::pow(color, 1 - feature);
    }
    return errors;
}

}  // namespace lumo::reference
