// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The start of a node, until everybody is matched: READY.
#include "bus/node.hpp"
#include "bus/node_core.hpp"
#include "bus/start_patience.hpp"
#include "bus/topics.hpp"
#include "common/log.hpp"
#include "common/privileges/call_filter.hpp"
#include "common/privileges/capabilities.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <catalog.h>
#include <fmt/format.h>
#include <set>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace gridspace::bus {
namespace {

/// What is expected of one endpoint, in addition to what the configuration lists.
void expect(ExpectedPeers& peers, char const* topic, std::string const& process) {
    peers[topic].try_emplace(process, 1);
}

/// How far the discovery of an endpoint has come.
std::string how_far(Participant const& network, std::string const& topic, bool writer, std::string const& process) {
    auto const is_it = [&](Peer const& peer) { return peer.process == process; };
    if (std::ranges::any_of(network.known_on(topic, writer), is_it)) {
        return " (discovered, not matched)";
    }
    auto const here = network.here();
    bool const has_come = std::ranges::any_of(here, [&](std::uint32_t index) { return is_it(network.peer(index)); });
    return has_come ? " (not discovered, though its participant is)" : " (its participant is not discovered)";
}

struct Incarnation {
    std::uint32_t number{0};
    std::int64_t endpoints{0};
};

/// The newest incarnation of each process among `matched`.
std::unordered_map<std::string_view, Incarnation> newest_of(std::vector<Peer> const& matched) {
    std::unordered_map<std::string_view, Incarnation> out;
    for (Peer const& peer : matched) {
        Incarnation& newest = out[peer.process];
        if (peer.incarnation > newest.number) {
            newest = {peer.incarnation, 0};
        }
        newest.endpoints += peer.incarnation == newest.number ? 1 : 0;
    }
    return out;
}

/// For each expected process: are so many endpoints of its newest incarnation matched?
void check_matches(Participant const& network, bool writers, std::string const& topic,
                   std::map<std::string, std::int64_t> const& expected, std::vector<Peer> const& matched,
                   std::map<std::string, std::uint32_t>& newest, std::set<std::string>& lacking,
                   std::set<std::string> const& absent, Lookout& lookout) {
    constexpr std::size_t kLongest = 160; // of what is said to be missing
    std::string& missing = lookout.missing;
    auto const here = newest_of(matched);
    for (auto const& [process, count] : expected) {
        if (absent.contains(process)) {
            continue;
        }
        auto const found = here.find(process);
        auto const [incarnation, endpoints] = found == here.end() ? Incarnation{} : found->second;
        lookout.present += static_cast<std::size_t>(std::min(endpoints, count));
        auto const [it, added] = newest.try_emplace(process, incarnation);
        if (endpoints < count) {
            lacking.insert(process);
            if (missing.size() >= kLongest) {
                continue;
            }
            std::string const lack =
                fmt::format("{} of {} {}(s) of '{}' in {}{}", count - endpoints, count, writers ? "writer" : "reader",
                            topic, process, lookout.says_why ? how_far(network, topic, writers, process) : "");
            if (missing.find(lack) == std::string::npos) { // several writers may lack the same reader
                missing += (missing.empty() ? "" : ", ") + lack;
            }
        } else if (!added) {
            if (it->second != incarnation) { // some endpoints still know the old incarnation only
                lacking.insert(process);
                missing += fmt::format("{}the restarted {}", missing.empty() ? "" : ", ", process);
            }
            it->second = std::max(it->second, incarnation);
        }
    }
}

} // namespace

std::vector<Peer> Node::Core::matched_peers(Lookout& lookout) {
    std::map<std::string, std::uint32_t> newest;
    std::set<std::string> lacking;
    auto const look = [&](Participant const& network, bool of_writers, std::string const& topic,
                          std::vector<Peer> const& matched) {
        ExpectedPeers const& all = of_writers ? config.expected_writers : config.expected_readers;
        if (auto const it = all.find(topic); it != all.end()) {
            check_matches(network, of_writers, topic, it->second, matched, newest, lacking, absent, lookout);
        }
    };
    for (auto const& reader : readers) {
        look(*reader->network, true, reader->topic, reader->raw->matched());
    }
    // Several writers of one topic: each must be matched with every expected reader.
    for (WriterSlot const& writer : writers) {
        if (writer.raw != nullptr) {
            look(network_of(writer.topic), false, writer.topic, writer.raw->matched());
        }
    }
    if (clock_reader != nullptr) {
        look(*management, true, "simulation_clock", clock_reader->matched());
    }
    if (ack_reader != nullptr) {
        look(*management, true, "clock_ack", ack_reader->matched());
    }
    if (ack_writer != nullptr) {
        look(*management, false, "clock_ack", ack_writer->matched());
    }
    std::vector<Peer> out;
    for (auto const& [process, incarnation] : newest) {
        if (!lacking.contains(process)) {
            out.push_back({process, incarnation, ""});
        }
    }
    return out;
}

