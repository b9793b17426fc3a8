// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/codec.hpp"
#include "bus/inbox.hpp"
#include "bus/lockstep/foreign_frames.hpp"
#include "bus/node_config.hpp"
#include "bus/participant.hpp"
#include "common/result.hpp"
#include "common/time.hpp"

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::bus {

class ClockServer;
class SignalPublisher;
class WireReader;
class WireWriter;

/// A moment in which a process may work: everything up to `time` that it reads has arrived.
struct Tick {
    std::uint64_t number{0};
    SimTime time;
    bool final{false};
    bool part{false}; ///< the tick goes on: the next one has the same number, and only that is acknowledged
};

/// Writes samples of one topic, counted for the ledger. T is a generated type.
template <class T>
class Writer;
class CdrWriter;

/// One process on the bus: its readers and writers on the two networks, its place in the simulation clock, and its
/// status.
///
///     Node node{config};                         // 1. joins the domains
///     auto in = node.reader<ChargingRequest>("requests");
///     auto out = node.writer<ChargingDecision>("decisions");
///     node.start();                              // 2. waits until everybody expected is matched
///     while (auto tick = node.next()) {          // 3. same loop in lockstep and in real time
///         for (auto const& sample : in->take()) { ... out->write(decision, at); }
///         node.done(tick, next_tick_needed);
///     }
///
/// Errors are returned once and stay: after a failure every call returns it.
class Node {
  public:
    [[nodiscard]] static Result<std::unique_ptr<Node>> create(NodeConfig config);
    ~Node();
    Node(Node const&) = delete;
    Node& operator=(Node const&) = delete;

    template <class T>
    [[nodiscard]] Result<std::unique_ptr<Writer<T>>> writer(std::string const& topic);
    template <class T>
    [[nodiscard]] Result<std::shared_ptr<Reader<T>>> reader(std::string const& topic);
    /// Samples go to an inbox of the caller's.
    [[nodiscard]] Result<void> reader(std::string const& topic, Codec const& codec, std::shared_ptr<Inbox> inbox) {
        return open_reader(topic, codec, std::move(inbox));
    }
    /// Samples of any type as CDR.
    [[nodiscard]] Result<std::shared_ptr<CdrReader>> cdr_reader(std::string const& topic, Codec const& codec);
    [[nodiscard]] Result<std::unique_ptr<CdrWriter>> cdr_writer(std::string const& topic, Codec const& codec);

    /// The clock's own samples as CDR, for a recorder: everything that belongs to the granted tick is in it.
    [[nodiscard]] std::shared_ptr<CdrReader> tap_clock();
    [[nodiscard]] std::shared_ptr<CdrReader> tap_acknowledgements();
    [[nodiscard]] std::string process_name(Origin const& origin) const;

    /// Waits, as long as something advances within start_timeout_s, until all expected peers are matched and says
    /// READY.
    [[nodiscard]] Result<void> start();
    /// Called once by start(), when all expected peers are matched.
    void on_ready(std::function<void()> callback);

    /// Lockstep: the next tick that awaits this process, with all its input. Real time: whenever the clock has advanced
    /// or input has arrived. Nothing when the run is over (the tick before was final) or a stop was asked for.
    /// `deadline` (real time only): a tick of what there is, when nothing has happened until then.
    [[nodiscard]] Result<std::optional<Tick>>
    next(std::optional<std::chrono::steady_clock::time_point> deadline = std::nullopt);
    /// The work of the tick is done; everything that it makes visible has been written.
    [[nodiscard]] Result<void> done(Tick const& tick, std::uint64_t next_tick_needed);

    /// Lockstep: next() calls it when frames that others have announced are not here yet, and the end of done() calls
    /// `flush`, before the acknowledgement. On the process's own thread; before start().
    void exchange_frames_with(std::function<void()> fetch, std::function<void()> flush);
    /// Lockstep, for who only listens: while nothing is asked of it, it takes what has come in rounds of this length
    /// instead of waking up for each datagram.
    void listen_in_rounds(std::chrono::microseconds round);

    /// Asks next() to return nothing; from any thread (a signal watcher).
    void request_stop();
    /// Ends the run for this process with an error that next() or done() returns.
    void fail_with(Error error);
    [[nodiscard]] std::optional<Error> failure() const;
    /// Real time, after the final tick: what the simulator says to have sent and has not come, topic by topic
    /// ("3 of 9601 samples of 'TL_21' from sim"). Empty: nothing, or the end has not come.
    [[nodiscard]] std::string missing_of_simulator() const;
    /// Those expected writers of what is read here that are matched, and leave by themselves after the end: the
    /// simulator and its members.
    [[nodiscard]] std::vector<std::string> writers_here() const;
    [[nodiscard]] bool stop_is_requested() const;

    [[nodiscard]] NodeConfig const& config() const;
    [[nodiscard]] TimeBase const& time_base() const;
    [[nodiscard]] bool lockstep() const;
    /// Lockstep: `t` belongs to a tick before this one, in which a process that was there has worked. Real time: never.
    [[nodiscard]] bool is_over(SimTime t, Tick const& tick) const;
    /// Lockstep: everything of simulated time `t` that is read here has come. Real time: nobody knows.
    [[nodiscard]] bool has_come(SimTime t) const;
    /// The instant at which output to an input of `input` takes effect: a latency later in lockstep, now in real time.
    [[nodiscard]] SimTime effect_time(SimTime input, SimSpan latency) const;
    /// The simulator writes this topic. In lockstep its samples wake nobody: who must answer them in the tick in which
    /// they are there asks for every tick.
    [[nodiscard]] bool is_of_simulator(std::string const& topic) const;
    [[nodiscard]] SimTime latest_time() const; ///< of the newest clock sample
    /// Whether simulated time is known: in real time two clock samples have come, because the first may be an old one
    /// that was kept. Without a simulator always.
    [[nodiscard]] bool clock_runs() const;
    /// Real time: CLOCK_REALTIME of the simulator at simulated time 0; 0 until a clock sample has come, and in
    /// lockstep. Without a simulator the epoch.
    [[nodiscard]] std::int64_t start_unix_ns() const;

    struct Counters {
        std::uint64_t foreign_samples{0}; ///< from processes that are not of the run: dropped in lockstep
        std::uint64_t refused_writes{0};  ///< DDS did not take a sample (real time; in lockstep that ends the run)
        std::uint64_t foreign_frames{0};  ///< raw frames that no process of the run has announced: dropped in lockstep
        std::uint64_t lost_samples{0};    ///< gaps in a writer's sequence (real time; in lockstep that ends the run)
    };
    [[nodiscard]] Counters counters() const;
    /// Lockstep: the frames of `foreign_frames`, by the links and ethertypes that this process reads.
    struct ForeignOnLink {
        std::string link;
        std::uint16_t ethertype{0};
        lockstep::ForeignFrames frames;
        std::uint64_t not_fetched{0}; ///< from others' addresses, of any ethertype of the port; see WireReader
    };
    [[nodiscard]] std::vector<ForeignOnLink> foreign_frames_by_link() const;
    /// Samples of somebody who is not the process of the run whose name he bears, by that name. Not obeyed.
    [[nodiscard]] std::map<std::string, std::uint64_t> impostor_samples() const;
    /// Of both participants; Participant::refused_datagrams.
    [[nodiscard]] std::string refused_datagrams() const;

    struct Core; ///< shared with readers, writers and the clock server

  private:
    friend class ClockServer;
    friend class SignalPublisher;
    [[nodiscard]] std::weak_ptr<void>& signal_writers(); ///< of the process's SignalPublishers
    friend class WireReader;
    friend class WireWriter;
    [[nodiscard]] Core& core() { return *core_; }
    explicit Node(std::unique_ptr<Core> core);
    [[nodiscard]] Result<std::unique_ptr<RawWriter>> open_writer(std::string const& topic, Codec const& codec,
                                                                 std::size_t& slot);
    [[nodiscard]] Result<void> open_reader(std::string const& topic, Codec const& codec, std::shared_ptr<Inbox> inbox);

    std::unique_ptr<Core> core_;
};

/// Counts and stamps what is written; type-erased part of Writer<T>.
class CountedWriter {
  public:
    CountedWriter(Node::Core& core, std::unique_ptr<RawWriter> raw, std::size_t slot);
    ~CountedWriter();

  protected:
    void write_at(void const* sample, SimTime at);
    void write_cdr_at(std::span<std::byte const> cdr, SimTime at, KeyHash const* key_hash = nullptr);

  private:
    void count(bool accepted);
    Node::Core& core_;
    std::size_t slot_;
    RawWriter* raw_;
};

template <class T>
class Writer : private CountedWriter {
  public:
    using CountedWriter::CountedWriter;
    /// Sends a sample that takes effect at `at`. Lockstep readers see it in the tick that contains `at`.
    void write(T const& sample, SimTime at) { write_at(&sample, at); }
};

/// Samples of any type, as CDR.
class CdrWriter : private CountedWriter {
  public:
    using CountedWriter::CountedWriter;
    /// `key_hash`: of the sample's instance, when the type is keyed.
    void write(std::span<std::byte const> cdr, SimTime at, KeyHash const* key_hash = nullptr) {
        write_cdr_at(cdr, at, key_hash);
    }
};

template <class T>
Result<std::unique_ptr<Writer<T>>> Node::writer(std::string const& topic) {
    std::size_t slot = 0;
    auto raw = open_writer(topic, codec_of<T>(), slot);
    if (!raw) {
        return std::unexpected{raw.error()};
    }
    return std::make_unique<Writer<T>>(*core_, std::move(*raw), slot);
}

template <class T>
Result<std::shared_ptr<Reader<T>>> Node::reader(std::string const& topic) {
    auto reader = std::make_shared<Reader<T>>();
    if (auto opened = open_reader(topic, codec_of<T>(), reader); !opened) {
        return std::unexpected{opened.error()};
    }
    return reader;
}

} // namespace gridspace::bus
