// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/simulation_output.hpp"

#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <utility>

namespace gridspace::cli {

std::map<std::string, sim::Instrument::Ratio> ratios_of(sim::Network const& n) {
    std::map<std::string, sim::Instrument::Ratio> out;
    sim::NetworkAround const around{n};
    for (sim::Instrument const* i : sim::all<sim::Instrument>(n)) {
        out[signal_prefix(*i)] = i->ratio(around);
    }
    return out;
}

Result<void> SimulationOutput::open_csv(std::filesystem::path const& file) {
    csv_.open(file);
    if (!csv_) {
        return fail(ExitCode::environment, fmt::format("cannot write {}", file.string()),
                    "does the folder exist, and may you write there?");
    }
    std::string header = "time_s";
    for (std::size_t const c : columns_) {
        header += "," + engine_.signals()[c].name;
    }
    csv_ << header << '\n';
    return {};
}

Result<void> SimulationOutput::open_comtrade(std::filesystem::path const& file, ComtradeHeader header,
                                             std::map<std::string, sim::Instrument::Ratio> const& ratios) {
    for (std::size_t const c : columns_) {
        sim::SignalDef const& s = engine_.signals()[c];
        std::string const tail = s.name.substr(s.name.rfind('.') + 1);
        std::string const phase = tail == "a" || tail == "b" || tail == "c" ? tail : "";
        if (!s.may_be_unknown) { // samples of a recording are numbers
            ComtradeChannel channel{s.name, phase, s.unit};
            if (auto const ratio = ratios.find(s.name.substr(0, s.name.find('.', 3))); ratio != ratios.end()) {
                channel.primary = ratio->second.primary;
                channel.secondary = ratio->second.secondary;
            }
            (s.unit == "dpc" ? header.digital : header.analog).push_back(std::move(channel));
        }
    }
    auto writer = ComtradeWriter::create(file, std::move(header));
    if (!writer) {
        return std::unexpected{writer.error()};
    }
    comtrade_.emplace(std::move(*writer));
    return {};
}

void SimulationOutput::row(double t) {
    if (!state_) {
        return;
    }
    for (std::size_t k = 0; k < columns_.size(); ++k) {
        values_[k] = engine_.value(columns_[k]);
        sim::SignalDef const& s = engine_.signals()[columns_[k]];
        if (!std::isfinite(values_[k]) && !s.may_be_unknown) {
            state_ = fail(ExitCode::usage, fmt::format("'{}' is {} at {} s", s.name, values_[k], t),
                          "the rows before that are written; look at the element there");
            return;
        }
    }
    if (csv_.is_open()) {
        line_.clear();
        fmt::format_to(std::back_inserter(line_), "{}", t);
        for (double const value : values_) {
            if (std::isfinite(value)) {
                fmt::format_to(std::back_inserter(line_), ",{}", value);
            } else {
                line_.push_back(','); // not known yet: an empty cell
            }
        }
        line_.push_back('\n');
        csv_.write(line_.data(), static_cast<std::streamsize>(line_.size()));
    }
    if (comtrade_) {
        analog_.clear();
        std::size_t digital = 0;
        for (std::size_t k = 0; k < columns_.size(); ++k) {
            sim::SignalDef const& s = engine_.signals()[columns_[k]];
            if (s.unit == "dpc") {
                digital_[digital++] = values_[k] == 2; // closed
            } else if (!s.may_be_unknown) {
                analog_.push_back(values_[k]);
            }
        }
        comtrade_->row(analog_, {digital_.get(), digital});
    }
}

Result<void> SimulationOutput::finish(std::filesystem::path const& csv) {
    if (csv_.is_open()) {
        csv_.close();
        if (!csv_) {
            return fail(ExitCode::environment, fmt::format("cannot write {}", csv.string()), "is the disk full?");
        }
    }
    return comtrade_ ? comtrade_->finish() : Result<void>{};
}

} // namespace gridspace::cli
