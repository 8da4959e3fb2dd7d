// Compiled programs as bytes, and compile_program through the disk cache.
#include <bit>
#include <cstring>
#include <fstream>
#include <glslang/Public/ShaderLang.h>
#include <iterator>
#include <spirv-tools/libspirv.h>
#include <type_traits>

#include "shadercompiler/compile.hpp"
#include "shadercompiler/program_code.hpp"

namespace lumo::shadercompiler {
namespace {

namespace fs = std::filesystem;
using rhi::CacheKey;
using rhi::KeyBuilder;

/// To be raised with every change to what the compiler makes of a source, or to the bytes below.
constexpr uint64_t revision = 1;

class Writer {
  public:
    template <class T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
    void put(T value) {
        const auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }

    template <class T>
    void put_array(std::span<const T> values) {
        put(uint64_t(values.size()));
        const auto bytes = std::as_bytes(values);
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }

    void put_text(std::string_view text) { put_array(std::span<const char>(text)); }

    std::vector<std::byte> take() { return std::move(bytes_); }

  private:
    std::vector<std::byte> bytes_;
};

/// Reads what a Writer wrote. Past the end everything is zero and empty, and ok() is false.
class Reader {
  public:
    explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    bool ok() const { return ok_; }
    bool at_end() const { return ok_ && bytes_.empty(); }

    template <class T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
    void get(T& value) {
        value = {};
        if (!need(sizeof(T))) return;
        std::memcpy(&value, bytes_.data(), sizeof(T));
        bytes_ = bytes_.subspan(sizeof(T));
    }

    template <class Container>
    void get_array(Container& values) {
        using T = typename Container::value_type;
        const uint64_t size = count();
        if (!ok_ || size > bytes_.size() / sizeof(T)) {
            ok_ = false;
            return;
        }
        values.resize(size);
        if (size > 0) std::memcpy(values.data(), bytes_.data(), size * sizeof(T));
        bytes_ = bytes_.subspan(size * sizeof(T));
    }

    /// For loops: more elements than there are bytes is a fault.
    uint64_t count() {
        uint64_t size = 0;
        get(size);
        if (size > bytes_.size()) ok_ = false;
        return ok_ ? size : 0;
    }

  private:
    bool need(size_t size) { return ok_ = ok_ && size <= bytes_.size(); }

