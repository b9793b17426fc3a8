// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/attack_config.hpp"
#include "agents/attacker/sv_target.hpp"
#include "gateways/iec61850/goose_subscriber.hpp"

#include <optional>
#include <utility>
#include <vector>

namespace gridspace::attacker {

/// What an attack waits for on a stream: a current above a bound, or what the publisher of a GOOSE message says. Pure;
/// no allocation per frame.
class StreamCondition {
  public:
    /// `channels`: which currents, or which Boolean; empty: all three, or the first. Fails when the stream has none.
    [[nodiscard]] static Result<StreamCondition> create(streams::Stream const& stream, std::string const& attack,
                                                        AttackConfig::Condition const& condition,
                                                        std::vector<std::string> const& channels);

    /// Whether the frame is of the stream and fulfils it. `time_ns`: simulated.
    [[nodiscard]] bool met(iec61850::Octets frame, std::int64_t time_ns);

  private:
    struct Currents {
        explicit Currents(streams::Stream const& stream) : target{stream} {}
        SvTarget target;
        std::vector<std::pair<std::size_t, double>> slots; ///< and the amperes of one count
        double above_a{0};
        iec61850::SvFrame decoded;
    };
    struct Said {
        explicit Said(streams::Stream const& stream);
        iec61850::GooseSubscriber heard;
        std::size_t leaf{0};
        bool value{false};
        iec61850::GooseFrame decoded;
    };
    std::optional<Currents> currents_; ///< one of the two
    std::optional<Said> said_;
};

/// Number in the data set of the Boolean `name`, of the first one when it is empty; nothing when there is none.
[[nodiscard]] std::optional<std::size_t> boolean_leaf(streams::Stream const& stream, std::string_view name);

} // namespace gridspace::attacker
