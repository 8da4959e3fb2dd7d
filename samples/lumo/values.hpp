// Values of options, from text.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "rhi/error.hpp"
#include "samples/lumo/options.hpp"

namespace lumo::program {

/// The parts between separators: one more than there are of these, some perhaps empty.
std::vector<std::string_view> split(std::string_view text, char separator);

// Errors: invalid_argument with the text as subject and what was expected as message.

Result<double> parse_number(std::string_view text);    ///< finite
Result<double> parse_positive(std::string_view text);  ///< above 0
Result<double> parse_ratio(std::string_view text);     ///< above 0; 25% is 0.25
Result<uint32_t> parse_integer(std::string_view text, uint32_t lowest, uint32_t highest);
Result<rhi::Extent> parse_size(std::string_view text);     ///< WxH
Result<uint32_t> parse_voxels(std::string_view text);      ///< a power of two, 16 to 1024
Result<CameraChoice> parse_camera(std::string_view text);  ///< px,py,pz:tx,ty,tz:FOV, else a name
Result<Sun> parse_sun(std::string_view text);              ///< dx,dy,dz:r,g,b or none
Result<std::vector<frame::Layer>> parse_layers(std::string_view text);  ///< by commas, each once
Result<float> parse_exposure(std::string_view text);                    ///< stops, -64 to 64

Result<double> parse_altitude(std::string_view text);  ///< km, 0 to 1e6
Result<float> parse_distance(std::string_view text);   ///< metres, 1e-6 to 1e9

Result<uint32_t> parse_orders(std::string_view text);  ///< of scattering: 1 to 1000, or all
Result<double> parse_part(std::string_view text);      ///< of a whole, 0 to 1

struct Shard {
    uint32_t index = 1;  ///< from 1
    uint32_t count = 1;
};
Result<Shard> parse_shard(std::string_view text);  ///< I/N

}  // namespace lumo::program
