// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/network/network.hpp"

#include <complex>
#include <cstddef>
#include <vector>

namespace gridspace::sim {

/// Which breakers are closed now; starts as the network file says.
struct SwitchState {
    explicit SwitchState(Network const& network);
    std::vector<bool> breaker_closed;            ///< by breaker
    std::vector<bool> line_out, transformer_out; ///< taken out of service as a whole
    [[nodiscard]] bool closed(Network const& network, std::string const& line, LineEnd end) const;
};

/// A branch in positive sequence, p.u. on the network's base: i_from = ff v_from + ft v_to, i_to = tf v_from + tt v_to.
struct TwoPort {
    enum class Kind { line, transformer } kind{Kind::line};
    std::size_t element{0};     ///< index in the network's lines or transformers
    std::size_t from{0}, to{0}; ///< bus indices
    Complex ff, ft, tf, tt;
};

/// Lines and transformers in service. A line that is open at one end still draws its charging current from the other.
[[nodiscard]] std::vector<TwoPort> two_ports(Network const& network, SwitchState const& state);

/// By how much the voltage at `to` leads that at `from` without load, radians: minus the shift of a transformer.
[[nodiscard]] double lead_of(TwoPort const& b);

/// Base impedance of a bus, ohm.
[[nodiscard]] double base_impedance(Network const& network, Bus const& bus);

} // namespace gridspace::sim
