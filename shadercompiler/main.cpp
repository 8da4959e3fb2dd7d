// lumo_shaderc: one shader program from its stage files to a C++ header and source.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "shadercompiler/compile.hpp"
#include "shadercompiler/generate.hpp"

namespace {

namespace fs = std::filesystem;
using namespace lumo;

/// Leaves a file that already holds the text as it is, so that what depends on it is not built again.
Result<void> write_text(const fs::path& path, const std::string& text) {
    {
        std::ifstream old(path, std::ios::binary);
        const std::string held{std::istreambuf_iterator<char>(old), std::istreambuf_iterator<char>()};
        if (old.is_open() && held == text) return {};
    }
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file << text;
    file.close();
    if (!file) return fail(ErrorKind::io, path.string(), "cannot be written");
    return {};
}

std::string depfile_text(const fs::path& target, const std::vector<fs::path>& dependencies) {
    const auto escaped = [](const fs::path& path) {
        std::string text;
        for (const char c : fs::absolute(path).string()) {
            if (c == ' ' || c == '#') text += '\\';
            if (c == '$') text += '$';
            text += c;
        }
        return text;
    };
    std::string text = escaped(target) + ":";
    for (const fs::path& path : dependencies) text += " \\\n  " + escaped(path);
    return text + "\n";
}

struct Arguments {
    fs::path root;
    fs::path output;
    fs::path depfile;
    std::vector<fs::path> files;
    std::vector<std::string> defines;
    shadercompiler::CompileOptions options;
};

Result<void> run(const Arguments& arguments) {
    using namespace lumo::shadercompiler;
    Result<ProgramSource> source = read_program(arguments.root, arguments.files);
    if (!source) return tl::unexpected(source.error());
    Result<Compilation> compilation = compile_program(*source, arguments.options);
    if (!compilation) return tl::unexpected(compilation.error());
    Result<Generated> generated = generate_cpp(*compilation);
    if (!generated) return tl::unexpected(generated.error());

    const fs::path base = arguments.output / "shaders" / source->name;
    const fs::path cpp = base.string() + ".cpp";
    if (Result<void> written = write_text(base.string() + ".hpp", generated->header); !written)
        return written;
    if (Result<void> written = write_text(cpp, generated->source); !written) return written;
    if (arguments.depfile.empty()) return {};
    std::vector<fs::path> dependencies = arguments.files;
    for (const IncludedFile& include : compilation->includes) dependencies.push_back(include.path);
    return write_text(arguments.depfile, depfile_text(cpp, dependencies));
}

}  // namespace

int main(int argc, char** argv) {
    Arguments arguments;
    bool plain = false;
    CLI::App app(
        "Compiles the stage files of one shader program (FOLDER/STEM.comp, or FOLDER/STEM.vert with .geom or "
        ".frag "
        "or both) and writes DIR/shaders/FOLDER/STEM.hpp and .cpp.");
    app.add_option("files", arguments.files, "stage files: .vert, .geom, .frag, .comp")->required();
    app.add_option("-o,--output", arguments.output, "folder to write to")->required();
    app.add_option("--root", arguments.root, "folder that FOLDER is in; includes are searched here first")
        ->required();
    app.add_option("-I,--include", arguments.options.include_roots, "further folder to search for includes");
    app.add_option("-D,--define", arguments.defines, "macro, as NAME or NAME=VALUE");
    app.add_option("--depfile", arguments.depfile,
                   "file for the names of all that was read, as make reads it");
    app.add_flag("--plain", plain, "leave the code as it was written, for debugging");
    CLI11_PARSE(app, argc, argv);

    arguments.options.optimise = !plain;
    arguments.options.include_roots.insert(arguments.options.include_roots.begin(), arguments.root);
    for (const std::string& define : arguments.defines) {
        const size_t equals = define.find('=');
        arguments.options.defines.emplace_back(define.substr(0, equals),
                                               equals == std::string::npos ? "" : define.substr(equals + 1));
    }
    if (const Result<void> done = run(arguments); !done) {
        fmt::print(stderr, "{}\n", to_string(done.error()));
        return 1;
    }
    return 0;
}
