#include "samples/lumo/command_line/arguments.hpp"

#include "scene/printable.hpp"

namespace lumo::program {

constexpr size_t help_columns = 76;

std::string wrapped(const std::string& help) {
    std::string text;
    size_t line = 0;
    for (size_t begin = 0; begin < help.size();) {
        const size_t end = std::min(help.find(' ', begin), help.size());
        const size_t word = end - begin;
        if (line > 0 && line + 1 + word > help_columns) {
            text += '\n';
            line = 0;
        }
        if (line > 0) text += ' ';
        text += help.substr(begin, word);
        line += word + 1;
        begin = end + 1;
    }
    return text;
}

CLI::Option* add(CLI::App& app, const std::string& name, const std::string& type, const std::string& help,
                 const ParseArgument& parse) {
    const auto read = [name, parse](const std::string& text) {
        if (const Result<void> done = parse(text); !done)
            throw CLI::ValidationError(name, scene::printable(to_string(done.error()), 1000));
    };
    return app.add_option_function<std::string>(name, read, wrapped(help))->option_text(type);
}

CLI::Option* add(CLI::App& app, const std::string& name, const std::string& type, const std::string& standard,
                 const std::string& help, const ParseArgument& parse) {
    CLI::Option* option = add(app, name, type, help, parse)->default_str(standard);
    if (!standard.empty())
        option->option_text(fmt::format("{}{}({})", type, type.empty() ? "" : " ", standard));
    return option;
}

CLI::Option* add_file(CLI::App& app, const std::string& name, std::filesystem::path& place,
                      const std::string& help) {
    return app.add_option(name, place, wrapped(help))->option_text("FILE");
}

CLI::Option* add_flag(CLI::App& app, const std::string& name, bool& place, const std::string& help) {
    return app.add_flag(name, place, wrapped(help));
}

ParseArgument only(std::string name) { return one_of<int>(nullptr, {{std::move(name), 0}}); }

}  // namespace lumo::program
