// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/sample_reader.hpp"
#include "launcher/wire/observer.hpp"

#include <string>
#include <vector>

namespace gridspace::scan {

/// What is known of a stream of sampled values before it is judged.
struct SvDescription {
    streams::Stream stream; ///< address, rate and ASDUs as they were seen where nobody has said them
    bool rate_known{false};
    std::string layout;                        ///< "9-2LE", "described", or why its samples cannot be read
    std::optional<relay::PhaseMembers> phases; ///< nothing: its samples cannot be read
};

/// Streams that somebody has described (a scenario, an SCL file), or that follow 9-2LE.
class KnownStreams {
  public:
    /// `currents`: names of the members with the phase currents; empty: Ia, Ib, Ic, or else the first three numbers.
    KnownStreams(std::vector<streams::Stream> described, std::vector<std::string> currents)
        : described_{std::move(described)}, currents_{std::move(currents)} {}

    /// `name`: of a stream in the files, or as it is on the wire. What it is called on the wire.
    [[nodiscard]] std::string wire_name(std::string const& name) const;
    [[nodiscard]] streams::Stream const* find(streams::Kind kind, std::string const& wire_name) const;

    /// What was seen of one svID: the sender with most frames says how fast it is.
    [[nodiscard]] SvDescription describe(std::string const& sv_id,
                                         std::vector<wire::ObservedStream const*> const& seen) const;

  private:
    void find_phases(SvDescription& out, std::size_t octets) const;

    std::vector<streams::Stream> described_;
    std::vector<std::string> currents_;
};

} // namespace gridspace::scan
