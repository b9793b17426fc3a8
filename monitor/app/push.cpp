// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/push.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace gridspace::monitor {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::chrono::milliseconds kStatePeriod{200};
constexpr std::chrono::milliseconds kTopicsPeriod{1000};
constexpr std::size_t kMostViews = 48, kMostNames = 64, kMostPixels = 4000;

std::shared_ptr<std::string const> share(std::string text) {
    return std::make_shared<std::string const>(std::move(text));
}

/// {"op": …, "key": <JSON text that is ready>}
std::string wrapped(char const* op, char const* key, std::string const& json) {
    return fmt::format(R"({{"op":"{}","{}":{}}})", op, key, json);
}

double number(Json const& json, char const* key, double otherwise) {
    return json.contains(key) && json[key].is_number() ? json[key].get<double>() : otherwise;
}

std::int64_t ns(double seconds) {
    return static_cast<std::int64_t>(std::clamp(seconds * 1e9, -9e18, 9e18));
}

void append(std::string& out, std::vector<double> const& numbers) {
    static_assert(std::endian::native == std::endian::little, "the format is little-endian");
    out.append(reinterpret_cast<char const*>(numbers.data()), numbers.size() * sizeof(double));
}

} // namespace

void PushHub::opened(web::ClientId client) {
    std::lock_guard const lock{mutex_};
    clients_.try_emplace(client);
}

void PushHub::closed(web::ClientId client) {
    std::lock_guard const lock{mutex_};
    clients_.erase(client);
}

void PushHub::message(web::ClientId client, std::string const& text) {
    Json const json = Json::parse(text, nullptr, false);
    if (!json.is_object() || !json.contains("op")) {
        return; // what we do not understand is not answered
    }
    if (json["op"] == "seek") {
        seek(client, number(json, "t", NAN));
        return;
    }
    if (json["op"] != "view" || !json.contains("id") || !json["id"].is_string()) {
        return;
    }
    View view;
    view.id = json["id"].get<std::string>().substr(0, 64);
    for (Json const& name : json.value("names", Json::array())) {
        if (name.is_string() && view.names.size() < kMostNames) {
            view.names.push_back(name.get<std::string>());
        }
    }
    view.from_s = number(json, "t0", 0);
    view.to_s = number(json, "t1", 0);
    view.window_s = number(json, "window_s", 0);
    view.pixels = static_cast<std::size_t>(std::clamp(number(json, "px", 800), 16.0, static_cast<double>(kMostPixels)));
    std::lock_guard const lock{mutex_};
    auto const it = clients_.find(client);
    if (it == clients_.end()) {
        return;
    }
    if (view.names.empty()) {
        it->second.views.erase(view.id);
    } else if (it->second.views.contains(view.id) || it->second.views.size() < kMostViews) {
        it->second.views[view.id] = std::move(view);
    }
}

void PushHub::seek(web::ClientId client, double at_s) {
    std::lock_guard const lock{mutex_};
    auto const it = clients_.find(client);
    if (it == clients_.end()) {
        return;
    }
    Client& looking = it->second;
    looking.at_s = std::isfinite(at_s) ? std::optional{at_s} : std::nullopt;
    looking.moved = true;
    for (auto& [id, view] : looking.views) {
        view.asked = view.asked || view.window_s > 0; // it ends where the client looks
    }
}

std::string PushHub::values(std::optional<double> at_s, std::size_t& count) const {
    std::lock_guard const lock{run_.mutex};
    Json out = Json::array();
    for (auto const& [key, window] : run_.signals) {
        for (std::size_t c = 0; window != nullptr && c < window->columns().size(); ++c) {
            double const value = at_s ? window->value_at(c, ns(*at_s)) : window->empty() ? NAN : window->newest(c);
            out.push_back(std::isnan(value) ? Json(nullptr) : Json(value));
        }
    }
    count = out.size();
    return out.dump();
}

