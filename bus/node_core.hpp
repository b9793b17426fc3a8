// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/board/board.hpp"
#include "bus/clock_watch.hpp"
#include "bus/lockstep/ledger_book.hpp"
#include "bus/lockstep/roster.hpp"
#include "bus/lockstep/tick_gate.hpp"
#include "bus/lockstep/wire_book.hpp"
#include "bus/node.hpp"
#include "bus/receiving.hpp"
#include "bus/sample_stamp.hpp"
#include "bus/send_together.hpp"
#include "bus/wire_impl.hpp"

#include <atomic>
#include <clock.h>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

namespace gridspace::bus {

/// What is expected of others at the start: the text of what is still missing, and how many endpoints are there.
struct Lookout {
    std::string missing;
    std::size_t present{0};
    bool says_why{false}; ///< what of each that is missing has been discovered
};

/// The inside of a Node, shared by its parts. `mutex` guards everything below it; receiving threads take it briefly.
struct Node::Core {
    NodeConfig config;
    TimeBase base;
    SimSpan tick_span;
    SimSpan beyond;                  ///< so much later than the clock's end the ticks of this process
    SimTime worked_until{INT64_MIN}; ///< the end of the newest tick, or part of one, that was given out
    std::int64_t epoch_ns{0};

    std::unique_ptr<Participant> management;
    std::unique_ptr<Participant> data; ///< null: everything is on management

    struct WriterSlot {
        std::string topic;
        bool diagnostic{false};
        std::unique_ptr<RawWriter> raw; ///< null when the Writer is gone; the count stays in the ledger
        std::uint64_t sent{0};
    };
    std::vector<WriterSlot> writers; ///< fixed once the node has started

    struct ReaderSlot {
        std::string topic;
        bool diagnostic{false}; ///< in no ledger
        Codec codec;
        std::shared_ptr<Inbox> inbox;
        std::size_t book_reader{0};
        std::unique_ptr<RawReader> raw;
        Participant const* network{nullptr};
        struct Source { ///< who a writer of the topic belongs to; looked up once per writer
            bool known{false};
            std::size_t process{0};
            std::uint32_t incarnation{0};
            std::string name;
            bool unexpected{false};  ///< lockstep: the scenario does not say that it writes this topic
            std::size_t stranger{0}; ///< real time: its number among those who are not of this run
        };
        std::vector<Source> sources;     ///< by SampleHeader::source; one receiving thread at a time
        bool undecodable_is_said{false}; ///< of a stranger's sample
    };
    std::vector<std::unique_ptr<ReaderSlot>> readers; ///< opened in start(), when the book knows all topics

    std::vector<std::string> strangers; ///< real time: who has written and is not of this run, each once
    [[nodiscard]] std::size_t stranger_number(std::string const& name); ///< past the end for one too many

    std::weak_ptr<void> signal_writers;
    std::vector<WireLedgerEntry> wire_writers;                   ///< what goes into the next acknowledgement
    std::vector<std::shared_ptr<WireReader::Impl>> wire_readers; ///< their order numbers the book's channels

    std::vector<std::function<void()>> fetch_frames, flush_frames;
    std::chrono::microseconds round{0}; ///< 0: everything is taken as it comes
    std::uint64_t acknowledged{0};      ///< the newest tick that this process has acknowledged
    /// Whether it may sleep for a round: nothing is asked of it, and nothing will be for some ticks. Under the mutex.
    [[nodiscard]] bool may_sleep() const {
        constexpr std::uint64_t kSoon = 3;
        return round.count() > 0 && !joining && clock_seen && !gate->has_pending() &&
               gate->latest_tick() + kSoon < acknowledged + static_cast<std::uint64_t>(config.clock.max_lag_ticks);
    }

