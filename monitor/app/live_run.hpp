// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/discovery.hpp"
#include "monitor/app/intrusion_view.hpp"
#include "monitor/app/run_plan.hpp"
#include "monitor/graph/graph_model.hpp"
#include "monitor/stream/signal_window.hpp"

#include <chrono>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace gridspace::monitor {

/// A sample as it came.
struct RawSample {
    std::vector<std::byte> cdr;
    std::string process;
    std::int64_t source_ns{0};
    std::uint64_t number{0}; ///< counts the samples of its topic
};

/// What has been seen of a topic.
struct TopicState {
    std::string network, topic, type;
    std::uint64_t samples{0}, octets{0};
    double per_second{0}; ///< wall clock, over the last second or so
    std::uint64_t samples_then{0};
    std::size_t newest_octets{0}; ///< of the next
    std::uint64_t checked{0};     ///< number of the newest sample that was decoded to see whether it can be
    std::deque<RawSample> newest; ///< the last few, so that each key of a keyed topic is likely among them
};

struct RunClock {
    bool seen{false};
    std::uint64_t tick{0};
    double time_s{0};
    std::string state{"waiting"}; ///< waiting, running, final, aborted; loading, recorded
    bool paused{false};           ///< somebody has asked the running simulator to wait
    double factor{0};             ///< simulated seconds per second of wall clock, lately
};

struct Acknowledged {
    std::uint64_t tick{0};
    std::uint32_t incarnation{0};
};

/// What a process uses of the machine.
struct ProcessUse {
    double cpu_s{0};                            ///< processor time so far
    std::optional<double> cpu_percent;          ///< lately, of one processor; not known at its beginning
    std::optional<std::uint64_t> memory_octets; ///< resident
};

/// What a device has counted of one of its streams of raw frames, as it says itself (idl/statistics.idl).
struct StreamEnd {
    bool sends{false};
    std::string state; ///< waiting, alive, lost
    std::uint64_t frames{0}, lost{0}, duplicate{0}, late{0}, refused{0}, silences{0}, dropped{0};
    double time_s{0}, rate_hz{0};
};

/// A line of the run's event log.
struct RunEvent {
    std::uint64_t number{0};
    double time_s{0};
    std::string source, event, text;
};

/// Everything that is known about the run at this moment. Threads of DDS write, the web reads: whoever touches a member
/// holds `mutex`, briefly. Memory is bounded, however long the run.
struct LiveRun {
    explicit LiveRun(RunPlan run_plan);

    RunPlan const plan;
    std::chrono::steady_clock::time_point const started{std::chrono::steady_clock::now()};

    mutable std::mutex mutex;
    graph::GraphModel graph;
    bool recorded{false};                          ///< a finished run
    std::optional<graph::Snapshot> recorded_graph; ///< of a recorded run: as its monitor saw it
    RunClock clock;
    std::map<std::pair<std::string, std::string>, TopicState> topics;     ///< by (network, topic)
    std::map<std::string, std::string> idl;                               ///< by type name
    std::map<std::string, Acknowledged> acknowledged;                     ///< by process
    std::map<std::pair<std::string, std::string>, StreamEnd> stream_ends; ///< by (stream, process)
    std::map<std::string, ProcessUse> use;                                ///< by process, of those on this machine
    std::map<std::pair<std::string, std::string>, std::unique_ptr<stream::SignalWindow>>
        signals; ///< by (source, group)
    std::deque<RunEvent> events;
    std::uint64_t events_seen{0};
    std::uint64_t undecodable{0}; ///< samples that were not what their type says; of IDL's types only `measure` looks

    void on_sample(std::string const& network, std::string const& topic, std::string const& type, std::string process,
                   std::span<std::byte const> cdr, std::int64_t source_ns);
    /// The graph as it is, or as it was recorded. Mutex held, as long as it is looked at.
    [[nodiscard]] graph::Snapshot const& snapshot() const;
    /// Rates and pace; about twice a second, with the mutex not held.
    void measure(std::chrono::duration<double> since_last);
    void add_event(RunEvent event); ///< mutex held
    /// There is no room for more of these: said once. Mutex held.
    void full(std::string const& what, std::size_t limit);
    /// As an event and in the log, when it has not been said yet. Mutex held.
    void tell_once(std::string const& event, std::string const& text);
    /// Says of each writer that is not heard why, once; with the mutex not held.
    void tell_not_heard();
    /// The window that has the signal, and its column. Mutex held.
    [[nodiscard]] std::pair<stream::SignalWindow const*, std::size_t> find_signal(std::string const& name) const;

  private:
    void decode(std::string const& topic, std::string const& type, std::string const& process,
                std::span<std::byte const> cdr);
    // By topic; false: it cannot be decoded.
    bool take_clock(std::string const& process, std::span<std::byte const> cdr);
    bool take_acknowledgement(std::string const& process, std::span<std::byte const> cdr);
    bool take_type(std::span<std::byte const> cdr);
    bool take_columns(std::span<std::byte const> cdr);
    bool take_signals(std::span<std::byte const> cdr);
    bool take_stream_end(std::span<std::byte const> cdr);
    void reach(std::int64_t time_ns, std::uint64_t tick);
    mutable std::optional<graph::Snapshot> snapshot_; ///< of the newest revision that somebody has asked for
    IntrusionView intrusion_;
    std::set<std::string> reported_;                   ///< once
    std::set<std::string> unheard_, reported_unheard_; ///< when it was last looked at, and ever
    std::string clock_process_;                        ///< who publishes the clock
    /// Values of the past of signals; the first rows of each group come on top.
    std::shared_ptr<std::size_t> values_left_{std::make_shared<std::size_t>(128'000'000)};
    std::size_t newest_octets_{0}; ///< of the newest samples of all topics
    double time_then_s_{0};
};

} // namespace gridspace::monitor
