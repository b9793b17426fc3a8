// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/common/line_sample.hpp"
#include "common/result.hpp"
#include "gateways/iec61850/sv.hpp"
#include "gateways/iec61850/sv_layout.hpp"
#include "gateways/streams/stream.hpp"

#include <array>
#include <optional>
#include <string>

namespace gridspace::relay {

/// Members of a data set that hold the phases. An integer counts milliamperes and 10 mV (9-2LE); a member of type
/// quality right behind a value is its quality.
struct PhaseMembers {
    std::optional<std::array<std::string, 3>> currents{}, voltages{};
};

/// Reads currents and voltages of three phases out of the samples of one stream.
class SampleReader {
  public:
    [[nodiscard]] static Result<SampleReader> create(streams::Stream const& stream, PhaseMembers const& members);

    [[nodiscard]] std::size_t sample_octets() const { return layout_.sample_octets(); }
    /// An ASDU whose sample has sample_octets().
    [[nodiscard]] EndSample read(iec61850::FrameHeader const& header, iec61850::Asdu const& asdu) const;

  private:
    struct Phases {
        std::array<std::size_t, 3> value{};
        std::array<std::optional<std::size_t>, 3> quality{};
        double scale{1};
    };
    explicit SampleReader(iec61850::DataSet const& data_set) : layout_{data_set} {}
    [[nodiscard]] Result<std::optional<Phases>>
    find(std::string const& stream, std::optional<std::array<std::string, 3>> const& members, double of_integers) const;
    void read_phases(Phases const& from, iec61850::Octets octets, Abc& values, EndSample& sample) const;

    iec61850::SvLayout layout_;
    std::optional<Phases> currents_, voltages_;
};

} // namespace gridspace::relay
