// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/gateway/gateway_config.hpp"
#include "gateways/gateway/topic_fields.hpp"
#include "gateways/mapping/mapping.hpp"
#include "gateways/mapping/record_type.hpp"
#include "gateways/streams/stream.hpp"

#include <memory>

namespace gridspace::gateways {

/// What a stream has in addition to its data set: fields of a source, named with a '$' before them.
enum class StreamField : std::uint8_t { alive, simulated, smp_cnt, index, smp_synch, st_num, sq_num, t };

/// A mapping, checked against both of its sides: what it needs to run.
struct Route {
    Route() = default;
    Route(Route&&) noexcept = default;
    Route& operator=(Route&&) noexcept = default;

    MappingConfig config;
    std::vector<FieldRule> fields;               ///< constants point into their texts
    streams::Stream const* from_stream{nullptr}; ///< nullptr: a topic
    streams::Stream const* to_stream{nullptr};
    std::shared_ptr<mapping::RecordType const> from_type, to_type; ///< of topics
    std::vector<mapping::Field> from, to;                          ///< fields of both sides
    std::size_t stream_fields{0}; ///< source streams: leaves of the data set; behind them the StreamFields
    mapping::Mapping rules;
    mapping::Mapping constants;       ///< of the rules, for what is sent before the first sample
    mapping::Mapping on_loss;         ///< constants only
    bool acts_on_loss{false};         ///< a loss is written: it has values for it, or $alive is mapped
    std::vector<std::size_t> written; ///< fields of the target that are written, the gateway's own included
    std::vector<std::size_t>
        invalid; ///< qualities of sampled values that no rule writes, behind values that none writes
    std::optional<std::size_t> index_field, time_field; ///< of the topic: with the sample's index; time_ns of a target
    struct Filter {
        std::size_t field{0};
        mapping::Value value;
    };
    std::vector<Filter> filters;
    std::vector<std::size_t> watched; ///< fields of the target
    struct Change {
        Rational at_s;
        std::vector<std::pair<std::size_t, mapping::Value>> values; ///< by field of the target; texts are in `config`
    };
    std::vector<Change> changes;

    [[nodiscard]] bool to_samples() const { return to_stream != nullptr && to_stream->kind == streams::Kind::smv; }
    [[nodiscard]] bool is_held() const { return to_samples() && !index_field; } ///< sent at its own rate
};

/// Checks a mapping and makes it ready. Everything that is wrong is in `diagnostics`, at its place in the file; the
/// route is usable when nothing is. `streams` must outlive the route.
[[nodiscard]] Route make_route(MappingConfig const& config, std::vector<streams::Stream> const& streams,
                               FindIdl const& find_idl, config::Diagnostics& diagnostics);

/// All mappings of a gateway, and what they must not do to each other.
[[nodiscard]] std::vector<Route> make_routes(GatewayConfig const& config, std::vector<streams::Stream> const& streams,
                                             FindIdl const& find_idl, config::Diagnostics& diagnostics);

} // namespace gridspace::gateways
