// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "gateways/ethernet/port.hpp"
#include "gateways/iec61850/goose_publisher.hpp"
#include "gateways/iec61850/goose_subscriber.hpp"
#include "launcher/wire/live.hpp"
#include "launcher/wire/observer.hpp"
#include "launcher/wire/tools.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <unistd.h>

namespace gridspace::wire {
namespace {

using namespace iec61850;
using Json = nlohmann::ordered_json;

Result<void> assign(GoosePublisher& publisher, std::string const& assignment) {
    std::size_t const equals = assignment.find('=');
    std::string const name = assignment.substr(0, equals);
    auto const leaf = publisher.frame().index_of(name);
    if (equals == std::string::npos || !leaf) {
        std::vector<std::string> names;
        for (Leaf const& l : publisher.frame().leaves()) {
            names.push_back(l.name);
        }
        return fail(ExitCode::usage, fmt::format("'{}' assigns nothing", assignment),
                    fmt::format("expected NAME=VALUE with one of: {}", join(names, ", ")));
    }
    std::string storage;
    auto const value = parse_value(publisher.frame().leaves()[*leaf], assignment.substr(equals + 1), storage);
    if (!value) {
        return std::unexpected{value.error()};
    }
    if (publisher.set(*leaf, *value) == GooseTemplate::Stored::refused) {
        return fail(ExitCode::usage, fmt::format("'{}' does not fit the type {}", assignment, type_name(value->type)));
    }
    return {};
}

std::optional<std::size_t> first_boolean(GoosePublisher& publisher) {
    auto const& leaves = publisher.frame().leaves();
    auto const found =
        std::find_if(leaves.begin(), leaves.end(), [](Leaf const& l) { return l.type == BasicType::boolean; });
    return found == leaves.end() ? std::nullopt : std::optional{static_cast<std::size_t>(found - leaves.begin())};
}

/// Lines of stdin that are complete; never waits.
std::vector<std::string> stdin_lines(std::string& rest, bool& open) {
    std::vector<std::string> out;
    pollfd entry{STDIN_FILENO, POLLIN, 0};
    if (!open || ::poll(&entry, 1, 0) <= 0) {
        return out;
    }
    char buffer[4096];
    ssize_t const n = ::read(STDIN_FILENO, buffer, sizeof buffer);
    open = n > 0;
    rest.append(buffer, n > 0 ? static_cast<std::size_t>(n) : 0);
    for (std::size_t end = 0; (end = rest.find('\n')) != std::string::npos; rest.erase(0, end + 1)) {
        out.emplace_back(trim(rest.substr(0, end)));
    }
    return out;
}

Json message_json(GooseFrame const& m, std::int64_t stamp_ns) {
    Json out{{"time_ns", stamp_ns},
             {"gocb_ref", visible(m.gocb_ref)},
             {"go_id", visible(m.go_id)},
             {"dat_set", visible(m.dat_set)},
             {"app_id", m.header.app_id},
             {"source", m.header.source.to_string()},
             {"st_num", m.st_num},
             {"sq_num", m.sq_num},
             {"t_ns", m.t.nanoseconds()},
             {"t_quality", time_quality_text(m.t)},
             {"time_allowed_to_live_ms", m.live_ms},
             {"conf_rev", m.conf_rev},
             {"simulation", m.simulation},
             {"s_bit", m.header.simulated()},
             {"nds_com", m.nds_com},
             {"entries", m.declared_entries},
             {"values", data_text(m)}};
    if (m.header.vlan) {
        out["vlan"] = {{"id", m.header.vlan->id}, {"priority", m.header.vlan->priority}};
    }
    return out;
}

/// With the initial values.
Result<GoosePublisher> make_publisher(GoosePublishOptions const& o, streams::Stream const& stream, Mac const& source) {
    auto frame = stream.goose_template(source);
    if (!frame) {
        return std::unexpected{frame.error()};
    }
    GoosePublisherParams params;
    streams::GooseTiming const& t = stream.timing;
    params.timing = {static_cast<std::int64_t>(t.min_time_ms * 1e6), static_cast<std::int64_t>(t.max_time_ms * 1e6),
                     t.growth, t.live_factor, static_cast<std::uint32_t>(t.live_min_ms)};
    params.first_sq_num = stream.first_sq_num;
    params.first_st_num = o.first_st_num;
    params.simulation = stream.address.simulated;
    GoosePublisher publisher{std::move(*frame), o.nds_com ? 0 : std::max(stream.conf_rev, 1U), params};
    for (std::string const& assignment : o.values) {
        if (auto ok = assign(publisher, assignment); !ok) {
            return std::unexpected{ok.error()};
        }
    }
    return publisher;
}

void send_due(GoosePublisher& publisher, ethernet::Port& port) {
    if (Octets const message = publisher.take(monotonic_ns()); !message.empty()) {
        port.send(message);
    }
}

/// Until the time is over or Ctrl-C. `toggled`: the member that is changed every `toggle_s`, if that is above 0.
void publish(GoosePublisher& publisher, ethernet::Port& port, GoosePublishOptions const& o,
             std::optional<std::size_t> toggled) {
    Duration const duration{o.duration_s};
    publisher.start(monotonic_ns(), utc_ns());
    std::int64_t const toggle_ns = static_cast<std::int64_t>(o.toggle_s * 1e9);
    std::int64_t next_toggle = toggle_ns > 0 ? monotonic_ns() + toggle_ns : INT64_MAX;
    std::string rest;
    bool open = o.interactive;
    while (!duration.over()) {
        send_due(publisher, port);
        std::int64_t wake = std::min({*publisher.due(), next_toggle, duration.end_ns()});
        sleep_until(open ? std::min(wake, monotonic_ns() + 1'000'000) : wake);
        std::int64_t const now = monotonic_ns();
        if (now >= next_toggle) {
            next_toggle += toggle_ns;
            publisher.set(*toggled, Value::of(!publisher.frame().get(*toggled).boolean()));
            publisher.commit(now, utc_ns());
        }
        for (std::string const& line : stdin_lines(rest, open)) {
            if (auto ok = line.empty() ? Result<void>{} : assign(publisher, line); !ok) {
                fmt::print(stderr, "error: {}\n", describe(ok.error()));
            }
            if (publisher.commit(monotonic_ns(), utc_ns())) {
                send_due(publisher, port); // each line is a state of its own: a pulse is two of them
            }
        }
    }
    if (Octets const message = publisher.last(monotonic_ns()); !message.empty()) {
        port.send(message);
    }
}

GooseSubscription subscription_to(streams::Stream const& stream, GooseSubscribeOptions const& o) {
    GooseSubscription s;
    s.gocb_ref = stream.control_block;
    s.go_id = stream.go_id;
    s.conf_rev = stream.conf_rev;
    s.data_set = stream.data_set;
    s.strict = o.strict;
    s.simulation = stream.address.simulated;
    if (is_named(o.stream, "mac")) {
        s.destination = stream.address.destination;
    }
    if (is_named(o.stream, "app_id")) {
        s.app_id = stream.address.app_id;
    }
    if (is_named(o.stream, "data_set_name")) {
        s.dat_set = stream.data_set_name;
    }
    return s;
}

} // namespace

Result<void> goose_publish(GoosePublishOptions const& o) {
    auto opened = open_sending(o.interface, o.stream, streams::Kind::goose, o.source);
    if (!opened) {
        return std::unexpected{opened.error()};
    }
    auto& [stream, port, source] = *opened;
    auto publisher = make_publisher(o, stream, source);
    if (!publisher) {
        return std::unexpected{publisher.error()};
    }
    auto const toggled = first_boolean(*publisher);
    if (o.toggle_s > 0 && !toggled) {
        return fail(ExitCode::usage, "the data set has no Boolean to toggle", "--interactive changes any member");
    }
    catch_signals();
    publish(*publisher, port, o, toggled);
    auto const& c = publisher->counters();
    fmt::print("{}\n", Json{{"sent", port.counters().sent},
                            {"not_sent", port.counters().send_failed},
                            {"states", c.states},
                            {"late", c.late},
                            {"st_num", publisher->state().st_num},
                            {"sq_num", publisher->state().sq_num}}
                           .dump());
    return check_sent(port);
}

Result<void> goose_subscribe(GooseSubscribeOptions const& o) {
    std::optional<GooseSubscriber> subscriber;
    if (!o.stream.file.empty() || !o.stream.keys.empty()) {
        auto const stream = read_stream(o.stream, streams::Kind::goose);
        if (!stream) {
            return fail(ExitCode::usage, "the stream cannot be subscribed");
        }
        subscriber.emplace(subscription_to(*stream, o));
    }
    ethernet::PortOptions port_options;
    port_options.interface = o.interface;
    port_options.filter.ethertypes = {kGooseEthertype};
    auto port = ethernet::Port::open(port_options);
    if (!port) {
        return std::unexpected{port.error()};
    }
    catch_signals();
    GooseFrame message;
    std::vector<ethernet::ReceivedFrame> batch(64);
    Duration const duration{o.duration_s};
    std::uint64_t shown = 0;
    auto const print = [&](Json const& line) {
        fmt::print("{}\n", line.dump());
        std::fflush(stdout);
        ++shown;
    };
    while (!duration.over() && (o.count == 0 || shown < o.count)) {
        std::int64_t wake = std::min(duration.end_ns() - monotonic_ns(), std::int64_t{100'000'000});
        if (subscriber && subscriber->deadline()) {
            wake = std::min(wake, *subscriber->deadline() - utc_ns());
        }
        port->wait(std::max<std::int64_t>(1, wake));
        for (std::size_t n = port->receive(batch), i = 0; i < n && (o.count == 0 || shown < o.count); ++i) {
            std::int64_t const stamp = batch[i].stamp_ns != 0 ? batch[i].stamp_ns : utc_ns();
            if (auto const ok = decode_goose(batch[i].octets, message); !ok) {
                print({{"time_ns", stamp}, {"error", describe(ok.error())}});
                continue;
            }
            Json line = message_json(message, stamp);
            if (subscriber) {
                auto const verdict = subscriber->receive(message, stamp, stamp);
                if (verdict.event == GooseEvent::not_ours) {
                    continue;
                }
                line["event"] = event_name(verdict.event);
                line["accepted"] = verdict.accepted;
                line["lost"] = verdict.lost;
                line["skipped_states"] = verdict.skipped_states;
            }
            print(line);
        }
        if (subscriber && subscriber->expire(utc_ns())) {
            print({{"time_ns", utc_ns()}, {"event", "expired"}});
        }
        port->maintain();
    }
    return {};
}

} // namespace gridspace::wire
