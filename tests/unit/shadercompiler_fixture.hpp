// What the tests of the shader compiler share.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

#include "shadercompiler/compile.hpp"

namespace lumo::shadercompiler {

/// A folder that goes away with this object.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string path = (std::filesystem::temp_directory_path() / "lumo-test-XXXXXX").string();
        path_ = ::mkdtemp(path.data());
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }

    const std::filesystem::path& path() const { return path_; }

    std::filesystem::path write(const std::string& name, const std::string& text) const {
        const std::filesystem::path file = path_ / name;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file, std::ios::binary) << text;
        return file;
    }

  private:
    std::filesystem::path path_;
};

inline const std::filesystem::path data_root = LUMO_SOURCE_DIR "/tests/unit/data";

/// A program of one compute shader whose main() has the body.
inline ProgramSource compute(const std::string& declarations, const std::string& body) {
    return {
        .name = "test/one",
        .stages = {{rhi::Stages::compute, "one.comp",
                    "layout(local_size_x = 1) in;\n" + declarations + "\nvoid main() {\n" + body + "\n}\n"}}};
}

inline Result<Compilation> compile_data(const std::string& name, CompileOptions options = {}) {
    options.include_roots = {data_root};
    const Result<ProgramSource> source = find_program(data_root, name);
    if (!source) return tl::unexpected(source.error());
    return compile_program(*source, options);
}

}  // namespace lumo::shadercompiler
