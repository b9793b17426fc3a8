// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scl/station_scenario.hpp"

#include "common/text.hpp"
#include "gateways/gateway/subscription_config.hpp"
#include "launcher/scl/stream_fields.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>
#include <set>

namespace gridspace::launcher {
namespace {

using config::Node;
using scl::ControlBlock;
using scl::Finding;
using scl::StreamSubscription;

constexpr std::size_t kLongestName = 28;      // of a process: it becomes part of the names of hosts and signals
constexpr std::size_t kLongestSignal = 96;    // idl/signals.idl
constexpr std::int64_t kFinestStep = 200000;  // steps a second of the simulator, at most
constexpr std::int64_t kCoarsestStep = 16000; // and at least: what the usual network wants
constexpr std::size_t kMostExpectations = 200;

Node text(std::string t) {
    return Node::scalar(std::move(t));
}
Node flow(std::initializer_list<std::pair<char const*, std::string>> entries) {
    Node out = Node::map();
    for (auto const& [key, value] : entries) {
        out.set(key, text(value));
    }
    return out;
}
Node names(std::vector<std::string> const& list) {
    Node out = Node::sequence();
    for (std::string const& name : list) {
        out.items.push_back(text(name));
    }
    return out;
}

class Maker {
  public:
    Maker(scl::Station const& station, StationOptions const& options) : station_{station}, options_{options} {}

    Result<StationScenario> run() {
        if (auto ok = choose(); !ok) {
            return std::unexpected{ok.error()};
        }
        config::Diagnostics ignored; // each stream was read by itself already
        declared_ = streams::read_streams(station_.import.streams, ignored);
        choose_rate();
        for (scl::Ied const& ied : station_.ieds) {
            if (is_played(ied.name)) {
                play(ied);
            }
        }
        if (out_.ieds.empty()) {
            return fail(ExitCode::usage, "nothing of the file can be played",
                        "the report says why each control block and subscription was left out");
        }
        put_together();
        return std::move(out_);
    }

  private:
    [[nodiscard]] bool is_played(std::string const& ied) const {
        return options_.ieds.empty() ||
               std::find(options_.ieds.begin(), options_.ieds.end(), ied) != options_.ieds.end();
    }

    Result<void> choose() {
        std::vector<std::string> all;
        for (scl::Ied const& ied : station_.ieds) {
            all.push_back(ied.name);
        }
        auto const must_exist = [&](std::string const& name) -> Result<void> {
            return std::find(all.begin(), all.end(), name) != all.end()
                       ? Result<void>{}
                       : fail(ExitCode::usage, fmt::format("there is no IED '{}' in the file", name),
                              spelling_hint(name, all));
        };
        for (std::string const& wanted : options_.ieds) {
            if (auto ok = must_exist(wanted); !ok) {
                return ok;
            }
        }
        for (auto const& [ied, ignored] : options_.points) {
            if (auto ok = must_exist(ied); !ok) {
                return ok;
            }
        }
        return {};
    }

    streams::Stream const& declared(ControlBlock const& block) const {
        return *streams::find_stream(declared_, block.stream);
    }

    /// The rate of most sampled values is what the simulator samples at; its step is a part of every period.
    void choose_rate() {
        std::map<std::int64_t, int> rates;
        for (ControlBlock const& block : station_.import.blocks) {
            if (!block.goose && is_played(block.ied)) {
                ++rates[declared(block).rate_hz.num()];
            }
        }
        for (auto const& [rate, count] : rates) {
            rate_hz_ = rate_hz_ == 0 || count > rates[rate_hz_] ? rate : rate_hz_;
        }
        samples_ = rate_hz_ != 0;
        rate_hz_ = samples_ ? rate_hz_ : 4000;
        std::int64_t steps = rate_hz_;
        for (auto const& [rate, ignored] : rates) {
            std::int64_t const both = std::lcm(steps, rate);
            steps = both <= kFinestStep ? both : steps; // what does not fit is held back in play()
        }
        steps_ = steps * ((kCoarsestStep + steps - 1) / steps);
        std::int64_t const longest = options_.realtime ? 4 : 24;
        for (per_message_ = longest; rate_hz_ % per_message_ != 0;) {
            --per_message_;
        }
    }