    std::unique_ptr<RawWriter> status_writer;
    std::unique_ptr<RawWriter> ack_writer;
    std::unique_ptr<RawWriter> catalog_writer;
    std::unique_ptr<RawReader> clock_reader;
    std::unique_ptr<RawReader> ack_reader;
    std::vector<std::optional<Peer>> clock_sources, ack_sources; ///< by SampleHeader::source; one receiving thread each
    std::map<Participant const*, lockstep::Roster> rosters;      ///< of management and data; under the mutex
    std::map<std::string, std::uint64_t> impostor_samples;       ///< by the process that they claimed; under the mutex
    std::vector<std::string> catalogued_types;
    ClockAck ack; ///< reused for every acknowledgement

    mutable std::mutex mutex;
    std::condition_variable changed;
    /// Something has changed: wakes the process's own thread. Under the mutex.
    void notify() {
        changed.notify_all();
        if (board != nullptr && worker != std::this_thread::get_id()) {
            board->wake(board->self());
        }
        Receiving::of_process().wake();
    }
    /// Lockstep, among the members of one machine: clocks and acknowledgements go over it, and over DDS only now and
    /// then, for who looks on.
    std::unique_ptr<Board> board;
    std::atomic<std::thread::id> worker{};            ///< the process's own thread
    std::optional<SendTogether> together;             ///< from the beginning of a tick to its acknowledgement
    std::vector<std::size_t> board_heard, board_rung; ///< places that this process reads, and whose bells it rings
    std::size_t board_simulator{0};                   ///< the simulator's place
    std::chrono::steady_clock::time_point shown_at;   ///< when DDS last got what the board has
    std::chrono::steady_clock::time_point looked_at;  ///< when the network was last looked at although the board spoke
    Result<void> join_board();
    void open_books();                         ///< who and what is counted: processes, topics, channels of frames
    [[nodiscard]] Result<void> open_clock();   ///< the clock's own endpoints, and what they are to be matched with
    [[nodiscard]] Result<void> open_readers(); ///< of the topics
    void publish_types();                      ///< IDL of the types that this process uses
    [[nodiscard]] Result<void> await_others(); ///< until everybody who is expected is matched
    /// Takes what has been said on the board; whether there was anything. Without the mutex.
    [[nodiscard]] bool take_board();
    /// Says something on it. False: it is too long.
    template <class T>
    [[nodiscard]] bool post(T const& message, std::int64_t time_ns, std::uint64_t number);
    std::vector<std::byte> posted; ///< reused
    /// Whether DDS gets it too: somebody who looks on wants to see how far the run is.
    [[nodiscard]] bool show_to_others(bool always);
    [[nodiscard]] Result<void> join_networks();
    void watch_networks(); ///< for who comes and who goes
    void on_departure(std::uint32_t index, bool clean);
    [[nodiscard]] Result<void> open_own_writers();
    /// Lockstep, after the last tick, which everybody has acknowledged: nobody needs anything again but who looks on.
    void leave_at_once_unless_watched() const;
    /// Until something may have changed: `samples_only`, when nothing but what comes over the network is missing.
    void wait_for_more(Receiving::Turn& turn, std::unique_lock<std::mutex>& lock, std::chrono::nanoseconds longest,
                       bool samples_only);
    std::shared_ptr<CdrReader> clock_tap; ///< a recorder's copy of the clock
    std::shared_ptr<CdrReader> ack_tap;   ///< and of the acknowledgements
    std::vector<std::shared_ptr<Inbox>> taps;
    std::unique_ptr<lockstep::LedgerBook> book;
    std::unique_ptr<lockstep::WireBook> wire_book;
    std::vector<lockstep::WireBook::Record> wire_records; ///< reused
    std::unique_ptr<lockstep::TickGate> gate;
    bool joining{true}; ///< until READY; a late joiner takes ledgers as baselines meanwhile
    struct Joining {    ///< the tick after which this incarnation joins
        std::uint64_t tick;
        std::vector<std::uint8_t> awaited; ///< members whose ledgers are to come
    };
    std::optional<Joining> held;
    std::map<std::string, std::uint64_t> ledgers_of; ///< while joining: newest acknowledged tick by process
    bool restate_ledger{false};                      ///< a held clock asks for it
    std::set<std::string> absent;                    ///< expected peers that the run goes on without
    bool stop_requested{false};
    bool final_done{false};
    bool simulator_left{false}; ///< its participant is gone
    std::optional<Error> error;
    SimClock clock; ///< newest, decoded in place
    bool clock_seen{false};
    std::uint64_t clock_generation{0};
    std::uint64_t clock_taken{0}; ///< what next() has returned for, in real time
    std::uint64_t input_generation{0};
    std::uint64_t input_taken{0};
    SimTime latest_time;
    /// Real time: the clock is not published at every tick; between its samples time goes on at the pace of the run so
    /// far.
    struct Pace {
        std::chrono::steady_clock::time_point first_arrived, last_arrived;
        std::int64_t first_sent_ns{0}, last_sent_ns{0}; ///< who joins late gets many at once
        SimTime first;
    } pace;
    mutable SimTime newest_now{INT64_MIN}; ///< time_now() never goes back
    [[nodiscard]] SimTime time_now() const;
    ClockWatch clock_watch;                              ///< real time
    void watch_clock();                                  ///< fails when this machine's clock was set. Under the mutex.
    std::chrono::steady_clock::time_point pending_since; ///< when the clock of the pending tick came
    std::uint64_t matches_generation{0};                 ///< counts discoveries, matches and departures
    std::uint64_t matches_published{0};
    std::vector<std::pair<std::size_t, ClockAck>> late_acks; ///< of the newest tick, by members that are late
    std::function<void(ClockAck const&)> on_ack;             ///< of the clock server; under the mutex
    std::function<bool()> server_waits_no_more;              ///< of the clock server; under the mutex
    std::function<void()> on_ready;                          ///< of start()
    std::function<std::string()> who_is_missing;             ///< of the clock server, at the start; under the mutex
    std::function<std::size_t()> others_present; ///< of the clock server: how far the others have come; under the mutex

