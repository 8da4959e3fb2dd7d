// Tables of text: CSV files as RFC 4180 has them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rhi/error.hpp"

namespace lumo::program {

/// A table with named columns. Every row has a cell for each of them.
struct Table {
    struct Row {
        uint64_t line = 0;  ///< of the file, from 1, on which it ends
        std::vector<std::string> cells;
    };

    std::vector<std::string> columns;
    std::vector<Row> rows;

    std::optional<size_t> column(std::string_view name) const;
};

/// Fields may be quoted; blanks around those that are not are taken away; empty lines are skipped. Errors: io, limit
/// (256 MiB, a million rows), invalid_file with the line: no header, a column without a name or named twice, a row of
/// another length, a quote out of place.
Result<Table> read_table(const std::filesystem::path& file);

/// As read_table reads it; quotes where it must.
std::string to_csv(const Table& table);

/// Errors: io.
Result<void> write_table(const std::filesystem::path& file, const Table& table);

}  // namespace lumo::program
