#include "shadercompiler/block.hpp"

#include <algorithm>
#include <span>

namespace lumo::shadercompiler {
namespace {

/// OpenGL 4.5 core, 7.6.2.2: the rules of std140.
struct Std140 {
    const Block& block;

    static uint32_t round_up(uint32_t value, uint32_t alignment) {
        return (value + alignment - 1) / alignment * alignment;
    }

    static uint32_t vector_alignment(uint32_t components) {
        return components == 1 ? 4 : components == 2 ? 8 : 16;
    }

    uint32_t struct_size(const BlockStruct& s) const {
        uint32_t end = 0;
        for (const BlockMember& m : s.members) end = round_up(end, alignment(m)) + size(m);
        return round_up(end, 16);
    }

    uint32_t element_size(const BlockMember& m) const {
        if (m.structure >= 0) return struct_size(block.structs[size_t(m.structure)]);
        if (m.columns > 1) return 16 * (m.row_major ? m.rows : m.columns);
        return m.array.empty() ? 4 * m.rows : 16;
    }

    uint32_t size(const BlockMember& m) const {
        uint32_t bytes = element_size(m);
        for (const uint32_t extent : m.array) bytes *= extent;
        return bytes;
    }

    uint32_t alignment(const BlockMember& m) const {
        const bool plain = m.structure < 0 && m.columns == 1 && m.array.empty();
        return plain ? vector_alignment(m.rows) : 16;
    }

    std::string first_off(std::span<const BlockMember> members) const {
        uint32_t end = 0;
        for (const BlockMember& m : members) {
            const uint32_t offset = round_up(end, alignment(m));
            const bool strides_agree = (m.array.empty() || m.array_stride == element_size(m)) &&
                                       (m.columns == 1 || m.matrix_stride == 16);
            if (m.offset != offset || !strides_agree) return m.name;
            end = offset + size(m);
        }
        return {};
    }
};

}  // namespace

std::string first_member_off_std140(const Block& block) {
    const Std140 rules{block};
    for (const BlockStruct& s : block.structs) {
        if (const std::string name = rules.first_off(s.members); !name.empty()) return s.name + "." + name;
    }
    return rules.first_off(block.members);
}

}  // namespace lumo::shadercompiler
