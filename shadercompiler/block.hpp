// The layout of uniform and push blocks, as far as C++ has to know it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lumo::shadercompiler {

enum class ScalarType : uint8_t { sint, uint, floating };  ///< of 32 bits

struct BlockMember {
    std::string name;
    uint32_t offset = 0;  ///< bytes from the start of the struct
    ScalarType scalar = ScalarType::floating;
    uint32_t rows = 1;     ///< components of a vector, or of a matrix's column
    uint32_t columns = 1;  ///< above 1 for a matrix
    bool row_major = false;
    uint32_t matrix_stride = 0;   ///< bytes between columns
    std::vector<uint32_t> array;  ///< extents, outermost first; empty for no array
    uint32_t array_stride = 0;    ///< bytes between elements of the innermost extent
    int structure = -1;           ///< index into Block::structs in place of scalar, rows and columns

    bool operator==(const BlockMember&) const = default;
};

struct BlockStruct {
    std::string name;
    std::vector<BlockMember> members;

    bool operator==(const BlockStruct&) const = default;
};

/// A block: its own members, and the structs that they use, each after those that it uses itself.
struct Block {
    std::string name;
    std::vector<BlockMember> members;
    std::vector<BlockStruct> structs;
    uint32_t size = 0;  ///< bytes, a multiple of 16 for a uniform block

    bool operator==(const Block&) const = default;
};

/// The first member, as "name", that std140 would lay out elsewhere; empty if there is none.
std::string first_member_off_std140(const Block& block);

}  // namespace lumo::shadercompiler
