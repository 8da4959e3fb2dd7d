#include "samples/lumo/table.hpp"

#include <algorithm>
#include <csv.h>
#include <fmt/format.h>
#include <memory>
#include <set>
#include <span>

#include "scene/file.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

constexpr uint64_t largest_file = uint64_t(256) << 20;  // bytes
constexpr size_t most_rows = 1'000'000;

struct Reading {
    std::vector<Table::Row> rows;
    Table::Row row;

    static void take_field(void* text, size_t size, void* reading) {
        static_cast<Reading*>(reading)->row.cells.emplace_back(static_cast<const char*>(text), size);
    }
    static void end_row(int, void* reading) {
        auto& self = *static_cast<Reading*>(reading);
        self.rows.push_back(std::exchange(self.row, {.line = self.row.line, .cells = {}}));
    }
};

/// Line by line, for the parser does not count them.
Result<std::vector<Table::Row>> parse_rows(std::string_view text, const std::string& name) {
    csv_parser parser;
    if (csv_init(&parser, CSV_STRICT | CSV_STRICT_FINI) != 0)
        return fail(ErrorKind::invalid_file, name, "cannot be parsed", "check that there is memory");
    const std::unique_ptr<csv_parser, decltype(&csv_free)> owner(&parser, csv_free);

    Reading reading;
    while (!text.empty() && reading.rows.size() <= most_rows) {
        ++reading.row.line;
        const size_t size = std::min(text.find('\n'), text.size() - 1) + 1;
        if (csv_parse(&parser, text.data(), size, Reading::take_field, Reading::end_row, &reading) != size)
            break;
        text.remove_prefix(size);
    }
    if (!text.empty() && reading.rows.size() > most_rows)
        return fail(ErrorKind::limit, name, fmt::format("has more than {} rows", most_rows), "split it");
    if (!text.empty() || csv_fini(&parser, Reading::take_field, Reading::end_row, &reading) != 0)
        return fail(ErrorKind::invalid_file, fmt::format("{}, line {}", name, reading.row.line),
                    "a quote is out of place or is not closed",
                    "quote the whole field, and double the quotes in it");
    return std::move(reading.rows);
}

std::string field(const std::string& text) {
    const bool plain = text.find_first_of(",\"\r\n") == std::string::npos && !text.starts_with(' ') &&
                       !text.starts_with('\t') && !text.ends_with(' ') && !text.ends_with('\t');
    if (plain) return text;
    std::string quoted(2 * text.size() + 2, '\0');
    quoted.resize(csv_write(quoted.data(), quoted.size(), text.data(), text.size()));
    return quoted;
}

void append(std::string& text, const std::vector<std::string>& cells) {
    for (size_t i = 0; i < cells.size(); ++i) {
        if (i > 0) text += ',';
        text += field(cells[i]);
    }
    // A line that is empty would be no row.
    if (cells.size() == 1 && cells[0].empty()) text += "\"\"";
    text += '\n';
}

}  // namespace

std::optional<size_t> Table::column(std::string_view name) const {
    const auto found = std::ranges::find(columns, name);
    if (found == columns.end()) return std::nullopt;
    return size_t(found - columns.begin());
}

Result<Table> read_table(const std::filesystem::path& file) {
    const auto bytes = scene::read_file(file, largest_file);
    if (!bytes) return tl::unexpected(bytes.error());
    const std::string name = scene::printable(file.string());
    std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());

    auto rows = parse_rows(text, name);
    if (!rows) return tl::unexpected(rows.error());
    if (rows->empty())
        return fail(ErrorKind::invalid_file, name, "is empty", "begin with a line of the columns' names");
    Table table{.columns = std::move(rows->front().cells), .rows = {}};
    std::set<std::string_view> seen;
    for (const std::string& column : table.columns) {
        if (column.empty() || !seen.insert(column).second)
            return fail(ErrorKind::invalid_file, fmt::format("{}, line {}", name, rows->front().line),
                        column.empty() ? "a column has no name"
                                       : fmt::format("two columns are called '{}'", scene::printable(column)),
                        "give each column a name of its own");
    }
    table.rows.assign(std::make_move_iterator(rows->begin() + 1), std::make_move_iterator(rows->end()));
    for (const Table::Row& row : table.rows) {
        if (row.cells.size() != table.columns.size())
            return fail(ErrorKind::invalid_file, fmt::format("{}, line {}", name, row.line),
                        fmt::format("has {} fields", row.cells.size()),
                        fmt::format("give {}, as the first line has", table.columns.size()));
    }
    return table;
}

std::string to_csv(const Table& table) {
    std::string text;
    append(text, table.columns);
    for (const Table::Row& row : table.rows) append(text, row.cells);
    return text;
}

Result<void> write_table(const std::filesystem::path& file, const Table& table) {
    const std::string text = to_csv(table);
    return scene::write_file(file, std::as_bytes(std::span(text)));
}

}  // namespace lumo::program