    std::atomic<std::uint64_t> foreign_samples{0};
    std::atomic<std::uint64_t> refused_writes{0};
    std::atomic<std::uint64_t> lost_samples{0};

    /// Somebody else is here under the name of this process.
    [[nodiscard]] bool has_namesake() const {
        bool const data_is_here = config.data && config.data->domain == config.management.domain;
        return !data_is_here && management->hears({config.process, static_cast<std::uint32_t>(config.incarnation), ""});
    }
    [[nodiscard]] bool is_simulator() const { return config.process == config.clock.simulator; }
    [[nodiscard]] bool has_clock() const { return !config.clock.simulator.empty(); } ///< otherwise time is UTC
    [[nodiscard]] bool lockstep() const { return config.clock.mode == ClockMode::lockstep; }
    [[nodiscard]] Participant& network_of(std::string const& topic);
    [[nodiscard]] std::int64_t source_ns(SimTime at) const { return epoch_ns + base.nanoseconds(at); }
    /// The simulated time that a sample of lockstep carries.
    [[nodiscard]] SimTime time_of(SampleHeader const& header) const {
        return base.from_nanoseconds(stamp_after(header.source_ns, epoch_ns));
    }

    struct TickWait;
    [[nodiscard]] Result<std::optional<Tick>> next_in_lockstep(std::unique_lock<std::mutex>& lock);
    [[nodiscard]] Result<std::optional<Tick>>
    next_in_real_time(std::unique_lock<std::mutex>& lock,
                      std::optional<std::chrono::steady_clock::time_point> deadline);
    /// Where the granted tick ends for this process, or its next part: parts end with each whole second, so that what
    /// is said once a second is said then, wherever the ticks end. Under the mutex.
    [[nodiscard]] Tick next_part(lockstep::TickGate::Grant const& grant);

    void fail(Error why); ///< takes the mutex
    void fail_locked(Error why);

