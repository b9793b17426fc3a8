// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/node.hpp"

#include "bus/node_core.hpp"
#include "bus/topics.hpp"

#include <algorithm>
#include <catalog.h>
#include <fmt/format.h>

namespace gridspace::bus {

Participant& Node::Core::network_of(std::string const& topic) {
    bool const on_management = is_management_topic(topic) ||
                               std::find(config.management_topics.begin(), config.management_topics.end(), topic) !=
                                   config.management_topics.end();
    return on_management || data == nullptr ? *management : *data;
}

void Node::Core::fail(Error why) {
    std::lock_guard const lock{mutex};
    fail_locked(std::move(why));
}

void Node::Core::fail_locked(Error why) {
    if (!error) {
        error = std::move(why);
    }
    notify();
}

void Node::Core::fill_ledger(std::vector<LedgerEntry>& ledger) const {
    std::size_t used = 0;
    for (WriterSlot const& slot : writers) {
        if (slot.diagnostic) {
            continue;
        }
        auto const same = std::find_if(ledger.begin(), ledger.begin() + static_cast<std::ptrdiff_t>(used),
                                       [&](LedgerEntry const& e) { return slot.topic == e.topic().c_str(); });
        if (same != ledger.begin() + static_cast<std::ptrdiff_t>(used)) {
            same->sent(same->sent() + slot.sent);
            continue;
        }
        if (used == ledger.size()) {
            ledger.emplace_back();
            ledger.back().topic(slot.topic.c_str());
        }
        ledger[used++].sent(slot.sent);
    }
}

std::string Node::Core::missing_ledgers() const {
    if (!held) {
        return "the clock of the tick after which it joins";
    }
    std::string out;
    for (std::string const& name : config.clock.upstream) {
        std::vector<std::string> const& members = config.clock.members;
        auto const member = std::find(members.begin(), members.end(), name);
        bool const restates = member != members.end() &&
                              lockstep::bit_of(held->awaited, static_cast<std::size_t>(member - members.begin()));
        auto const newest = ledgers_of.find(name);
        if (restates && (newest == ledgers_of.end() || newest->second < held->tick)) {
            out += (out.empty() ? "the ledger of " : ", ") + name;
        }
    }
    return out;
}

void Node::Core::leave_at_once_unless_watched() const {
    for (Participant* const network : {management.get(), data.get()}) {
        auto const is_member = [&](std::uint32_t peer) {
            std::string const name = network->peer(peer).process;
            return name == config.process || name == config.clock.simulator ||
                   std::ranges::find(config.clock.members, name) != config.clock.members.end();
        };
        if (network != nullptr && std::ranges::all_of(network->here(), is_member)) {
            network->leave_at_once();
        }
    }
}

Result<void> Node::Core::join_networks() {
    auto const join = [&](char const* profile, NetworkConfig const& network) {
        return Participant::create({config.process, static_cast<std::uint32_t>(config.incarnation), config.program,
                                    static_cast<int>(network.domain), config.qos, profile, network.addresses,
                                    std::chrono::seconds{30}, network.peers});
    };
    auto joined_management = join("management", config.management);
    if (!joined_management) {
        return std::unexpected{joined_management.error()};
    }
    management = std::move(*joined_management);
    if (config.data) {
        auto joined_data = join("data", *config.data);
        if (!joined_data) {
            return std::unexpected{joined_data.error()};
        }
        data = std::move(*joined_data);
    }
    return {};
}

void Node::Core::on_departure(std::uint32_t index, bool clean) {
    bool const is_debugged = !clean && config.clock.member_timeout_s == 0; // without deadlines silence is no failure
    Peer const peer = management->peer(index);
    if (peer.process == config.clock.simulator && !is_simulator() && !is_debugged) {
        std::lock_guard const lock{mutex};
        if (!is_from_member(*management, index, peer.process, peer.incarnation)) {
            return;
        }
        if (!clean && !clock_seen) {
            return; // so many start at once that nobody hears it: who waits for it has a deadline, and says so
        }
        simulator_left = true;
        notify();
        bool const over = clock_seen && clock.state() == CLOCK_FINAL; // its work may not be done yet
        if (!over && !final_done && !stop_requested) {
            fail_locked({clean ? ExitCode::child_died : ExitCode::stall,
                         fmt::format("the simulator '{}' {}", peer.process,
                                     clean ? "has left the bus" : "is silent: its lease ran out"),
                         "its log says why"});
        }
    }
}

void Node::Core::watch_networks() {
    auto const tell = [this] {
        std::lock_guard const lock{mutex};
        ++matches_generation;
        notify();
    };
    management->on_change(tell);
    if (data) {
        data->on_change(tell);
    }
    management->on_departure([this](std::uint32_t index, bool clean) { on_departure(index, clean); });
}

Result<void> Node::Core::open_own_writers() {
    auto const writer = [&](char const* topic, Codec const& codec, std::unique_ptr<RawWriter>& out) -> Result<void> {
        auto opened = management->create_writer(topic, codec);
        if (!opened) {
            return std::unexpected{opened.error()};
        }
        out = std::move(*opened);
        return {};
    };
    if (auto ok = writer("member_status", codec_of<MemberStatus>(), status_writer); !ok) {
        return ok;
    }
    if (auto ok = writer("type_catalog", codec_of<TypeCatalogEntry>(), catalog_writer); !ok) {
        return ok;
    }
    if (lockstep() && !is_simulator()) {
        if (auto ok = writer("clock_ack", codec_of<ClockAck>(), ack_writer); !ok) {
            return ok;
        }
    }
    return {};
}

Result<std::unique_ptr<Node>> Node::create(NodeConfig config) {
    auto core = std::make_unique<Core>();
    core->config = std::move(config);
    NodeConfig const& c = core->config;
    core->base = TimeBase{c.clock.quantum_s};
    core->absent.insert(c.absent.begin(), c.absent.end());
    core->tick_span = core->base.nearest(c.clock.tick_s);
    core->beyond = core->base.nearest(c.clock.ahead_s);
    core->epoch_ns = c.clock.epoch_unix_s * 1'000'000'000;

    if (auto ok = core->join_networks(); !ok) {
        return std::unexpected{ok.error()};
    }
    core->watch_networks();
    if (auto ok = core->open_own_writers(); !ok) {
        return std::unexpected{ok.error()};
    }
    return std::unique_ptr<Node>{new Node{std::move(core)}};
}

Node::Node(std::unique_ptr<Core> core) : core_{std::move(core)} {}

Node::~Node() {
    core_->together.reset(); // the dispose must not stay behind: others would wait for the lease to run out
    // Endpoints first: their listeners use the core. An orderly end informs the others that this process is gone.
    core_->clock_reader.reset();
    core_->ack_reader.reset();
    for (auto& reader : core_->readers) {
        reader->raw.reset();
    }
    core_->management->on_change({});
    core_->management->on_departure({});
    if (core_->data) {
        core_->data->on_change({});
    }
}

std::weak_ptr<void>& Node::signal_writers() {
    return core_->signal_writers;
}

Result<std::unique_ptr<RawWriter>> Node::open_writer(std::string const& topic, Codec const& codec, std::size_t& slot) {
    auto raw = core_->network_of(topic).create_writer(topic, codec);
    if (!raw) {
        return raw;
    }
    slot = core_->writers.size();
    core_->writers.push_back({topic, is_diagnostic_topic(topic), nullptr, 0});
    core_->catalogued_types.emplace_back(codec.type_name);
    return raw;
}

Result<void> Node::open_reader(std::string const& topic, Codec const& codec, std::shared_ptr<Inbox> inbox) {
    auto slot = std::make_unique<Core::ReaderSlot>();
    slot->topic = topic;
    slot->diagnostic = is_diagnostic_topic(topic);
    slot->codec = codec;
    slot->inbox = std::move(inbox);
    if (!core_->lockstep()) {
        slot->inbox->release({INT64_MAX});
    }
    core_->catalogued_types.emplace_back(codec.type_name);
    core_->readers.push_back(std::move(slot));
    return {};
}

Result<std::shared_ptr<CdrReader>> Node::cdr_reader(std::string const& topic, Codec const& codec) {
    auto reader = std::make_shared<CdrReader>();
    if (auto opened = open_reader(topic, codec, reader); !opened) {
        return std::unexpected{opened.error()};
    }
    return reader;
}

Result<std::unique_ptr<CdrWriter>> Node::cdr_writer(std::string const& topic, Codec const& codec) {
    std::size_t slot = 0;
    auto raw = open_writer(topic, codec, slot);
    if (!raw) {
        return std::unexpected{raw.error()};
    }
    return std::make_unique<CdrWriter>(*core_, std::move(*raw), slot);
}

std::shared_ptr<CdrReader> Node::tap_clock() {
    auto tap = std::make_shared<CdrReader>();
    core_->clock_tap = tap;
    core_->taps.push_back(tap);
    tap->release({lockstep() ? INT64_MIN : INT64_MAX});
    return tap;
}

std::shared_ptr<CdrReader> Node::tap_acknowledgements() {
    auto tap = std::make_shared<CdrReader>();
    core_->ack_tap = tap;
    core_->taps.push_back(tap);
    return tap;
}

std::string Node::process_name(Origin const& origin) const {
    std::size_t const known = core_->book->process_count();
    if (origin.process < known) {
        return core_->book->process_name(origin.process);
    }
    std::lock_guard const lock{core_->mutex};
    std::size_t const number = origin.process - known;
    return number < core_->strangers.size() ? core_->strangers[number] : "unknown";
}

} // namespace gridspace::bus
