#include "shadercompiler/spirv_uses.hpp"

#include <spirv_cross/spirv.hpp>
#include <unordered_set>

namespace lumo::shadercompiler {
namespace {

/// Calls visit(opcode, operands) for each instruction; the operands exclude the first word.
template <class Visitor>
void for_each_instruction(std::span<const uint32_t> spirv, Visitor&& visit) {
    constexpr size_t header_words = 5;
    for (size_t at = header_words; at < spirv.size();) {
        const uint32_t words = spirv[at] >> 16;
        if (words == 0 || at + words > spirv.size()) return;
        visit(spv::Op(spirv[at] & 0xffff), spirv.subspan(at + 1, words - 1));
        at += words;
    }
}

/// For each id that points into a variable, or was loaded from an image variable: the ids it comes from. A
/// function parameter comes from the arguments of all calls.
class Origins {
  public:
    void add(uint32_t id, uint32_t from) { from_[id].push_back(from); }
    void add_variable(uint32_t id) { variables_.insert(id); }

    template <class Visitor>
    void for_each_variable(uint32_t id, Visitor&& visit) const {
        if (variables_.contains(id)) visit(id);
        const auto it = from_.find(id);
        if (it == from_.end()) return;
        for (const uint32_t from : it->second) for_each_variable(from, visit);
    }

  private:
    std::unordered_map<uint32_t, std::vector<uint32_t>> from_;
    std::unordered_set<uint32_t> variables_;
};

Origins find_origins(std::span<const uint32_t> spirv) {
    Origins origins;
    std::unordered_set<uint32_t> image_types;
    std::unordered_map<uint32_t, std::vector<uint32_t>> parameters;  // by function
    uint32_t function = 0;
    for_each_instruction(spirv, [&](spv::Op op, std::span<const uint32_t> operands) {
        switch (op) {
            case spv::OpTypeImage:
                image_types.insert(operands[0]);
                break;
            case spv::OpVariable:
                if (operands[2] != spv::StorageClassFunction) origins.add_variable(operands[1]);
                break;
            case spv::OpFunction:
                function = operands[1];
                break;
            case spv::OpFunctionParameter:
                parameters[function].push_back(operands[1]);
                break;
            case spv::OpAccessChain:
            case spv::OpInBoundsAccessChain:
            case spv::OpPtrAccessChain:
            case spv::OpCopyObject:
            case spv::OpImageTexelPointer:
                origins.add(operands[1], operands[2]);
                break;
            case spv::OpLoad:
                if (image_types.contains(operands[0])) origins.add(operands[1], operands[2]);
                break;
            default:
                break;
        }
    });
    for_each_instruction(spirv, [&](spv::Op op, std::span<const uint32_t> operands) {
        if (op != spv::OpFunctionCall) return;
        const std::vector<uint32_t>& of_callee = parameters[operands[2]];
        for (size_t i = 0; i < of_callee.size() && i + 3 < operands.size(); ++i) {
            origins.add(of_callee[i], operands[i + 3]);
        }
    });
    return origins;
}

}  // namespace

ModuleUses find_uses(std::span<const uint32_t> spirv) {
    const Origins origins = find_origins(spirv);
    ModuleUses uses;
    std::unordered_set<uint32_t> image_types;
    const auto mark = [&](uint32_t pointer, bool Uses::*how) {
        origins.for_each_variable(pointer,
                                  [&](uint32_t variable) { uses.of_variable[variable].*how = true; });
    };
    for_each_instruction(spirv, [&](spv::Op op, std::span<const uint32_t> operands) {
        switch (op) {
            case spv::OpCapability:
                uses.capabilities.push_back(operands[0]);
                break;
            case spv::OpDecorate:
                uses.is_volatile |= operands[1] == spv::DecorationVolatile;
                break;
            case spv::OpMemberDecorate:
                uses.is_volatile |= operands[2] == spv::DecorationVolatile;
                break;
            case spv::OpTypeImage:
                image_types.insert(operands[0]);
                break;
            case spv::OpLoad:  // of an image: names it only; what counts is what is done to the result
                if (!image_types.contains(operands[0])) mark(operands[2], &Uses::plain);
                break;
            case spv::OpImageRead:
                mark(operands[2], &Uses::plain);
                break;
            case spv::OpStore:
            case spv::OpImageWrite:
                mark(operands[0], &Uses::plain);
                break;
            case spv::OpCopyMemory:
                mark(operands[0], &Uses::plain);
                mark(operands[1], &Uses::plain);
                break;
            case spv::OpAtomicLoad:
            case spv::OpAtomicExchange:
            case spv::OpAtomicCompareExchange:
                mark(operands[2], &Uses::plain);
                break;
            case spv::OpAtomicStore:
                mark(operands[0], &Uses::plain);
                break;
            case spv::OpAtomicIIncrement:
            case spv::OpAtomicIDecrement:
            case spv::OpAtomicIAdd:
            case spv::OpAtomicISub:
            case spv::OpAtomicSMin:
            case spv::OpAtomicUMin:
            case spv::OpAtomicSMax:
            case spv::OpAtomicUMax:
            case spv::OpAtomicAnd:
            case spv::OpAtomicOr:
            case spv::OpAtomicXor:
                mark(operands[2], &Uses::atomic);
                break;
            default:
                break;
        }
    });
    return uses;
}

}  // namespace lumo::shadercompiler