std::string Node::Core::refresh_status(MemberState state_when_incomplete) {
    {
        std::lock_guard const lock{mutex};
        matches_published = matches_generation;
    }
    Lookout lookout;
    lookout.says_why = start_is_slow;
    auto const began = std::chrono::steady_clock::now();
    std::vector<Peer> const matched = matched_peers(lookout);
    look_lasted = std::chrono::steady_clock::now() - began;
    std::string& missing = lookout.missing;
    endpoints_present = lookout.present;
    if (missing.empty() && is_late_joiner()) {
        std::lock_guard const lock{mutex};
        missing = joining ? missing_ledgers() : "";
    }
    MemberState const state = missing.empty() ? MEMBER_READY : state_when_incomplete;
    if (state == MEMBER_READY) {
        std::lock_guard const lock{mutex};
        if (std::exchange(joining, false)) { // before anybody hears of it: the clock may come at once
            for (std::size_t const place : board_heard) {
                if (is_late_joiner()) {
                    board->skip(place);
                }
            }
            settle_rosters();
        }
    }
    if (matched == status_matched && missing == status_missing) {
        return missing;
    }
    status_matched = matched;
    status_missing = missing;
    publish_status(state, missing);
    return missing;
}

void Node::Core::publish_status(MemberState state, std::string_view waiting_for) {
    MemberStatus status;
    status.process(config.process.c_str());
    status.incarnation(static_cast<std::uint32_t>(config.incarnation));
    status.state(state);
    for (Peer const& peer : status_matched) {
        MatchedPeer entry;
        entry.process(peer.process.c_str());
        entry.incarnation(peer.incarnation);
        status.matched().push_back(entry);
    }
    status.waiting_for(std::string{waiting_for.substr(0, 255)}.c_str());
    status_writer->write(&status, std::nullopt);
}

void Node::Core::open_books() {
    std::vector<std::string> processes = config.clock.members;
    processes.push_back(config.clock.simulator);
    for (auto const& [topic, peers] : config.expected_writers) {
        for (auto const& [process, count] : peers) {
            processes.push_back(process);
        }
    }
    std::sort(processes.begin(), processes.end());
    processes.erase(std::unique(processes.begin(), processes.end()), processes.end());
    std::vector<std::string> topics;
    for (auto const& reader : readers) {
        topics.push_back(reader->topic);
    }
    book = std::make_unique<lockstep::LedgerBook>(processes, topics);
    std::vector<lockstep::WireBook::Channel> channels;
    for (auto const& reader : wire_readers) {
        reader->channel = channels.size();
        channels.push_back({reader->link, reader->ethertype});
    }
    {
        std::lock_guard const lock{mutex}; // frames arrive already
        wire_book = std::make_unique<lockstep::WireBook>(processes.size(), channels);
    }
    gate = std::make_unique<lockstep::TickGate>(lockstep::TickGate::Config{config.process, config.clock.simulator,
                                                                           config.clock.members, config.clock.upstream,
                                                                           config.clock.late_upstream},
                                                *book, wire_book.get());
    ack.member(config.process.c_str());
    ack.incarnation(static_cast<std::uint32_t>(config.incarnation));
}

Result<void> Node::Core::open_clock() {
    if (!is_simulator() && has_clock()) {
        expect(config.expected_writers, "simulation_clock", config.clock.simulator);
        auto reader = management->create_reader("simulation_clock", codec_of<SimClock>(),
                                                [this](auto cdr, auto const& header) { on_clock_sample(cdr, header); });
        if (!reader) {
            return std::unexpected{reader.error()};
        }
        clock_reader = std::move(*reader);
    }
    if (lockstep()) {
        std::vector<std::string> const& heard = is_simulator() ? config.clock.members : config.clock.upstream;
        if (!heard.empty()) {
            for (std::string const& process : heard) {
                expect(config.expected_writers, "clock_ack", process);
            }
            auto reader =
                management->create_reader("clock_ack", codec_of<ClockAck>(),
                                          [this](auto cdr, auto const& header) { on_ack_sample(cdr, header); });
            if (!reader) {
                return std::unexpected{reader.error()};
            }
            ack_reader = std::move(*reader);
        }
        if (!is_simulator()) {
            expect(config.expected_readers, "clock_ack", config.clock.simulator);
            for (std::string const& process : config.clock.downstream) {
                expect(config.expected_readers, "clock_ack", process);
            }
        }
    }
    return {};
}

