// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/goose.hpp"
#include "gateways/iec61850/routable.hpp"
#include "gateways/iec61850/sv_subscriber.hpp"
#include "launcher/wire/steady_interval.hpp"

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gridspace::wire {

/// What can be said about a stream by listening, without knowing its configuration.
struct ObservedStream {
    bool goose{false};
    bool routed{false}; ///< R-GOOSE or R-SV: over UDP
    std::string id;     ///< svID or gocbRef
    iec61850::Mac destination, source;
    std::optional<iec61850::VlanTag> vlan;
    std::uint16_t app_id{0};
    bool simulated{false};
    std::uint32_t conf_rev{0};
    std::uint64_t frames{0}, lost{0}, duplicates{0}, out_of_order{0}, restarts{0};
    std::int64_t first_ns{0}, last_ns{0};
    std::uint64_t last_frame{0}; ///< number of the frame that it was last seen in

    // sampled values
    std::uint16_t asdus{0}; ///< per frame
    std::size_t sample_octets{0};
    std::uint8_t smp_synch{0};
    std::shared_ptr<iec61850::SvSubscriber> counter;

    // GOOSE
    std::uint32_t st_num{0}, sq_num{0}, live_ms{0};
    std::uint64_t since{0};                  ///< when its state began, as it says itself: UtcTime as it was sent
    std::uint64_t states{0}, late{0};        ///< late: came after timeAllowedToLive of the one before
    std::vector<MessageInterval> intervals;  ///< between messages, in order
    std::vector<std::vector<double>> bursts; ///< intervals behind each change of state, at most kBurst of each
    bool burst_whole{true};                  ///< the last one may go on
    std::string values;                      ///< of the last message, for people

    static constexpr std::size_t kBurst = 12, kBursts = 1000, kIntervals = 1'000'000;
    [[nodiscard]] double rate_hz() const; ///< samples or messages a second
    [[nodiscard]] double frame_rate_hz() const;
    /// "alive", "silent": by what the stream itself promises.
    [[nodiscard]] bool alive(std::int64_t now_ns) const;
};

/// Sorts frames into streams. Streams are told apart by source address, APPID and name. Of a flood of made-up names the
/// first kMaxStreams are kept, the frames of the others are counted.
class Observer {
  public:
    static constexpr std::size_t kMaxStreams = 1024;

    /// A stream in a frame, and whether all that the frame held of it had come before.
    struct Seen {
        ObservedStream const* stream;
        bool duplicate;
    };

    /// `sv_id`: of sampled values only this stream is kept; empty: all.
    explicit Observer(std::string sv_id = {}) : sv_id_{std::move(sv_id)} {}

    /// Any Ethernet frame; frames of other protocols are counted and otherwise ignored. Gives the streams in it, each
    /// once, until the next call.
    std::span<Seen const> add(iec61850::Octets frame, std::int64_t time_ns);

    [[nodiscard]] std::vector<ObservedStream const*> streams() const; ///< by name
    [[nodiscard]] std::uint64_t frames() const { return frames_; }
    [[nodiscard]] std::uint64_t other() const { return other_; }
    [[nodiscard]] std::uint64_t unwanted() const { return unwanted_; } ///< frames without the one svID that is kept
    [[nodiscard]] std::uint64_t beyond_table() const { return beyond_table_; } ///< SV samples and GOOSE messages
    [[nodiscard]] iec61850::DecodeCounters const& errors() const { return errors_; }

  private:
    using Key = std::tuple<bool, std::string, iec61850::Mac, std::uint16_t, bool>;
    ObservedStream* stream_of(bool goose, std::string_view id, iec61850::FrameHeader const& header,
                              std::int64_t time_ns);
    void add_sv(iec61850::Octets frame, std::int64_t time_ns);
    void add_goose(iec61850::Octets frame, std::int64_t time_ns);
    void add_routed(iec61850::Octets frame, iec61850::Octets datagram, std::int64_t time_ns);

    std::string sv_id_;
    bool routed_{false}; ///< what is being added came over UDP
    std::unique_ptr<iec61850::RoutableFrame> routable_{std::make_unique<iec61850::RoutableFrame>()};
    std::vector<std::uint8_t> rewrapped_; ///< decoded frames have views into it
    std::map<Key, ObservedStream> streams_;
    std::vector<Seen> seen_;
    std::uint64_t frames_{0}, other_{0}, unwanted_{0}, beyond_table_{0};
    iec61850::DecodeCounters errors_;
    std::unique_ptr<iec61850::SvFrame> sv_{std::make_unique<iec61850::SvFrame>()};
    iec61850::GooseFrame goose_;
};

/// The members of allData as text: "true, {open, 0x0000}".
[[nodiscard]] std::string data_text(iec61850::GooseFrame const& message);

/// A text from the wire with everything that is not visible ASCII escaped.
[[nodiscard]] std::string visible(std::string_view text);

} // namespace gridspace::wire