    std::span<const std::byte> bytes_;
    bool ok_ = true;
};

// One list of fields for both directions, so that they cannot differ.
template <class Archive, class Info>
void binding_fields(Archive&& field, Info& b) {
    field(b.binding), field(b.kind), field(b.dimension), field(b.texel), field(b.format), field(b.access);
    field(b.stages), field(b.gl_slot), field(b.min_size);
}

template <class Archive, class Info>
void option_fields(Archive&& field, Info& o) {
    field(o.id), field(o.type), field(o.default_bits);
}

template <class Archive, class Info>
void program_fields(Archive&& field, Info& p) {
    field(p.push_size), field(p.color_outputs);
    field(p.local_size[0]), field(p.local_size[1]), field(p.local_size[2]);
}

CacheKey hash_of(std::string_view text) { return KeyBuilder().add(text).key(); }

/// Nothing if an included file is not what it was.
std::shared_ptr<const CompiledProgram::Code> code_in(std::span<const std::byte> entry) {
    Reader reader(entry);
    for (uint64_t n = reader.count(); n > 0; --n) {
        std::string path;
        CacheKey hash;
        reader.get_array(path);
        reader.get(hash.high);
        reader.get(hash.low);
        if (!reader.ok()) return nullptr;
        std::ifstream file(path, std::ios::binary);
        const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
        if (!file.is_open() || hash_of(text) != hash) return nullptr;
    }
    std::vector<std::byte> bytes;
    reader.get_array(bytes);
    return reader.at_end() ? from_bytes(bytes) : nullptr;
}

}  // namespace

void CompiledProgram::Code::complete() {
    KeyBuilder hash;
    stage_infos.clear();
    for (const StageCode& stage : stages) {
        stage_infos.push_back({stage.stage, stage.spirv, stage.glsl});
        hash.add(uint64_t(stage.stage)).add(std::as_bytes(std::span(stage.spirv))).add(stage.glsl);
    }
    for (size_t i = 0; i < bindings.size(); ++i) bindings[i].name = binding_names[i];
    for (size_t i = 0; i < options.size(); ++i) options[i].name = option_names[i];
    info.name = name;
    info.stages = stage_infos;
    info.bindings = bindings;
    info.options = options;
    info.hash = hash.key().low;
}

std::vector<std::byte> to_bytes(const CompiledProgram::Code& code) {
    Writer writer;
    const auto put = [&](auto value) { writer.put(value); };
    writer.put_text(code.name);
    program_fields(put, code.info);
    writer.put(uint64_t(code.stages.size()));
    for (const StageCode& stage : code.stages) {
        writer.put(stage.stage);
        writer.put_array(std::span<const uint32_t>(stage.spirv));
        writer.put_text(stage.glsl);
    }
    writer.put(uint64_t(code.bindings.size()));
    for (size_t i = 0; i < code.bindings.size(); ++i) {
        writer.put_text(code.binding_names[i]);
        binding_fields(put, code.bindings[i]);
    }
    writer.put(uint64_t(code.options.size()));
    for (size_t i = 0; i < code.options.size(); ++i) {
        writer.put_text(code.option_names[i]);
        option_fields(put, code.options[i]);
    }
    return writer.take();
}

std::shared_ptr<const CompiledProgram::Code> from_bytes(std::span<const std::byte> bytes) {
    Reader reader(bytes);
    const auto get = [&](auto& value) { reader.get(value); };
    auto code = std::make_shared<CompiledProgram::Code>();
    reader.get_array(code->name);
    program_fields(get, code->info);
    for (uint64_t n = reader.count(); n > 0 && reader.ok(); --n) {
        StageCode& stage = code->stages.emplace_back();
        reader.get(stage.stage);
        reader.get_array(stage.spirv);
        reader.get_array(stage.glsl);
    }
    for (uint64_t n = reader.count(); n > 0 && reader.ok(); --n) {
        reader.get_array(code->binding_names.emplace_back());
        binding_fields(get, code->bindings.emplace_back());
    }
    for (uint64_t n = reader.count(); n > 0 && reader.ok(); --n) {
        reader.get_array(code->option_names.emplace_back());
        option_fields(get, code->options.emplace_back());
    }
    if (!reader.at_end()) return nullptr;
    code->complete();
    return code;
}

CacheKey cache_key(const ProgramSource& source, const CompileOptions& options) {
    KeyBuilder key;
    key.add(revision)
        .add(std::string_view(glslang::GetGlslVersionString()))
        .add(spvSoftwareVersionDetailsString());
    key.add(source.name).add(uint64_t(source.stages.size()));
    for (const StageSource& stage : source.stages) key.add(uint64_t(stage.stage)).add(stage.text);
    key.add(uint64_t(options.include_roots.size()));
    for (const fs::path& root : options.include_roots) key.add(root.native());
    key.add(uint64_t(options.defines.size()));
    for (const auto& [name, value] : options.defines) key.add(name).add(value);
    return key.add(uint64_t(options.optimise)).key();
}

std::vector<std::byte> cache_entry(const Compilation& compilation) {
    Writer writer;
    writer.put(uint64_t(compilation.includes.size()));
    for (const IncludedFile& include : compilation.includes) {
        const CacheKey hash = hash_of(include.text);
        writer.put_text(include.path.native());
        writer.put(hash.high);
        writer.put(hash.low);
    }
    const std::vector<std::byte> bytes = to_bytes(compilation.program.code());
    writer.put_array(std::span<const std::byte>(bytes));
    return writer.take();
}

Result<CompiledProgram> compile_program(const ProgramSource& source, const CompileOptions& options,
                                        const rhi::DiskCache& cache) {
    const CacheKey key = cache_key(source, options);
    if (const auto entry = cache.get(key)) {
        if (auto code = code_in(*entry)) return CompiledProgram(std::move(code));
    }
    Result<Compilation> compilation = compile_program(source, options);
    if (!compilation) return tl::unexpected(compilation.error());
    (void)cache.put(key, cache_entry(*compilation));
    return std::move(compilation->program);
}

}  // namespace lumo::shadercompiler
