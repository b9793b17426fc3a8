// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/exec_program.hpp"

#include "common/text.hpp"
#include "gateways/ethernet/boxed_ip.hpp"
#include "launcher/scenario/addresses.hpp"
#include "launcher/scenario/guest.hpp"
#include "launcher/scenario/run_on.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/wire_use.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;

enum class Time { real, simulated };

/// The kind of frame that a word or the name of a stream means; 0: neither.
std::uint16_t ethertype_of(Scenario const& s, std::string const& word) {
    if (word == "ip") {
        return ethernet::kIpEthertype;
    }
    if (word == "smv" || word == "goose") {
        return word == "smv" ? iec61850::kSvEthertype : iec61850::kGooseEthertype;
    }
    streams::Stream const* stream = streams::find_stream(s.streams, word);
    return stream == nullptr ? std::uint16_t{0} : stream->ethertype();
}

class ExecSettings final : public ProcessSettings {
  public:
    explicit ExecSettings(Fields& f) {
        std::vector<Ref>& words = words_;
        f.references("command", words,
                     {.doc = "the program and its arguments", .required = true, .may_be_empty = true});
        for (Ref const& word : words) {
            command_.push_back(word.name);
        }
        // A program with a folder in its name is relative to the naming file, as every path; others are looked up in
        // PATH.
        if (!words.empty() && command_.front().find('/') != std::string::npos &&
            words.front().where.source != nullptr) {
            std::filesystem::path const base = words.front().where.source->directory;
            command_.front() = std::filesystem::absolute(base / command_.front()).lexically_normal().string();
        }
        f.flag("guest", guest_,
               {.doc = "it is a virtual machine in the place of its host; in `command`, {tap:LINK} and "
                       "{mac:LINK} are the tap device and the address for each link, {folder} is this file's folder"});
        for (std::size_t n = 0; guest_ && n < words.size(); ++n) {
            if (words[n].where.source != nullptr) {
                auto const folder = std::filesystem::absolute(words[n].where.source->directory).lexically_normal();
                command_[n] = guest::in_folder(command_[n], folder.string());
            }
        }
        f.object("ready", {.doc = "when it is ready, and the run begins; without it, once it is started"},
                 [&](Fields& g) { describe(g, readiness_.emplace()); });
        f.choice("time", time_, {{"real", Time::real}, {"simulated", Time::simulated}},
                 {.doc = "simulated: in lockstep an unmodified program takes part, in simulated time"});
        f.references(
            "sends", sends_,
            {.doc = "time: simulated: frames that it sends on its link; streams, or the kinds smv, goose and ip"});
        f.references("receives", receives_, {.doc = "time: simulated: frames that it receives there"});
        f.flag("member", member_, {.doc = "it follows the lockstep protocol"});
        f.fraction("latency_us", latency_us_, {.doc = "from input to output, in lockstep", .min = 0});
        auto const topics = [&](std::string_view key, std::vector<TopicUse>& uses, std::string_view doc) {
            f.map(key, {.doc = doc}, [&](Ref const& topic, Fields& t) {
                TopicUse use;
                use.topic = topic.name;
                t.text("type", use.type, {.doc = "name of the type on the wire", .required = true});
                t.file("idl", use.idl, {.doc = "IDL file that defines the type, when it is your own"});
                t.integer("endpoints", use.endpoints, {.doc = "how many readers or writers it has", .min = 1});
                t.flag("triggers", use.triggers, {.doc = "a sample makes it work in the same tick"});
                uses.push_back(std::move(use));
            });
        };
        topics("writes", writes_, "topics that it writes");
        topics("reads", reads_, "topics that it reads");
        f.integer("dds_domain", dds_domain_,
                  {.doc = "time: simulated: domain of DDS that it joins; nobody else is in it", .min = 0, .max = 232});
        f.raw("settings", settings_, {.doc = "passed on in its configuration file"});
    }