    /// A name for a process that no other has.
    std::string process_name(std::string const& ied) {
        std::string name = ied;
        std::replace_if(name.begin(), name.end(), [](char c) { return !is_identifier(std::string{'_', c}); }, '_');
        name = is_identifier(name) ? name : "_" + name;
        name = name.substr(0, kLongestName);
        std::string unique = name;
        for (int n = 2; !taken_.insert(unique).second; ++n) {
            unique = fmt::format("{}_{}", name, n);
        }
        return unique;
    }

    void note(Finding::Kind kind, ControlBlock const& block, std::string what, std::string remedy) {
        out_.findings.push_back({kind, block.where, block.ied + " " + block.block, std::move(what), std::move(remedy)});
    }

    void play(scl::Ied const& ied) {
        PlayedIed played;
        played.ied = ied.name;
        Node mappings = Node::map();
        std::set<bool> sends_goose;
        for (ControlBlock const& block : station_.import.blocks) {
            if (block.ied == ied.name && add_mapping(block, mappings)) {
                played.sends.push_back(block.stream);
                sends_goose.insert(block.goose);
                sent_.insert(block.stream);
            }
        }
        Node subscriptions = Node::map();
        std::string const name = process_name(ied.name);
        bool crossed = false; // it hears what it sends: in lockstep nobody may wait for who waits for it
        std::vector<StreamSubscription const*> own;
        for (StreamSubscription const& one : station_.subscriptions) {
            if (one.ied == ied.name && !declared(station_.import.blocks[one.block]).broken) {
                own.push_back(&one);
                crossed = crossed || sends_goose.contains(station_.import.blocks[one.block].goose);
            }
        }
        bool const apart = crossed && !options_.realtime;
        std::string const hearing = apart ? process_name(name.substr(0, kLongestName - 3) + "_in") : name;
        for (StreamSubscription const* one : own) {
            add_subscription(*one, hearing, subscriptions);
            played.hears.push_back(station_.import.blocks[one->block].stream);
            used_.insert(played.hears.back());
        }
        if (mappings.entries.empty() && subscriptions.entries.empty()) {
            out_.silent.push_back(ied.name);
            return;
        }
        bool const measures = std::any_of(mappings.entries.begin(), mappings.entries.end(),
                                          [](Node::Entry const& m) { return m.value.find("from") != nullptr; });
        if (apart) {
            add_process(name, measures, std::move(mappings), Node::map());
            add_process(hearing, false, Node::map(), std::move(subscriptions));
            played.processes = {name, hearing};
        } else {
            add_process(name, measures, std::move(mappings), std::move(subscriptions));
            played.processes = {name};
        }
        out_.ieds.push_back(std::move(played));
    }

    void add_process(std::string const& name, bool measures, Node mappings, Node subscriptions) {
        Node process = flow({{"program", "gridspace-gateway"}, {"host", name}});
        if (!mappings.entries.empty()) {
            process.set("mappings", std::move(mappings));
        }
        if (!subscriptions.entries.empty()) {
            process.set("subscriptions", std::move(subscriptions));
        }
        processes_.set(name, std::move(process));
        Node host = Node::map();
        host.set("links", names(measures ? std::vector<std::string>{"data_bus", "station"}
                                         : std::vector<std::string>{"station"}));
        hosts_.set(name, std::move(host));
    }