Result<void> Node::Core::open_readers() {
    for (auto& slot : readers) {
        slot->book_reader = static_cast<std::size_t>(&slot - readers.data());
        auto* raw_slot = slot.get();
        Participant& network = network_of(slot->topic);
        slot->network = &network;
        auto reader = network.create_reader(slot->topic, slot->codec, [this, raw_slot](auto cdr, auto const& header) {
            on_data_sample(*raw_slot, cdr, header);
        });
        if (!reader) {
            return std::unexpected{reader.error()};
        }
        slot->raw = std::move(*reader);
    }
    return {};
}

void Node::Core::publish_types() {
    std::sort(catalogued_types.begin(), catalogued_types.end());
    catalogued_types.erase(std::unique(catalogued_types.begin(), catalogued_types.end()), catalogued_types.end());
    for (std::string const& type : catalogued_types) {
        if (std::string_view const idl = idl_of_type(type); !idl.empty()) {
            TypeCatalogEntry entry;
            entry.type_name(type.c_str());
            entry.idl(std::string{idl});
            catalog_writer->write(&entry, std::nullopt);
        }
    }
}

Result<void> Node::start() {
    Core& core = *core_;
    if (core.config.is_daemon && !may_open_raw_sockets()) {
        (void)forbid_raw_sockets();
    }
    if (auto ok = core.join_board(); !ok) {
        return ok;
    }
    core.open_books();
    if (auto ok = core.open_clock(); !ok) {
        return ok;
    }
    if (auto ok = core.open_readers(); !ok) {
        return ok;
    }
    core.publish_types();
    if (auto ok = core.await_others(); !ok) {
        return ok;
    }
    if (core.on_ready) {
        core.on_ready();
    }
    return {};
}

void Node::on_ready(std::function<void()> callback) {
    core_->on_ready = std::move(callback);
}

Result<void> Node::Core::await_others() {
    // Twice the simulator's own patience, so that it can name the culprit while the others are still there.
    double const patience_s = (is_simulator() || !has_clock() ? 1 : 2) * config.clock.start_timeout_s;
    StartPatience patience{patience_s};
    auto const began = std::chrono::steady_clock::now();
    bool said = false;
    while (true) {
        std::string const missing = refresh_status(MEMBER_STARTING);
        bool const ready = missing.empty();
        if (has_namesake()) {
            return gridspace::fail(
                ExitCode::environment, fmt::format("another '{}' is already on this bus", config.process),
                "two programs of one name in a run (a service, and a start by hand?), or another run on this "
                "network and DDS domain");
        }
        std::unique_lock lock{mutex};
        if (ready) {
            return error ? Result<void>{std::unexpected{*error}} : Result<void>{};
        }
        if (error) {
            return std::unexpected{*error};
        }
        if (stop_requested) {
            return gridspace::fail(ExitCode::interrupted, "stopped while waiting for the others");
        }
        if (patience.over(endpoints_present + (others_present ? others_present() : 0))) {
            std::string const who = who_is_missing ? who_is_missing() : "";
            return gridspace::fail(ExitCode::stall,
                                   fmt::format("not ready, and nothing has advanced for {} s: {}", shortest(patience_s),
                                               who.empty() ? "still unmatched " + missing : who),
                                   "is that process running, and on the same network and DDS domain?");
        }
        bool const slow = std::chrono::steady_clock::now() - began > std::chrono::seconds{3};
        if (std::exchange(start_is_slow, slow) && !std::exchange(said, true)) { // `missing` says why
            log::info("waits for {}", missing);
        }
        wait_for_matches(lock);
    }
}

void Node::Core::wait_for_matches(std::unique_lock<std::mutex>& lock) {
    constexpr std::chrono::milliseconds kLongest{100};
    if (look_lasted > std::chrono::milliseconds{1}) {
        changed.wait_for(lock, std::min<std::chrono::steady_clock::duration>(4 * look_lasted, kLongest),
                         [this] { return error || stop_requested; });
    }
    if (matches_published == matches_generation) {
        changed.wait_for(lock, kLongest);
    }
}

} // namespace gridspace::bus
