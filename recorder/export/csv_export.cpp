// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/export/csv_export.hpp"

#include "common/csv_field.hpp"
#include "common/idl/cdr_visitor.hpp"
#include "common/text.hpp"
#include "recorder/mcap/mcap_reader.hpp"
#include "recorder/signals/signal_store.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <set>
#include <utility>

namespace gridspace {
namespace {

/// "evs[0].soc_percent" -> "evs_0_soc_percent"
std::string column_name(std::string_view path) {
    std::string out;
    for (char const c : path) {
        if (c == '[' || c == '.') {
            out += '_';
        } else if (c != ']') {
            out += c;
        }
    }
    return out;
}

/// The tables of an export.
class Tables {
  public:
    explicit Tables(std::filesystem::path folder) : folder_{std::move(folder)} {}

    /// A new one, never through a link to somewhere else. A topic of somebody else's may be called "rt/chatter", and
    /// another one "rt_chatter": the second of a name gets a number.
    std::ofstream begin(std::string topic) {
        std::replace(topic.begin(), topic.end(), '/', '_');
        std::string name = topic;
        for (int number = 2; !names_.insert(name).second; ++number) {
            name = fmt::format("{}_{}", topic, number);
        }
        files_.push_back(folder_ / (name + ".csv"));
        std::error_code ignored;
        std::filesystem::remove(files_.back(), ignored);
        return std::ofstream{files_.back()};
    }
    [[nodiscard]] std::vector<std::filesystem::path> const& files() const { return files_; }

