// From GLSL to everything that lumo needs of a program: SPIR-V for Vulkan, GLSL 450 for OpenGL, reflection.
//
// The rules that sources keep (each is an error that names the rule):
//   - A prelude is added: #version 450, #include "path from an include root" (a file is included once,
//   however
//     often it is named), and the macro LUMO_READ_WRITE.
//   - Every binding is explicit, in set 0, below rhi::max_bindings; combined samplers only; no arrays of
//   samplers,
//     images or blocks. At most rhi::max_gl_images storage images a program.
//   - A storage image or buffer is `readonly`, `writeonly`, used by commutative atomics alone, or declared
//     LUMO_READ_WRITE. The macro stands for `restrict`, which nothing else in a source may use.
//   - Storage images have a format, except where `writeonly`. `volatile` is refused: the OpenGL text would
//   lose it.
//   - One push_constant block a program, laid out alike under std140 and std430, of at most
//   rhi::max_push_size.
//   - Uniform blocks are std140. Blocks and bindings have one name throughout a program.
//   - Vertices are pulled from buffers: no vertex attributes. gl_InstanceIndex starts at 0. Only what both
//   APIs have.
//   - Group sizes are literal numbers.
//
// A binding that a source declares is in the program's bindings even where nothing uses it, so that what C++ must
// supply follows from what one reads in the source; the optimised code may lack it.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rhi/disk_cache.hpp"
#include "rhi/error.hpp"
#include "rhi/program.hpp"
#include "shadercompiler/block.hpp"

namespace lumo::shadercompiler {

/// The text of one stage. Messages call it `path`.
struct StageSource {
    rhi::Stages stage;
    std::filesystem::path path;
    std::string text;
};

struct ProgramSource {
    std::string name;  ///< FOLDER/STEM
    std::vector<StageSource> stages;
};

struct CompileOptions {
    std::vector<std::filesystem::path> include_roots{};          ///< searched in this order
    std::vector<std::pair<std::string, std::string>> defines{};  ///< name and value
    bool optimise = true;  ///< false keeps the code close to the source; functions are inlined all the same,
                           ///< because Mesa's GLSL refuses image atomics through parameters
};

/// A compiled program. Copies share their code.
class CompiledProgram {
  public:
    /// Valid as long as a copy of this object lives.
    const rhi::ProgramInfo& info() const;

    /// What it is made of: the strings and arrays that info() looks at.
    struct Code;
    explicit CompiledProgram(std::shared_ptr<const Code> code) : code_(std::move(code)) {}
    const Code& code() const { return *code_; }

  private:
    std::shared_ptr<const Code> code_;
};

/// A file that a source includes, as it was when it was read.
struct IncludedFile {
    std::filesystem::path path;
    std::string text;
};

struct Compilation {
    CompiledProgram program;
    std::vector<Block> uniform_blocks;   ///< one per uniform buffer, in order of binding
    Block push;                          ///< without members where the program has no push block
    std::vector<IncludedFile> includes;  ///< in the order in which they were first read
};

/// Reads the stage files of one program. Its name is their path below `root` without the extension, which
/// says the stage: .vert, .geom, .frag, .comp. Errors: io; invalid_argument for files that do not make one
/// program.
Result<ProgramSource> read_program(const std::filesystem::path& root,
                                   const std::vector<std::filesystem::path>& files);

/// Finds and reads the stage files of the program `name` (FOLDER/STEM) below `root`.
Result<ProgramSource> find_program(const std::filesystem::path& root, const std::string& name);

/// Compiles. Errors are of kind shader; their message has one line per fault, "path:line: error: what", with
/// path and line of the GLSL that was written, in included files too.
Result<Compilation> compile_program(const ProgramSource& source, const CompileOptions& options);

/// As compile_program, but takes the result from `cache` if neither the sources, nor what they include, nor
/// the options, nor the compiler changed since it was put there. A cache that cannot be written is no error.
Result<CompiledProgram> compile_program(const ProgramSource& source, const CompileOptions& options,
                                        const rhi::DiskCache& cache);

}  // namespace lumo::shadercompiler