    void on_clock_sample(std::span<std::byte const> cdr, SampleHeader const& header);
    /// A clock sample of the simulator, however it came; it is in `clock`. Under the mutex.
    void take_clock(std::span<std::byte const> cdr, SampleHeader const& header);
    /// Who wrote a sample of the management network; looked up once per writer.
    Peer const& writer_of(std::vector<std::optional<Peer>>& sources, SampleHeader const& header) const;
    /// Whether what came from a participant under the name of a process of the run is obeyed. Under the mutex.
    [[nodiscard]] bool is_from_member(Participant const& network, std::uint32_t peer, std::string const& process,
                                      std::uint32_t incarnation);
    /// Everybody is READY: who is here now is who he says. Under the mutex.
    void settle_rosters();
    /// Whether the clock counts as this process was configured to. Under the mutex.
    [[nodiscard]] bool clock_fits(SampleHeader const& header);
    void show_clock(std::span<std::byte const> cdr, SampleHeader const& header); ///< to the tap
    void take_tick();     ///< of a running clock in lockstep; under the mutex
    void on_held_clock(); ///< under the mutex
    void on_ack_sample(std::span<std::byte const> cdr, SampleHeader const& header);
    void take_ack(std::span<std::byte const> cdr, SampleHeader const& header, std::size_t process,
                  ClockAck const& received); ///< under the mutex
    void on_data_sample(ReaderSlot& slot, std::span<std::byte const> cdr, SampleHeader const& header);
    /// Whose writer it is, looked up when its first sample comes.
    [[nodiscard]] ReaderSlot::Source const& source_of(ReaderSlot& slot, SampleHeader const& header);
    /// Counts a sample of a process of the run; false when it is not to be taken. Under the mutex.
    [[nodiscard]] bool count_sample(ReaderSlot const& slot, ReaderSlot::Source const& source,
                                    SampleHeader const& header, SimTime time);
    /// Takes a ledger (of an acknowledgement or a clock) into the book.
    template <class Ledger>
    void take_ledger(std::size_t process, std::uint32_t incarnation, Ledger const& ledger);
    void count_ack(std::size_t process, ClockAck const& received); ///< under the mutex
    void take_wire_ledger(std::size_t process, ClockAck const& received);
    void release_wires(SimTime until);
    /// Writes the counts of all topics into a ledger sequence, without allocating once it has grown.
    void fill_ledger(std::vector<LedgerEntry>& ledger) const;

    [[nodiscard]] bool is_late_joiner() const { return config.incarnation > 0 && lockstep() && !is_simulator(); }
    /// What a late joiner still needs to know before it can count: "the ledger of ev1". Under the mutex.
    [[nodiscard]] std::string missing_ledgers() const;
    /// Writes the acknowledgement of a tick with the present ledger. Only the process's own thread calls it.
    [[nodiscard]] bool acknowledge(std::uint64_t tick, std::uint64_t next_tick_needed, SimTime time);

    /// Peers with which everything expected is matched.
    [[nodiscard]] std::vector<Peer> matched_peers(Lookout& lookout);
    /// Looks at the matches and publishes member_status if they changed; returns what is missing. Only the process's
    /// own thread calls it.
    std::string refresh_status(MemberState state_when_incomplete);
    /// Until discovery notifies, or for 100 ms. Each of its changes calls for a look, and among hundreds of endpoints a
    /// look costs: looks take a fifth of the time at most, because discovery needs the processor.
    void wait_for_matches(std::unique_lock<std::mutex>& lock);
    void publish_status(MemberState state, std::string_view waiting_for);
    std::vector<Peer> status_matched;
    std::string status_missing{"-"};
    bool start_is_slow{false};                         ///< so what is missing is told with what of it is known
    std::chrono::steady_clock::duration look_lasted{}; ///< the last look at the matches
    std::size_t endpoints_present{0};                  ///< at the last look; the process's own thread's
};

} // namespace gridspace::bus
