// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <optional>
#include <string>
#include <vector>

namespace gridspace::diagram {

/// A network as far as its one-line diagram needs it; the launcher writes it into the monitor's settings.
struct Grid {
    struct Bus {
        std::string name, label;
        double voltage_v{0};
        std::optional<double> x, y; ///< column and row, as the network file says them
    };
    struct Branch {
        std::string name, label, from, to, kind;
    };
    struct Breaker {
        std::string name, line, end;
    };
    struct Ct {
        std::string name, line, end;
    };
    struct Device {
        std::string name, label, bus, kind;
    };
    /// A relay, as far as the scenario shows what belongs to it.
    struct Relay {
        std::string name;
        std::vector<config::Ref> functions; ///< device numbers of IEEE C37.2: 87L, 21, 51
        std::vector<config::Ref> cts, breakers;
    };
    /// A fault on a line, or at a bus.
    struct Fault {
        std::string name, line, bus;
        double position_percent{50}, at_s{0};
        std::optional<double> until_s;
    };
    double frequency_hz{0}; ///< 0: not known
    std::vector<Bus> buses;
    std::vector<Branch> branches;
    std::vector<Breaker> breakers;
    std::vector<Ct> cts;
    std::vector<Device> devices;
    std::vector<Relay> relays;
    std::vector<Fault> faults;

    /// What the size of a diagram goes by: buses, branches and what hangs on the buses.
    [[nodiscard]] std::size_t elements() const { return buses.size() + branches.size() + devices.size(); }
};

void describe(config::Fields& f, Grid& grid);

} // namespace gridspace::diagram
