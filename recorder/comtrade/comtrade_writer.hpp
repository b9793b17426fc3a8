// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

namespace gridspace {

struct ComtradeChannel {
    std::string name, phase, unit;
};
struct ComtradeHeader {
    std::string station{"gridspace"}, device{"simulation"};
    std::vector<ComtradeChannel> analog, digital;
    double line_frequency_hz{60};
    double sample_rate_hz{0};
    std::int64_t start_unix_s{0}; ///< UTC of the first sample
    double trigger_s{0};          ///< after it
};

/// A waveform file pair NAME.cfg and NAME.dat, IEEE C37.111-2013 (IEC 60255-24), data in float32. Rows go to the .dat
/// as they come; finish() writes the .cfg, which says how many there were.
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
