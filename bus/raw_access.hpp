// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/discovery.hpp"
#include "bus/participant.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

/// What tools need that carry samples of any topic (router, player): endpoints whose QoS are not those of a role.
namespace gridspace::bus {

/// How two participants meet where no multicast goes: one listens, others connect to it.
struct TcpLink {
    bool listens{false};
    std::string address; ///< name or IPv4 address of the one who listens
    std::uint16_t port{0};
    struct Tls {
        std::filesystem::path certificate, private_key; ///< PEM; the certificate with its chain
        std::filesystem::path authority;                ///< who must have signed the other side's
    };
    std::optional<Tls> tls; ///< both sides prove who they are
};

/// Like Participant::create(), over TCP alone. Endpoint profiles come from `options.qos_file` as ever. `observer` must
/// outlive the participant.
[[nodiscard]] Result<std::unique_ptr<Participant>> join_over_tcp(ParticipantOptions options, TcpLink const& link,
                                                                 DiscoveryObserver* observer = nullptr);

/// A reader with the QoS of `like` (reliability, durability, ownership, partitions) instead of a profile's; history and
/// limits from the `default` profile. What its own participant writes is not handed to it.
[[nodiscard]] Result<std::unique_ptr<RawReader>> create_reader_like(Participant& participant, std::string const& topic,
                                                                    Codec const& codec, EndpointQos const& like,
                                                                    SampleHandler handler);

/// A writer with the QoS of `like`; `depth` samples of each instance are kept for readers that are behind or come late
/// (0: what the `default` profile says).
[[nodiscard]] Result<std::unique_ptr<RawWriter>> create_writer_like(Participant& participant, std::string const& topic,
                                                                    Codec const& codec, EndpointQos const& like,
                                                                    std::int32_t depth = 0);

} // namespace gridspace::bus
