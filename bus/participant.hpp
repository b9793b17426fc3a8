// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/codec.hpp"
#include "bus/key_hash.hpp"
#include "common/result.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gridspace::bus {

/// A process of the run as its participant announces it. A restarted process has the next incarnation.
struct Peer {
    std::string process;
    std::uint32_t incarnation{0};
    std::string program;   ///< empty for a participant that is not ours
    std::string machine{}; ///< where it runs, as this_machine() says it there; empty when it does not say
    friend bool operator==(Peer const&, Peer const&) = default;
};

/// Where a received sample comes from.
struct SampleHeader {
    std::uint32_t peer{0};     ///< index for Participant::peer(): one for each participant
    std::uint32_t source{0};   ///< counts the writers that this reader has heard, from 0
    std::uint32_t writer{0};   ///< names the writer within its process; the same in every run
    std::uint64_t sequence{0}; ///< counts the samples of one writer, from 1
    std::int64_t source_ns{0}; ///< when it was sent, nanoseconds since 1970 (stamp_of); simulated time in lockstep
};

/// Called on the receiving thread: must not block and must not write.
using SampleHandler = std::function<void(std::span<std::byte const> cdr, SampleHeader const& header)>;

struct ParticipantOptions {
    std::string process;
    std::uint32_t incarnation{0};
    std::string program;
    int domain{0};
    std::filesystem::path qos_file;                     ///< qos/<role>.xml
    std::string profile{"management"};                  ///< participant profile in that file
    std::vector<std::string> addresses;                 ///< interfaces to use, by their IPv4 address; empty: all
    std::chrono::milliseconds address_patience{30'000}; ///< a board's interface may come up after its programs
    std::vector<std::string> peers{}; ///< whom to look for, "address:port"; empty: everybody, by multicast
};

struct Endpoint {
    std::string topic;
    std::string type_name;
    bool writer{false};
};

class RawWriter {
  public:
    virtual ~RawWriter() = default;
    /// Sends one sample. With `source_ns`, that is its time stamp on the wire; otherwise the wall clock.
    /// False when DDS refused it: the sample is lost, and the caller must say so.
    virtual bool write(void const* sample, std::optional<std::int64_t> source_ns) = 0;
    /// Sends ready CDR (with its encapsulation header). `key_hash`: of its instance, for a keyed type
    /// (bus/key_hash.hpp); without one all samples are of one instance.
    virtual bool write_cdr(std::span<std::byte const> cdr, std::optional<std::int64_t> source_ns,
                           KeyHash const* key_hash = nullptr) = 0;
    [[nodiscard]] virtual std::vector<Peer> matched() const = 0; ///< one entry per matched reader
    virtual bool wait_acknowledged(std::chrono::milliseconds deadline) = 0;
};

class RawReader {
  public:
    virtual ~RawReader() = default;
    [[nodiscard]] virtual std::vector<Peer> matched() const = 0; ///< one entry per matched writer
};

class DiscoveryObserver; // bus/discovery.hpp

/// One membership of a DDS domain. Everything of Fast DDS stays behind this class (docs/design/bus.md).
class Participant {
  public:
    /// `observer`, when there is one, must outlive the participant.
    [[nodiscard]] static Result<std::unique_ptr<Participant>> create(ParticipantOptions options,
                                                                     DiscoveryObserver* observer = nullptr);
    virtual ~Participant() = default;

    /// QoS come from the profile named like the topic in the role's file, or from its `default` profile.
    [[nodiscard]] virtual Result<std::unique_ptr<RawWriter>> create_writer(std::string const& topic,
                                                                           Codec const& codec) = 0;
    [[nodiscard]] virtual Result<std::unique_ptr<RawReader>> create_reader(std::string const& topic, Codec const& codec,
                                                                           SampleHandler handler) = 0;

    [[nodiscard]] virtual Peer peer(std::uint32_t index) const = 0;
    /// Whether another participant of this name and incarnation is here.
    [[nodiscard]] virtual bool hears(Peer const& peer) const = 0;
    /// The participants that are here, as indices for peer(), in the order in which they were found.
    [[nodiscard]] virtual std::vector<std::uint32_t> here() const = 0;
    [[nodiscard]] virtual bool is_here(std::uint32_t peer) const = 0;
    /// Who has a writer, or a reader, of a topic, as far as discovery has told; matched or not.
    [[nodiscard]] virtual std::vector<Peer> known_on(std::string const& topic, bool writers) const = 0;
    /// Datagrams that were no RTPS, or such as the library must not see (bus/rtps_guard): "12 (numbers that cannot
    /// be)".
    [[nodiscard]] virtual std::string refused_datagrams() const = 0;
    /// Called, from threads of DDS, whenever a peer appears or leaves or an endpoint is matched or unmatched.
    virtual void on_change(std::function<void()> callback) = 0;
    /// Called, from threads of DDS, when a participant is gone: `clean` when it said goodbye, not when its lease ran
    /// out.
    virtual void on_departure(std::function<void(std::uint32_t peer, bool clean)> callback) = 0;
    /// Everybody has everything: writers that are deleted from now on do not wait for acknowledgements.
    virtual void leave_at_once() = 0;
};

} // namespace gridspace::bus