std::string PushHub::series(View& view, std::optional<double> at_s) const {
    Json header{{"op", "series"}, {"id", view.id}, {"series", Json::array()}};
    std::string numbers;
    std::lock_guard const lock{run_.mutex};
    std::int64_t newest = INT64_MIN;
    for (std::string const& name : view.names) {
        if (auto const [window, column] = run_.find_signal(name); window != nullptr && !window->empty()) {
            newest = std::max(newest, window->newest_ns());
        }
    }
    if (newest == INT64_MIN || (!view.asked && newest == view.newest_sent_ns)) {
        return {};
    }
    std::int64_t from = ns(view.from_s), to = ns(view.to_s);
    if (view.window_s != 0) {
        to = at_s && view.window_s > 0 ? std::min(newest, ns(*at_s)) : newest;
        from = view.window_s < 0 ? 0 : to - ns(view.window_s);
    } else if (!view.asked && view.newest_sent_ns > to) {
        return {}; // a fixed view that nothing new can change
    }
    view.asked = false;
    view.newest_sent_ns = newest;
    for (std::string const& name : view.names) {
        auto const [window, column] = run_.find_signal(name);
        if (window == nullptr) {
            continue;
        }
        stream::Plot const plot = window->plot(column, from, to, view.pixels);
        header["series"].push_back(
            {{"name", name}, {"unit", window->columns()[column].unit}, {"points", plot.times_s.size()}});
        append(numbers, plot.times_s);
        append(numbers, plot.values);
    }
    header["t0"] = static_cast<double>(from) * 1e-9;
    header["t1"] = static_cast<double>(to) * 1e-9;
    // Length of the header, the header, blanks up to a multiple of eight, then the numbers.
    std::string text = header.dump();
    text.append((8 - (4 + text.size()) % 8) % 8, ' ');
    auto const size = static_cast<std::uint32_t>(text.size());
    std::string out(4, '\0');
    std::memcpy(out.data(), &size, 4);
    return out + text + numbers;
}

void PushHub::step(web::Server& server, std::chrono::steady_clock::time_point now) {
    bool const state_due = now - state_sent_ >= kStatePeriod, topics_due = now - topics_sent_ >= kTopicsPeriod;
    std::lock_guard const lock{mutex_};
    if (clients_.empty() || !state_due) {
        return;
    }
    state_sent_ = now;
    std::uint64_t revision = 0, events = 0;
    {
        std::lock_guard const run_lock{run_.mutex};
        revision = run_.graph.revision();
        events = run_.events_seen;
    }
    std::size_t signals = 0;
    auto const state_at = [&](std::optional<double> at_s) {
        std::string const held = values(at_s, signals);
        return share(fmt::format(R"({{"op":"state","run":{},"values":{}}})", api_.run(), held));
    };
    auto const newest = state_at(std::nullopt);
    std::shared_ptr<std::string const> topics, streams, graph, names, network; // made when somebody needs them
    for (auto& [id, client] : clients_) {
        if (client.fresh) {
            network = network == nullptr ? share(wrapped("network", "network", api_.network())) : network;
            server.push(id, {.octets = network, .lasting = true});
        }
        if (client.graph_revision != revision) {
            client.graph_revision = revision;
            graph = graph == nullptr ? share(wrapped("graph", "graph", api_.graph())) : graph;
            server.push(id, {.octets = graph, .lasting = true});
        }
        if (client.signals_told != signals) {
            client.signals_told = signals;
            names = names == nullptr ? share(wrapped("signals", "list", api_.signals())) : names;
            server.push(id, {.octets = names, .lasting = true});
        }
        if (client.events_sent != events) {
            server.push(id, {.octets = share(wrapped("events", "list", api_.events(client.events_sent, 10'000))),
                             .lasting = true});
            client.events_sent = events;
        }
        if (!client.at_s) {
            server.push(id, {.octets = newest});
        } else if (std::exchange(client.moved, false)) {
            server.push(id, {.octets = state_at(client.at_s), .lasting = true});
        }
        if (topics_due || client.fresh) {
            topics = topics == nullptr ? share(wrapped("topics", "list", api_.topics())) : topics;
            streams = streams == nullptr ? share(wrapped("streams", "list", api_.streams())) : streams;
            server.push(id, {.octets = topics});
            server.push(id, {.octets = streams});
        }
        for (auto& [name, view] : client.views) {
            if (std::string bytes = series(view, client.at_s); !bytes.empty()) {
                server.push(id, {.octets = share(std::move(bytes)), .binary = true});
            }
        }
        if (std::uint64_t const dropped = server.dropped(id); dropped != client.dropped_told) {
            client.dropped_told = dropped;
            server.push(id, {.octets = share(fmt::format(R"({{"op":"dropped","count":{}}})", dropped))});
        }
        client.fresh = false;
    }
    if (topics_due) {
        topics_sent_ = now;
    }
}

} // namespace gridspace::monitor
