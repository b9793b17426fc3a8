// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bench.hpp"

#include "common/config/yaml.hpp"
#include "common/source_tree.hpp"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>

namespace gridspace::router {
namespace {

std::string const kQos = source_tree("qos/");

bus::Codec octets_codec(std::string_view type, bool keyed) {
    bus::Codec codec;
    codec.type_name = type;
    codec.keyed = keyed;
    return codec;
}

} // namespace

std::vector<std::byte> sample(std::uint32_t number) {
    std::vector<std::byte> out(8);
    out[1] = std::byte{1};
    std::memcpy(out.data() + 4, &number, 4);
    return out;
}
std::uint32_t number_of(std::vector<std::byte> const& cdr) {
    std::uint32_t number = 0;
    std::memcpy(&number, cdr.data() + 4, 4);
    return number;
}

Program::Program(std::string const& name, int domain) {
    bus::ParticipantOptions options;
    options.process = name;
    options.program = "test";
    options.domain = domain;
    options.qos_file = kQos + "member.xml";
    options.addresses = {"127.0.0.1"};
    auto joined = bus::Participant::create(options);
    if (!joined) {
        throw std::runtime_error{describe(joined.error())};
    }
    participant_ = std::move(*joined);
}

bus::RawWriter& Program::writes(std::string const& topic, bus::EndpointQos const& like, std::string_view type,
                                bool keyed) {
    auto made = bus::create_writer_like(*participant_, topic, octets_codec(type, keyed), like);
    if (!made) {
        throw std::runtime_error{describe(made.error())};
    }
    return *(writers_[topic] = std::move(*made));
}

void Program::reads(std::string const& topic, bus::EndpointQos const& like, std::string_view type, bool keyed) {
    auto made = bus::create_reader_like(*participant_, topic, octets_codec(type, keyed), like,
                                        [this, topic](std::span<std::byte const> cdr, bus::SampleHeader const& header) {
                                            std::lock_guard const lock{signal_.mutex()};
                                            heard_[topic].push_back({{cdr.begin(), cdr.end()},
                                                                     header.source_ns,
                                                                     participant_->peer(header.peer).process});
                                        });
    if (!made) {
        throw std::runtime_error{describe(made.error())};
    }
    readers_[topic] = std::move(*made);
}

std::size_t Program::heard(std::string const& topic) {
    std::lock_guard const lock{signal_.mutex()};
    return heard_[topic].size();
}
std::vector<Program::Heard> Program::all(std::string const& topic) {
    std::lock_guard const lock{signal_.mutex()};
    return heard_[topic];
}
bool Program::wait_heard(std::string const& topic, std::size_t count) {
    return signal_.wait([&] { return heard_[topic].size() >= count; });
}
std::size_t Program::sources(std::string const& topic) {
    return readers_[topic]->matched().size();
}
bool Program::wait_sources(std::string const& topic, std::size_t count) {
    return signal_.wait([&] { return sources(topic) == count; });
}

RunningRouter::RunningRouter(std::string const& yaml) {
    config::Diagnostics diagnostics;
    auto const root = config::parse_yaml(yaml, config::make_source("router.yaml", yaml), diagnostics);
    if (root) {
        config::read_fields(*root, "", diagnostics, [&](config::Fields& f) { describe(f, config_); });
    }
    if (!diagnostics.ok()) {
        throw std::runtime_error{diagnostics.render()};
    }
    router_ = std::make_unique<Router>(config_, *this);
    auto const opened = router_->open(kQos + "router.xml", [this] {
        std::lock_guard const lock{signal_.mutex()};
        changed_ = true;
    });
    if (!opened) {
        throw std::runtime_error{describe(opened.error())};
    }
    thread_ = std::thread{[this] {
        while (true) {
            {
                std::unique_lock lock{signal_.mutex()};
                if (stopping_) {
                    return;
                }
                changed_ = false;
            }
            router_->update();
            (void)signal_.wait([&] { return changed_ || stopping_; });
        }
    }};
}

RunningRouter::~RunningRouter() {
    stop();
}

void RunningRouter::stop() {
    if (!thread_.joinable()) {
        return;
    }
    {
        std::lock_guard const lock{signal_.mutex()};
        stopping_ = true;
    }
    signal_.notify();
    thread_.join();
    router_->close();
    router_.reset();
}

RunningRouter::Seen RunningRouter::seen() {
    std::lock_guard const lock{signal_.mutex()};
    return seen_;
}
std::size_t RunningRouter::count(std::string const& event) {
    std::lock_guard const lock{signal_.mutex()};
    return static_cast<std::size_t>(std::count_if(seen_.events.begin(), seen_.events.end(),
                                                  [&](std::string const& e) { return e.starts_with(event); }));
}
bool RunningRouter::wait_for(std::string const& event, std::size_t times) {
    return signal_.wait([&] {
        return static_cast<std::size_t>(std::count_if(seen_.events.begin(), seen_.events.end(),
                                                      [&](std::string const& e) { return e.starts_with(event); })) >=
               times;
    });
}

void RunningRouter::say(std::string event) {
    std::lock_guard const lock{signal_.mutex()};
    seen_.events.push_back(std::move(event));
}
void RunningRouter::site(std::string const& end, std::string const& name, bool here, bool clean) {
    say(fmt::format("{} {} {}", here ? "connected" : clean ? "left" : "lost", end, name));
}
void RunningRouter::carries(Route const& route, RouterConfig const& config, bool now) {
    say(fmt::format("{} {} {} {}", now ? "carries" : "stops", route.topic, config.ends[route.from].name.name,
                    route.qos.reliable ? "reliable" : "best effort"));
}
void RunningRouter::note(std::string const& text) {
    say("note " + text);
}
void RunningRouter::total(std::string const& topic, std::string const& from, std::string const& to,
                          std::uint64_t samples, std::uint64_t, std::uint64_t refused, std::uint64_t dropped) {
    std::lock_guard const lock{signal_.mutex()};
    seen_.totals[topic + " " + from + " " + to] += samples;
    seen_.totals["refused"] += refused;
    seen_.totals["dropped"] += dropped;
}

} // namespace gridspace::router
