// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/frame_attack.hpp"
#include "agents/attacker/goose_attack.hpp"
#include "agents/attacker/sample_attack.hpp"
#include "common/config/fields.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::attacker {

/// One entry of a scenario's `attacks:`.
struct AttackConfig {
    config::Ref name;
    config::Ref by; ///< the attacker process
    enum class Place {
        between,          ///< a man in the middle of a link: frames are altered on their way
        second_publisher, ///< frames in addition to those of the real publisher
    } place{Place::second_publisher};
    std::vector<config::Ref> between;  ///< host (or process) and link
    bool spoof{false};                 ///< second publisher: frames with the source address of the real one
    config::Ref stream, topic;         ///< the target: one of the two
    std::vector<std::string> channels; ///< members of the data set or of the type
    Rational from_s{0}, until_s{0};
    Rational every_s{0};   ///< from the start of a window to that of the next
    std::int64_t times{1}; ///< how many windows
    Rational ramp_s{0};    ///< from nothing to the full attack
    /// It begins, within each window, when a stream that passes the attacker shows this. One of the two is given.
    struct Condition {
        config::Ref stream;                ///< empty: the target
        std::vector<std::string> channels; ///< of that stream
        std::optional<double> above_a;     ///< sampled values: a current is larger
        std::optional<bool> said;          ///< GOOSE: its publisher says so
    };
    std::optional<Condition> when;
    [[nodiscard]] bool waits_for_other() const { return when && !when->stream.empty(); }
    [[nodiscard]] double end_s() const {
        return until_s.to_double() + static_cast<double>(times - 1) * every_s.to_double();
    }

    SampleAttackParams samples;              ///< attacks on values; indices are filled in by make_sample_attack
    Rational replay_s{0};                    ///< replay: how old the samples are
    std::filesystem::path recording;         ///< recording: the file
    std::optional<double> recording_rate_hz; ///< of a file that does not say it
    bool recording_of_to{false};             ///< its last three columns
    std::optional<GooseAttackParams> goose;  ///< attacks on messages
    std::optional<FrameAttackParams> frames; ///< attacks on frames of sampled values
};

/// Reads the whole `attacks:` map of `parent`.
void describe_attacks(config::Fields& parent, std::vector<AttackConfig>& attacks);

/// "random", "masquerade_trip", …: what kind of attack it is, as its labels say.
[[nodiscard]] std::string_view kind_name(AttackConfig const& config);

/// Its windows in nanoseconds.
[[nodiscard]] AttackTimes times_in_ns(AttackConfig const& config);

/// The attack on a stream of `rate_hz` whose three phases have the names `phases`. Sample n has the time n / rate_hz.
[[nodiscard]] Result<SampleAttack> make_sample_attack(AttackConfig const& config,
                                                      std::vector<std::string> const& phases, double rate_hz,
                                                      double frequency_hz, std::uint64_t seed);

} // namespace gridspace::attacker
