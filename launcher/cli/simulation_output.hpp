// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/comtrade/comtrade_writer.hpp"
#include "common/result.hpp"
#include "sim/engine/engine.hpp"
#include "sim/network/network.hpp"

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::cli {

/// By the beginning of the transformer's signals ("ct.NAME", "vt.NAME").
[[nodiscard]] std::map<std::string, sim::Instrument::Ratio> ratios_of(sim::Network const& network);

/// What is written of the simulation, row by row.
class SimulationOutput {
  public:
    SimulationOutput(sim::Engine const& engine, std::vector<std::size_t> columns)
        : engine_{engine}, columns_{std::move(columns)}, values_(columns_.size()) {}

    Result<void> open_csv(std::filesystem::path const& file);

    /// `header`: without channels.
    Result<void> open_comtrade(std::filesystem::path const& file, ComtradeHeader header,
                               std::map<std::string, sim::Instrument::Ratio> const& ratios);

    /// What cannot be written: the first value that is no number, where there should be one.
    [[nodiscard]] Result<void> const& state() const { return state_; }

    void row(double t);

    Result<void> finish(std::filesystem::path const& csv);

  private:
    sim::Engine const& engine_;
    std::vector<std::size_t> columns_;
    std::vector<double> values_;
    Result<void> state_;
    std::ofstream csv_;
    std::optional<ComtradeWriter> comtrade_;
    std::string line_;
    std::vector<double> analog_;
    std::unique_ptr<bool[]> digital_{std::make_unique<bool[]>(columns_.size())};
};

} // namespace gridspace::cli
