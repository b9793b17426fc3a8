// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "common/rational.hpp"
#include "gateways/iec61850/data_set.hpp"
#include "gateways/iec61850/frame.hpp"
#include "gateways/iec61850/goose_template.hpp"
#include "gateways/iec61850/sv_layout.hpp"
#include "gateways/iec61850/sv_template.hpp"
#include "gateways/streams/stream_authentication.hpp"
#include "gateways/streams/udp_address.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gridspace::streams {

using config::Ref;

enum class Kind { smv, goose };

/// When a GOOSE message is repeated (IEC 61850-8-1, 18.1).
struct GooseTiming {
    double min_time_ms{4};    ///< from a change to the first repetition
    double growth{2};         ///< each interval is so much longer than the one before
    double max_time_ms{1000}; ///< in steady state
    double live_factor{3};    ///< timeAllowedToLive, in intervals until the next message
    double live_min_ms{0};    ///< but at least so much
};

/// An entry of `streams:`: everything that publisher, subscriber and SCL have to agree on. Declared once; others use
/// its name.
struct Stream {
    Ref name;
    bool broken{false}; ///< its entry has mistakes, which have been told: whoever refers to it says nothing more
    Kind kind{Kind::smv};
    iec61850::Address address; ///< the source is the sender's port
    std::uint32_t conf_rev{1};
    std::string data_set_name; ///< datSet: sent where not empty
    iec61850::DataSet data_set;
    std::optional<StreamAuthentication> authentication;
    std::optional<UdpAddress> udp; ///< R-GOOSE, R-SV; `address.destination` is the group's then

    // sampled values
    std::string sv_id;
    Rational rate_hz{4800};
    std::int64_t samples_per_frame{1};
    std::uint8_t smp_synch{iec61850::kGlobalClock};
    bool send_refr_tm{false}, send_smp_rate{false};
    std::optional<std::uint64_t> gm_identity; ///< identity of the PTP grandmaster (9-2 Ed.2.1): sent when given

    // GOOSE
    std::string control_block; ///< gocbRef
    std::string go_id;         ///< empty: not sent
    GooseTiming timing;
    std::uint32_t first_sq_num{0};
    iec61850::IntegerForm integers{iec61850::IntegerForm::minimal};

    [[nodiscard]] std::uint16_t ethertype() const {
        return kind == Kind::smv ? iec61850::kSvEthertype : iec61850::kGooseEthertype;
    }
    /// The template of its frames, sent from `source`.
    [[nodiscard]] Result<iec61850::SvTemplate> sv_template(iec61850::Mac source) const;
    [[nodiscard]] Result<iec61850::GooseTemplate> goose_template(iec61850::Mac source) const;
    /// Octets behind the ethertype of its longest frame as it goes out: with its code, in its datagram. 0: it has none.
    [[nodiscard]] std::size_t longest_payload() const;
};

/// The keys of one stream.
void describe(config::Fields& f, Stream& stream);

/// Reads a whole `streams:` map (`like:` already resolved) and checks that every stream can be written as the standard
/// says and that no two are the same on the wire. Entries with mistakes are there too, and broken.
[[nodiscard]] std::vector<Stream> read_streams(config::Node const& streams, config::Diagnostics& diagnostics);

[[nodiscard]] Stream const* find_stream(std::span<Stream const> streams, std::string_view name);

} // namespace gridspace::streams