    bool add_mapping(ControlBlock const& block, Node& mappings) {
        streams::Stream const& stream = declared(block);
        if (stream.broken) {
            note(Finding::Kind::left_out, block, "a receiver cannot tell it from another stream; it is not sent",
                 "another MAC address, APPID or name");
            return false;
        }
        Node mapping = Node::map();
        std::string values = "constants";
        Node fields = Node::map();
        if (!block.goose) {
            std::int64_t const rate = stream.rate_hz.num();
            if (!options_.realtime && steps_ % rate != 0) {
                note(
                    Finding::Kind::left_out, block,
                    fmt::format("{} samples a second do not fall on the simulator's steps beside {} Hz; it is not sent",
                                rate, rate_hz_),
                    "--realtime, or another --ied for a run of its own");
                return false;
            }
            bool const indexed = rate == rate_hz_;
            fields = sampled_fields(block, stream, indexed ? "samples" : fmt::format("samples.{}", per_message_ - 1));
            if (!fields.entries.empty()) {
                auto const point = options_.points.find(block.ied);
                MeasuringPoint const& measured = point == options_.points.end() ? options_.usual : point->second;
                std::string const topic = topic_of(measured);
                mapping.set("from", flow({{"topic", topic}, {"type", "BaySamples"}}));
                if (indexed) {
                    mapping.set("each", text("samples"));
                    mapping.set("index", text("first_index"));
                }
                values = fmt::format("{} and {} of the network{}", measured.ct, measured.vt,
                                     indexed ? "" : fmt::format(", held between {} samples a second", rate_hz_));
            }
        }
        if (fields.entries.empty()) {
            fields = constant_fields(block, stream);
        }
        if (fields.entries.empty()) {
            note(Finding::Kind::left_out, block, "none of its members can be given a value; it is not sent",
                 "a mapping of your own (docs/how_to/use_the_gateway.md)");
            return false;
        }
        mapping.set("to", flow({{"stream", block.stream}}));
        mapping.set("fields", std::move(fields));
        mappings.set(block.stream, std::move(mapping));
        out_.streams.push_back({block.stream, block.ied, block.block, true, std::move(values)});
        return true;
    }

    std::string topic_of(MeasuringPoint const& point) {
        auto const [it, fresh] = topics_.try_emplace(point, fmt::format("BAY_{}_{}", point.ct, point.vt));
        return it->second;
    }

    void add_subscription(StreamSubscription const& one, std::string const& process, Node& subscriptions) {
        ControlBlock const& block = station_.import.blocks[one.block];
        streams::Stream const& stream = declared(block);
        std::string const prefix = "subscription." + process + ".";
        std::string name = block.stream;
        if (prefix.size() + name.size() + std::string_view{".needs_commissioning"}.size() > kLongestSignal) {
            name = fmt::format("S{}", one.block + 1);
        }
        Node subscription = Node::map();
        if (name != block.stream) {
            subscription.set("stream", text(block.stream));
        }
        std::vector<std::string> watch;
        for (iec61850::Leaf const& leaf : iec61850::leaves_of(stream.data_set)) {
            bool const wanted = std::find(one.members.begin(), one.members.end(),
                                          leaf.name.substr(0, leaf.name.find('.'))) != one.members.end();
            bool const fits = prefix.size() + name.size() + leaf.name.size() + 7 <= kLongestSignal;
            if (block.goose && wanted && gateways::can_be_watched(leaf.type) && fits) { // samples are in the capture
                watch.push_back(leaf.name);
            }
        }
        if (!watch.empty()) {
            subscription.set("watch", names(watch));
        }
        subscriptions.set(name, std::move(subscription));
        if (is_played(block.ied)) {
            heard_.push_back({prefix + name, block.stream});
        }
    }

