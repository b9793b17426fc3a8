// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/comtrade/comtrade_header.hpp"
#include "common/result.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

namespace gridspace {

/// A waveform file pair NAME.cfg and NAME.dat in float32, written as the rows come: for runs of any length. finish()
/// writes the .cfg, which says how many rows there were. A record that is known as a whole: comtrade_record.hpp.
class ComtradeWriter {
  public:
    /// `file` with or without one of the two extensions.
    [[nodiscard]] static Result<ComtradeWriter> create(std::filesystem::path file, ComtradeHeader header);
    void row(std::span<double const> analog, std::span<bool const> digital);
    [[nodiscard]] Result<void> finish();
    [[nodiscard]] std::filesystem::path const& cfg() const { return cfg_; }

  private:
    ComtradeWriter() = default;
    ComtradeHeader header_;
    std::filesystem::path cfg_, dat_;
    std::ofstream data_;
    std::string record_;
    std::uint32_t rows_{0};
};

} // namespace gridspace