    void settle(Scenario const& s, Process const&) override {
        boxed_ = time_ == Time::simulated && s.clock.mode == bus::ClockMode::lockstep;
    }
    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        if (guest_) {
            guest::check(s, process, words_, diagnostics);
        }
        if (time_ == Time::real) {
            for (char const* key : {"sends", "receives", "dds_domain"}) {
                if (Node const* written = process.node.find(key)) {
                    diagnostics.error(
                        written->where,
                        fmt::format("process '{}' has `{}`, and lives in real time", process.name.name, key),
                        "`sends`, `receives` and `dds_domain` are for `time: simulated`");
                }
            }
            return;
        }
        if (guest_ || readiness_) {
            Node const* const written = process.node.find(guest_ ? "guest" : "ready");
            diagnostics.error(written == nullptr ? process.name.where : written->where,
                              fmt::format("process '{}' runs in simulated time, and {}", process.name.name,
                                          guest_ ? "is a guest" : "waits to be ready"),
                              guest_ ? "a machine with a kernel of its own lives in real time"
                                     : "it begins at simulated time 0 as everybody does: leave out `ready`");
        }
        check_simulated(s, process, diagnostics);
    }
    [[nodiscard]] bool is_guest() const override { return guest_; }
    [[nodiscard]] Readiness const* readiness() const override { return readiness_ ? &*readiness_ : nullptr; }

    [[nodiscard]] bool is_member() const override { return member_ || boxed_; }
    [[nodiscard]] bool is_expected() const override { return is_member(); }
    [[nodiscard]] std::vector<TopicUse> writes(Scenario const&, Process const&) const override { return writes_; }
    [[nodiscard]] std::vector<TopicUse> reads(Scenario const&, Process const&) const override {
        std::vector<TopicUse> out = reads_;
        for (TopicUse& use : out) {
            use.triggers = use.triggers || boxed_; // it hears a sample when it is there, as everybody who waits does
        }
        return out;
    }
    [[nodiscard]] std::vector<WireUse> sends(Scenario const& s, Process const& process) const override {
        return uses(s, process, sends_);
    }
    [[nodiscard]] std::vector<WireUse> receives(Scenario const& s, Process const& process) const override {
        return uses(s, process, receives_);
    }
    [[nodiscard]] bool sends_late(Scenario const&) const override { return boxed_ && has_ip(); }
    [[nodiscard]] Rational latency_s(Process const&) const override { return latency_us_ / Rational{1'000'000}; }
    [[nodiscard]] Node settings(Scenario const& s, Process const& process) const override {
        return boxed_ ? boxed_settings(s, process) : settings_.is_map() ? settings_ : Node::map();
    }
    [[nodiscard]] std::vector<std::string> command() const override {
        return boxed_ ? std::vector<std::string>{} : command_;
    }
    [[nodiscard]] std::string_view carried_by() const override { return boxed_ ? "gridspace-timebox" : ""; }

  private:
    void check_simulated(Scenario const& s, Process const& process, Diagnostics& diagnostics) const {
        auto const place = [&](char const* key) {
            Node const* written = process.node.find(key);
            return written == nullptr ? process.name.where : written->where;
        };
        auto const refuse = [&](char const* key, std::string const& what, std::string const& hint) {
            diagnostics.error(place(key),
                              fmt::format("process '{}' runs in simulated time, {}", process.name.name, what), hint);
        };
        if (!boxed_) {
            diagnostics.warning(place("time"),
                                fmt::format("process '{}' lives in real time, as all do here", process.name.name),
                                "`time: simulated` counts with `clock: {mode: lockstep}`");
            return;
        }
        if (member_) {
            refuse("member", "and says that it follows the lockstep protocol",
                   "one of the two: who follows the protocol needs no simulated clock");
        }
        if (has_topics() && has_ip()) {
            refuse("sends", "and exchanges topics and IP at once",
                   "its IP is the way to the door that carries the topics; two processes, or one of both");
        }
        if (process.run_on != "native") {
            refuse("run_on", fmt::format("and on '{}'", process.run_on), "`run_on: native`");
        }
        std::vector<std::string> words{"smv", "goose", "ip"};
        for (streams::Stream const& stream : s.streams) {
            words.push_back(stream.name.name);
        }
        for (auto const* list : {&sends_, &receives_}) {
            for (Ref const& word : *list) {
                streams::Stream const* const stream = streams::find_stream(s.streams, word.name);
                if (stream != nullptr && stream->udp) {
                    diagnostics.error(
                        word.where,
                        fmt::format("process '{}' runs in simulated time, and '{}' goes over UDP", process.name.name,
                                    word.name),
                        "frames that a program exchanges in simulated time are Ethernet frames: a stream without `udp`",
                        static_cast<int>(word.name.size()));
                }
                if (ethertype_of(s, word.name) == 0) {
                    diagnostics.error(word.where,
                                      fmt::format("process '{}' {} '{}', which is no stream and no kind of frame",
                                                  process.name.name, list == &sends_ ? "sends" : "receives", word.name),
                                      spelling_hint(word.name, words), static_cast<int>(word.name.size()));
                }
            }
        }
        if (!sends_.empty() || !receives_.empty()) {
            check_raw_link(s, process, diagnostics);
        }
        if (has_ip()) {
            check_ip(s, process, diagnostics);
        }
    }

    /// What goes back and forth within a tick has no order in which the processes could work: so nothing does.
    void check_ip(Scenario const& s, Process const& process, Diagnostics& diagnostics) const {
        Node const* const written = process.node.find("latency_us");
        if (latency_s(process) < s.tick_s()) {
            diagnostics.error(
                written == nullptr ? process.name.where : written->where,
                fmt::format("process '{}' speaks IP in simulated time, its `latency_us` is {}, and a tick is {} us",
                            process.name.name, shortest(latency_us_.to_double()),
                            shortest((s.tick_s() * Rational{1'000'000}).to_double())),
                "at least a tick: what it sends is due after the tick in which it was made; `clock.tick_samples` makes "
                "ticks shorter");
        }
        std::string const link = raw_link(s, process);
        auto const port = own_port(s, process);
        if (!link.empty() && (!port || port->address.empty())) {
            diagnostics.error(
                process.link.empty() ? process.name.where : process.link.where,
                fmt::format("process '{}' speaks IP on '{}', which has no addresses", process.name.name, link),
                fmt::format("`link:` one with `ipv4:`, or `links: {{{}: {{ipv4: 10.10.0.0/24}}}}`", link));
        }
    }

    [[nodiscard]] bool has_topics() const { return !reads_.empty() || !writes_.empty(); }
    [[nodiscard]] bool has_ip() const {
        auto const is_ip = [](Ref const& word) { return word.name == "ip"; };
        return std::ranges::any_of(sends_, is_ip) || std::ranges::any_of(receives_, is_ip);
    }
    [[nodiscard]] static std::optional<Port> own_port(Scenario const& s, Process const& process) {
        for (Port const& port : plan_ports(s)) {
            if (port.host == process.host.name && port.link == raw_link(s, process)) {
                return port;
            }
        }
        return std::nullopt;
    }
    /// Address, and who else is there: nobody asks by ARP.
    [[nodiscard]] static Node ip_settings(Scenario const& s, Process const& process) {
        Node node = Node::map(), neighbours = Node::map();
        auto const own = own_port(s, process);
        if (!own) {
            return node; // check_ip has said so
        }
        auto const boxed = [](Port const& port) {
            return ethernet::boxed_address(iec61850::Mac::parse(port.mac).value_or(iec61850::Mac{})).to_string();
        };
        node.set("address", Node::quoted_text(fmt::format("{}/{}", own->address, own->prefix)));
        node.set("mac", Node::quoted_text(boxed(*own)));
        for (Port const& port : plan_ports(s)) {
            bool const speaks = std::ranges::any_of(s.processes, [&](Process const& other) {
                return other.settings != nullptr && other.host.name == port.host && other.settings->sends_late(s) &&
                       raw_link(s, other) == port.link;
            });
            if (port.link == own->link && port.host != own->host && speaks) {
                neighbours.set(port.address, Node::quoted_text(boxed(port)));
            }
        }
        node.set("neighbours", std::move(neighbours));
        return node;
    }

    [[nodiscard]] std::vector<WireUse> uses(Scenario const& s, Process const& process,
                                            std::vector<Ref> const& words) const {
        std::vector<WireUse> out;
        for (Ref const& word : words) {
            if (std::uint16_t const ethertype = ethertype_of(s, word.name); boxed_ && ethertype != 0) {
                bool const kind = streams::find_stream(s.streams, word.name) == nullptr;
                out.push_back({raw_link(s, process), ethertype, kind ? "" : word.name});
            }
        }
        bool const named =
            std::ranges::any_of(out, [](WireUse const& use) { return use.ethertype == ethernet::kIpEthertype; });
        if (boxed_ && has_ip() && !named) { // who asks hears the answer
            out.push_back({raw_link(s, process), ethernet::kIpEthertype, ""});
        }
        return out;
    }

    [[nodiscard]] static Node topic_settings(std::vector<TopicUse> const& uses) {
        Node out = Node::map();
        for (TopicUse const& use : uses) {
            Node& topic = out.set(use.topic, Node::map());
            topic.set("type", Node::quoted_text(use.type));
            if (!use.idl.empty()) {
                topic.set("idl", Node::quoted_text(std::filesystem::absolute(use.idl).lexically_normal().string()));
            }
        }
        return out;
    }

    [[nodiscard]] Node boxed_settings(Scenario const& s, Process const& process) const {
        Node node = Node::map(), command = Node::sequence();
        for (std::string const& word : command_) {
            command.items.push_back(Node::quoted_text(word));
        }
        node.set("command", std::move(command));
        node.set("seed", Node::scalar(std::to_string(s.seed)));
        node.set("latency_us", Node::scalar(latency_us_.to_string()));
        for (auto const& [key, words] : {std::pair{"sends", &sends_}, std::pair{"receives", &receives_}}) {
            Node kinds = Node::sequence();
            for (char const* kind : {"smv", "goose", "ip"}) {
                if (has_ip() && std::string_view{kind} == "ip") {
                    kinds.items.push_back(Node::scalar(kind)); // who asks hears the answer
                } else if (std::any_of(words->begin(), words->end(), [&](Ref const& word) {
                               return ethertype_of(s, word.name) == ethertype_of(s, kind);
                           })) {
                    kinds.items.push_back(Node::scalar(kind));
                }
            }
            node.set(key, std::move(kinds));
        }
        if (!sends_.empty() || !receives_.empty()) {
            node.set("wire", wire_settings(s, process));
            node.set("streams", Node::map());
        }
        if (has_ip()) {
            node.set("ip", ip_settings(s, process));
        }
        if (has_topics()) {
            node.set("reads", topic_settings(reads_));
            node.set("writes", topic_settings(writes_));
            node.set("dds_domain", Node::scalar(std::to_string(dds_domain_)));
        }
        return node;
    }

    std::vector<Ref> words_; ///< of its command, as they are written
    std::vector<std::string> command_;
    bool guest_{false};
    std::optional<Readiness> readiness_;
    Time time_{Time::real};
    std::vector<Ref> sends_, receives_;
    bool member_{false};
    bool boxed_{false}; ///< after settle()
    Rational latency_us_{0};
    std::vector<TopicUse> writes_, reads_;
    std::int64_t dds_domain_{0};
    Node settings_;
};

} // namespace

std::unique_ptr<ProcessSettings> read_exec(Fields& f) {
    return std::make_unique<ExecSettings>(f);
}

} // namespace gridspace::launcher
