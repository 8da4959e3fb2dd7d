// What the command line's options are made of: adapters between CLI11 and functions from text to values.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rhi/error.hpp"

namespace lumo::program {

/// Turns text into a value and puts it into its place. Errors: invalid_argument.
using ParseArgument = std::function<Result<void>(const std::string&)>;

/// What could have been said instead.
inline std::string available(auto&& names) { return fmt::format("available: {}", fmt::join(names, ", ")); }

/// Help in lines that fit beside the column of names.
std::string wrapped(const std::string& help);

/// An option whose value is text for `parse`.
CLI::Option* add(CLI::App& app, const std::string& name, const std::string& type, const std::string& help,
                 const ParseArgument& parse);

/// The same with a default, which help shows behind the type.
CLI::Option* add(CLI::App& app, const std::string& name, const std::string& type, const std::string& standard,
                 const std::string& help, const ParseArgument& parse);

CLI::Option* add_file(CLI::App& app, const std::string& name, std::filesystem::path& place,
                      const std::string& help);

CLI::Option* add_flag(CLI::App& app, const std::string& name, bool& place, const std::string& help);

/// The column at which help begins.
inline constexpr int name_column = 34;

/// How to turn text into a value and where to put it.
template <class T>
ParseArgument into(T& place, Result<T> (*parse)(std::string_view)) {
    return [&place, parse](const std::string& text) -> Result<void> {
        return parse(text).map([&](T value) { place = std::move(value); });
    };
}

/// The same for a value out of a list of names; `place` is null where one name is all there is.
template <class T>
ParseArgument one_of(T* place, std::vector<std::pair<std::string, T>> names) {
    return [place, names = std::move(names)](const std::string& text) -> Result<void> {
        const auto found = std::ranges::find(names, text, &std::pair<std::string, T>::first);
        if (found == names.end()) {
            std::vector<std::string> known;
            for (const auto& [name, value] : names) known.push_back(name);
            return fail(ErrorKind::invalid_argument, fmt::format("'{}'", text), "there is no such value",
                        available(known));
        }
        if (place) *place = found->second;
        return {};
    };
}

/// One name is all there is.
ParseArgument only(std::string name);

}  // namespace lumo::program