    void put_together() {
        Node& root = out_.root;
        root = Node::map();
        root.set("gridspace", text("1"));
        root.set("name", text(options_.name));
        root.set("seed", text("1"));
        Node simulation = flow({{"network", options_.network},
                                {"solver", "emt"},
                                {"step_s", fmt::format("1/{}", steps_)},
                                {"duration_s", "2"}});
        simulation.set("epoch", Node::quoted_text("2024-01-01T00:00:00Z"));
        simulation.set("sampling", flow({{"rate_hz", std::to_string(rate_hz_)},
                                         {"samples_per_message", std::to_string(per_message_)}}));
        if (!topics_.empty()) {
            Node publish = Node::map();
            for (auto const& [point, topic] : topics_) {
                publish.set(topic, flow({{"ct", point.ct}, {"vt", point.vt}}));
            }
            Node station = Node::map();
            station.set("publish", std::move(publish));
            Node gateways = Node::map();
            gateways.set("station", std::move(station));
            simulation.set("gateways", std::move(gateways));
        }
        root.set("simulation", std::move(simulation));
        root.set("clock", options_.realtime ? flow({{"mode", "realtime"},
                                                    {"speed", "1"},
                                                    {"start_at", "utc_second"},
                                                    {"tick_samples", std::to_string(per_message_)}})
                                            : flow({{"mode", "lockstep"}, {"speed", "max"}, {"tick_samples", "auto"}}));
        Node hosts = Node::map();
        Node simulator = Node::map();
        simulator.set("links", names({"data_bus"}));
        hosts.set("simulator", std::move(simulator));
        for (Node::Entry& host : hosts_.entries) {
            hosts.set(host.key, std::move(host.value));
        }
        Node links = Node::map();
        links.set("data_bus", flow({{"kind", "switch"}, {"ipv4", "10.20.0.0/16"}}));
        links.set("station", flow({{"kind", "switch"}}));
        Node processes = Node::map();
        processes.set("sim", flow({{"program", "gridspace-sim"}, {"host", "simulator"}}));
        for (Node::Entry& process : processes_.entries) {
            processes.set(process.key, std::move(process.value));
        }
        Node recorder = flow({{"program", "gridspace-recorder"}, {"host", "simulator"}});
        recorder.set("capture", names({"station"}));
        processes.set("recorder", std::move(recorder));
        root.set("hosts", std::move(hosts));
        root.set("links", std::move(links));
        root.set("streams", used_streams());
        root.set("processes", std::move(processes));
        root.set("record", flow({{"samples", "all"}, {"frames", "all"}}));
        add_expectations(root);
    }

    /// Those that are sent, and those that somebody hears.
    Node used_streams() {
        Node out = Node::map();
        for (std::size_t i = 0; i < station_.import.blocks.size(); ++i) {
            ControlBlock const& block = station_.import.blocks[i];
            bool const sent = sent_.contains(block.stream), heard = used_.contains(block.stream);
            if (sent || heard) {
                out.set(block.stream, station_.import.streams.entries[i].value);
            }
            if (heard && !sent) {
                out_.streams.push_back({block.stream, block.ied, block.block, false, "of a device that is not played"});
            }
        }
        return out;
    }

    void add_expectations(Node& root) {
        Node expect = Node::map();
        for (std::size_t i = 0; i < heard_.size() && i < kMostExpectations / 2; ++i) {
            auto const& [signal, stream] = heard_[i];
            if (!sent_.contains(stream)) {
                continue;
            }
            expect.set(fmt::format("heard_{}", i + 1), flow({{"last_of", signal + ".alive"}, {"is", "1"}}));
            expect.set(fmt::format("agreed_{}", i + 1), flow({{"max_of", signal + ".problem"}, {"is", "0"}}));
        }
        if (!expect.entries.empty()) {
            root.set("expect", std::move(expect));
        }
    }

    scl::Station const& station_;
    StationOptions const& options_;
    std::vector<streams::Stream> declared_;
    std::int64_t rate_hz_{0}, steps_{0}, per_message_{1};
    bool samples_{false};
    std::set<std::string> taken_{"sim", "recorder", "simulator", "station", "data_bus"}, sent_, used_;
    std::map<MeasuringPoint, std::string> topics_;
    Node processes_{Node::map()}, hosts_{Node::map()};
    std::vector<std::pair<std::string, std::string>> heard_; ///< prefix of a subscription's signals, and its stream
    StationScenario out_;
};

} // namespace

Result<StationScenario> make_scenario(scl::Station const& station, StationOptions const& options) {
    return Maker{station, options}.run();
}

} // namespace gridspace::launcher
