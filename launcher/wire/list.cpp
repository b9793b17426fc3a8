// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/ethernet/port.hpp"
#include "launcher/wire/live.hpp"
#include "launcher/wire/observer.hpp"
#include "launcher/wire/tools.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace gridspace::wire {
namespace {

std::string state_of(ObservedStream const& s, std::int64_t now) {
    return s.alive(now) ? "alive" : "silent";
}

void print_table(Observer const& observer, ethernet::Port& port, std::int64_t now) {
    if (::isatty(STDOUT_FILENO) != 0) {
        fmt::print("\x1b[H\x1b[2J");
    }
    fmt::print("{:<6} {:<32} {:<7} {:<17} {:>5} {:>9} {:>10} {:>7} {:>7} {:>7}  {}\n", "", "stream", "APPID", "source",
               "VLAN", "frames", "rate 1/s", "lost", "dup", "restart", "state");
    for (ObservedStream const* s : observer.streams()) {
        std::string detail = s->goose
                                 ? fmt::format("stNum {} sqNum {}: {}", s->st_num, s->sq_num, s->values)
                                 : fmt::format("smpSynch {}, {} x {} octets", s->smp_synch, s->asdus, s->sample_octets);
        fmt::print("{:<6} {:<32} 0x{:04X}  {} {:>5} {:>9} {:>10.2f} {:>7} {:>7} {:>7}  {}{}; {}\n",
                   s->goose ? "GOOSE" : "SMV", s->id, s->app_id, s->source.to_string(),
                   s->vlan ? fmt::format("{}/{}", s->vlan->id, s->vlan->priority) : "-", s->frames, s->rate_hz(),
                   s->lost, s->duplicates, s->restarts, state_of(*s, now), s->simulated ? ", simulated" : "", detail);
    }
    fmt::print("{} frames, {} undecodable, {} dropped by the kernel, {} of other protocols; link {}\n",
               observer.frames(), observer.errors().total(), port.counters().dropped, port.foreign(),
               state_name(port.maintain()));
    if (observer.beyond_table() > 0) {
        fmt::print("{} samples and messages of more than {} streams are not in the table\n", observer.beyond_table(),
                   Observer::kMaxStreams);
    }
    std::fflush(stdout);
}

void print_json(Observer const& observer, ethernet::Port& port, std::int64_t now) {
    nlohmann::ordered_json out{{"time_ns", now},
                               {"link", state_name(port.maintain())},
                               {"frames", observer.frames()},
                               {"undecodable", observer.errors().total()},
                               {"dropped", port.counters().dropped},
                               {"foreign", port.foreign()},
                               {"beyond_table", observer.beyond_table()},
                               {"streams", nlohmann::ordered_json::array()}};
    for (ObservedStream const* s : observer.streams()) {
        nlohmann::ordered_json j{{"kind", s->goose ? "goose" : "smv"},
                                 {"id", s->id},
                                 {"app_id", s->app_id},
                                 {"source", s->source.to_string()},
                                 {"destination", s->destination.to_string()},
                                 {"frames", s->frames},
                                 {"rate_hz", s->rate_hz()},
                                 {"lost", s->lost},
                                 {"duplicates", s->duplicates},
                                 {"out_of_order", s->out_of_order},
                                 {"restarts", s->restarts},
                                 {"state", state_of(*s, now)},
                                 {"simulated", s->simulated},
                                 {"conf_rev", s->conf_rev}};
        if (s->vlan) {
            j["vlan"] = {{"id", s->vlan->id}, {"priority", s->vlan->priority}};
        }
        if (s->goose) {
            j.update({{"st_num", s->st_num},
                      {"sq_num", s->sq_num},
                      {"time_allowed_to_live_ms", s->live_ms},
                      {"values", s->values}});
        } else {
            j.update(
                {{"smp_synch", s->smp_synch}, {"samples_per_frame", s->asdus}, {"sample_octets", s->sample_octets}});
        }
        out["streams"].push_back(std::move(j));
    }
    fmt::print("{}\n", out.dump());
    std::fflush(stdout);
}

} // namespace

Result<void> list(ListOptions const& options) {
    ethernet::PortOptions port_options;
    port_options.interface = options.interface;
    port_options.filter.ethertypes = {iec61850::kSvEthertype, iec61850::kGooseEthertype};
    port_options.filter.routable = true;
    auto port = ethernet::Port::open(port_options);
    if (!port) {
        return std::unexpected{port.error()};
    }
    catch_signals();
    Observer observer;
    std::vector<ethernet::ReceivedFrame> batch(256);
    Duration const duration{options.duration_s};
    std::int64_t next = monotonic_ns() + 1'000'000'000;
    auto const print = [&] {
        options.json ? print_json(observer, *port, utc_ns()) : print_table(observer, *port, utc_ns());
    };
    while (!duration.over()) {
        port->wait(std::max<std::int64_t>(
            1, std::min({next - monotonic_ns(), duration.end_ns() - monotonic_ns(), std::int64_t{100'000'000}})));
        for (std::size_t n = port->receive(batch), i = 0; i < n; ++i) {
            observer.add(batch[i].octets, batch[i].stamp_ns != 0 ? batch[i].stamp_ns : utc_ns());
        }
        if (monotonic_ns() >= next) {
            next += 1'000'000'000;
            if (!options.once) {
                print();
            }
        }
    }
    print();
    return {};
}

} // namespace gridspace::wire
