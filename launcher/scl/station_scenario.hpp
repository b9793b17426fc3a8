// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/scl/station.hpp"

#include <filesystem>
#include <map>
#include <optional>

namespace gridspace::launcher {

/// The instrument transformers that a merging unit of the station reads.
struct MeasuringPoint {
    std::string ct, vt;
    bool operator<(MeasuringPoint const& other) const { return std::pair{ct, vt} < std::pair{other.ct, other.vt}; }
};

struct StationOptions {
    std::string name;              ///< of the scenario
    std::vector<std::string> ieds; ///< that are played; empty: all
    double nominal_hz{50};
    bool realtime{false};
    std::string network;                          ///< as it is written into the scenario
    MeasuringPoint usual;                         ///< of every IED that `points` does not name
    std::map<std::string, MeasuringPoint> points; ///< by IED
};

/// What became of an IED.
struct PlayedIed {
    std::string ied;
    std::vector<std::string> processes;    ///< one; two where a part that hears must not wait for the part that sends
    std::vector<std::string> sends, hears; ///< streams
};

/// A stream of the scenario, and what its values are.
struct PlayedStream {
    std::string stream, ied, block;
    bool played{true};  ///< false: its IED is not played; it is there for who hears it
    std::string values; ///< "CT1 and VT1 of the network, 4800 Hz", "constants"
};

struct StationScenario {
    config::Node root; ///< a scenario
    std::vector<PlayedIed> ieds;
    std::vector<PlayedStream> streams;
    std::vector<scl::Finding> findings; ///< what could not be taken over here, in addition to those of the file
    std::vector<std::string> silent;    ///< IEDs that neither send nor hear a stream
};

/// A scenario that plays the IEDs: each a gateway with the streams that it sends and the subscriptions that it has.
/// Fails when an IED is not in the file, or nothing is left to play.
[[nodiscard]] Result<StationScenario> make_scenario(scl::Station const& station, StationOptions const& options);

/// A network for stations of which nobody has said what they measure: a source, a line with CT1, VT1 and breaker Q1,
/// and a load.
[[nodiscard]] std::string usual_network(std::string const& name, double nominal_hz);

} // namespace gridspace::launcher