  private:
    std::filesystem::path folder_;
    std::set<std::string> names_;
    std::vector<std::filesystem::path> files_;
};

std::string cell(idl::Type const& type, idl::Value const& value) {
    if (type.kind == idl::Kind::enumeration) {
        auto const number = std::get<std::int64_t>(value);
        for (auto const& [name, n] : type.values) {
            if (n == number) {
                return name;
            }
        }
    }
    return csv_field(idl::to_text(value));
}

/// A topic's table; columns are found in a first pass, because sequences have different lengths.
struct Table {
    idl::Model model;
    std::size_t type{0};
    std::vector<std::string> columns;
    std::map<std::string, std::size_t, std::less<>> places;
    std::ofstream stream;
    std::uint64_t unreadable{0};
    std::string why;
    [[nodiscard]] bool readable() const { return !columns.empty(); }
};

struct Columns final : idl::Visitor {
    std::vector<std::string> seen;
    void leaf(std::string_view path, idl::Type const&, idl::Value const&) override { seen.emplace_back(path); }
};

struct Cells final : idl::Visitor {
    Table const* table{nullptr};
    std::vector<std::string> row;
    void leaf(std::string_view path, idl::Type const& type, idl::Value const& value) override {
        if (auto const it = table->places.find(path); it != table->places.end()) {
            row[it->second] = cell(type, value);
        }
    }
};

bool is_signal_topic(std::string const& topic) {
    return topic == "signals" || topic == "signal_catalog";
}

Result<void> write_signals(std::filesystem::path const& mcap, Tables& written) {
    auto const store = read_signals(mcap, [](std::string const&) { return true; });
    if (!store) {
        return std::unexpected{store.error()};
    }
    // Signals with the same instants belong together: one table each.
    std::map<std::vector<std::int64_t>, std::vector<std::string>> groups;
    for (auto const& [name, series] : *store) {
        groups[series.times_ns].push_back(name);
    }
    int number = 0;
    for (auto const& [times, names] : groups) {
        std::ofstream stream = written.begin(groups.size() == 1 ? "signals" : fmt::format("signals_{}", ++number));
        stream << "time_s";
        for (std::string const& name : names) {
            stream << ',' << csv_field(name);
        }
        stream << '\n';
        for (std::size_t i = 0; i < times.size(); ++i) {
            stream << shortest(static_cast<double>(times[i]) / 1e9);
            for (std::string const& name : names) {
                stream << ',' << shortest(store->at(name).values[i]);
            }
            stream << '\n';
        }
        if (!stream) {
            return fail(ExitCode::environment, fmt::format("cannot write '{}'", written.files().back().string()));
        }
    }
    return {};
}

} // namespace

Result<CsvExport> export_csv(std::filesystem::path const& mcap, std::int64_t epoch_ns,
                             std::filesystem::path const& folder) {
    std::map<std::string, Table> tables;
    auto const find_columns = [&](mcap::Message const& m) {
        if (is_signal_topic(m.channel.topic)) {
            return true;
        }
        auto [it, fresh] = tables.try_emplace(m.channel.topic);
        Table& table = it->second;
        if (fresh) {
            bool const is_idl = m.schema.encoding == "omgidl";
            auto model = idl::parse(is_idl ? m.schema.data : "");
            auto const type = model ? model->find(m.schema.name) : std::nullopt;
            if (type) {
                table.model = std::move(*model);
                table.type = *type;
            } else if (!is_idl) {
                table.why = fmt::format("its schema is '{}', and not IDL (omgidl)", printable(m.schema.encoding));
            } else {
                table.why = model ? fmt::format("its IDL does not define '{}'", m.schema.name) : model.error().message;
            }
        }
        if (table.model.types.empty()) {
            ++table.unreadable;
            return true;
        }
        Columns columns;
        if (auto ok = visit(table.model, table.type, m.data, columns); !ok) {
            ++table.unreadable;
            table.why = ok.error().message;
            return true;
        }
        for (std::string& path : columns.seen) {
            if (table.places.try_emplace(path, table.columns.size()).second) {
                table.columns.push_back(std::move(path));
            }
        }
        return true;
    };
    auto outcome = mcap::read_messages(mcap, find_columns);
    if (!outcome) {
        return std::unexpected{outcome.error()};
    }
    std::error_code error;
    std::filesystem::create_directories(folder, error); // not for a recording that is none
    CsvExport out;
    Tables written{folder};
    if (!outcome->complete) {
        out.notes.push_back(fmt::format("the recording is incomplete: {}", outcome->note));
    }
    for (auto& [topic, table] : tables) {
        if (table.unreadable > 0) {
            out.notes.push_back(
                fmt::format("{} samples of '{}' cannot be read: {}", table.unreadable, topic, table.why));
        }
        if (!table.readable()) {
            continue;
        }
        table.stream = written.begin(topic);
        table.stream << "time_s,process";
        for (std::string const& column : table.columns) {
            table.stream << ',' << column_name(column);
        }
        table.stream << '\n';
    }
    outcome = mcap::read_messages(mcap, [&](mcap::Message const& m) {
        if (is_signal_topic(m.channel.topic)) {
            return true;
        }
        auto const found = tables.find(m.channel.topic);
        if (found == tables.end()) {
            return true; // it is being recorded, and this topic has just begun
        }
        Table& table = found->second;
        Cells cells;
        cells.table = &table;
        cells.row.resize(table.columns.size());
        if (!table.readable() || !visit(table.model, table.type, m.data, cells)) {
            return true;
        }
        auto const process = m.channel.metadata.find("process");
        double const t = static_cast<double>(static_cast<std::int64_t>(m.time_ns) - epoch_ns) / 1e9;
        table.stream << shortest(t) << ',' << (process == m.channel.metadata.end() ? "" : csv_field(process->second));
        for (std::string const& text : cells.row) {
            table.stream << ',' << text;
        }
        table.stream << '\n';
        return true;
    });
    for (auto& [topic, table] : tables) {
        if (table.readable() && !table.stream.flush()) {
            return fail(ExitCode::environment,
                        fmt::format("cannot write the table of '{}' into '{}'", topic, folder.string()));
        }
    }
    if (auto ok = write_signals(mcap, written); !ok) {
        return std::unexpected{ok.error()};
    }
    out.files = written.files();
    return out;
}

} // namespace gridspace
