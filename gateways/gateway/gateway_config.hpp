// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/rational.hpp"
#include "gateways/first_line/first_line_config.hpp"
#include "gateways/gateway/subscription_config.hpp"
#include "gateways/mapping/mapping.hpp"
#include "gateways/ptp/ptp_config.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::gateways {

using config::Ref;

/// One side of a mapping: a DDS topic with its type, or a stream.
struct MappingEnd {
    Ref topic, type, stream;
    std::vector<std::pair<Ref, std::string>> where; ///< only samples whose field has this text; source topics
    [[nodiscard]] bool is_topic() const { return !topic.empty(); }
};

/// One field of the target.
struct FieldRule {
    Ref to;
    Ref from;                           ///< empty: a constant
    std::optional<std::string> value;   ///< the constant
    std::optional<std::string> on_loss; ///< what it becomes when the source is lost
    config::SourceMark value_at, on_loss_at;
    double scale{1}, offset{0};
    std::string from_unit, to_unit;
    bool invert{false}, true_is_open{true};
};
/// As the mapping takes it, without its constant, which has a type of its target.
[[nodiscard]] mapping::Rule rule_of(FieldRule const& field);

/// What an event of the timeline does to the clock of a publisher of samples.
struct ClockChange {
    Rational at_s{0};
    bool synchronised{false};      ///< false: smpSynch is 0 from then on
    std::int64_t shift_samples{0}; ///< the counter runs so far ahead of the samples
};

struct MappingConfig {
    std::vector<ClockChange> clock_changes; ///< in the order of time
    Ref name;
    MappingEnd from, to;
    config::Node fields; ///< as written; read_rules() reads it

    Ref each;  ///< sequence of the topic's type whose elements are consecutive samples
    Ref index; ///< field of the topic's type with the index of the (first) sample; without: sample and hold

    /// Without a source: what constants become at a time of the run.
    struct Change {
        Rational at_s{0};
        config::Node set; ///< fields of the target and their values, as written
    };
    std::vector<Change> changes;
    [[nodiscard]] bool has_source() const { return !from.topic.empty() || !from.stream.empty(); }

    // to a topic
    enum class WriteOn { change, message } write_on{WriteOn::change};
    std::int64_t every{1};       ///< sampled values: one sample in so many
    std::int64_t per_message{1}; ///< with `each`: so many samples in a message
    std::string judged_by;       ///< GOOSE: a quality of the stream; what is not good by it, or for test, is not used
    bool accept_test{false};     ///< take frames that are marked as simulated
    FirstLineConfig first_line;  ///< from a stream
    // to a stream
    double lost_after_ms{0}; ///< the topic is lost when it was silent for so long; 0: never
    enum class Start { first_sample, at_once } start{Start::first_sample};
    enum class Sending { scheduled, on_arrival } sending{Sending::scheduled};
    double buffer_ms{1.5};

    std::vector<Ref> watch; ///< fields of the target that are published as signals
};

/// gridspace-gateway: a table of mappings between topics and streams.
struct GatewayConfig {
    std::vector<MappingConfig> mappings;
    std::vector<SubscriptionConfig> subscriptions;
    std::optional<ptp::PtpConfig> ptp;
    Rational latency_us{100}; ///< lockstep: from input to output
};
void describe(config::Fields& f, GatewayConfig& config);

/// `where` of a source topic.
void describe_where(config::Fields& f, MappingEnd& end);

/// A field as it may be written, "harm[2].f", in the spelling of the field lists, "harm.2.f".
[[nodiscard]] std::string field_path(std::string_view written);

/// `fields:` of a mapping.
[[nodiscard]] std::vector<FieldRule> read_rules(config::Node const& fields, config::Diagnostics& diagnostics);

} // namespace gridspace::gateways
