// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/push.hpp"

#include "common/log.hpp"
#include "monitor/app/json_text.hpp"

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
constexpr std::size_t kMaxViews = 48, kMaxNames = 64, kMaxPixels = 4000;
constexpr std::size_t kLongestId = 64, kLongestName = 256; // octets
constexpr std::size_t kMaxPoints = 65'536;                 ///< of a view: 1 MiB
// A client's queue holds 32 messages and 4 MiB (web::Limits) before it loses some: with what may wait already, these
// views and all other messages of one step fit.
constexpr std::size_t kFewMessages = 4, kFewOctets = 256 * 1024;      ///< that may wait when a view is drawn
constexpr std::size_t kViewsAtOnce = 12, kOctetsAtOnce = 1024 * 1024; ///< of a client in one step
constexpr std::chrono::milliseconds kViewPeriod{200};
constexpr std::chrono::milliseconds kDrawing{15}; ///< of a step, for all clients together

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
    inboxes_.try_emplace(client);
}

void PushHub::closed(web::ClientId client) {
    std::lock_guard const lock{mutex_};
    inboxes_.erase(client);
}

void PushHub::message(web::ClientId client, std::string const& text) {
    Json const json = Json::parse(text, nullptr, false);
    if (!json.is_object() || !json.contains("op")) {
        return; // what we do not understand is not answered
    }
    if (json["op"] == "seek") {
        std::lock_guard const lock{mutex_};
        if (auto const it = inboxes_.find(client); it != inboxes_.end()) {
            it->second.seek = number(json, "t", NAN);
        }
        return;
    }
    if (json["op"] != "view" || !json.contains("id") || !json["id"].is_string()) {
        return;
    }
    View view;
    view.id = json["id"].get<std::string>();
    if (view.id.size() > kLongestId) {
        return; // a shortened one would be another
    }
    for (Json const& name : json.value("names", Json::array())) {
        if (name.is_string() && name.get_ref<std::string const&>().size() <= kLongestName &&
            view.names.size() < kMaxNames) {
            view.names.push_back(name.get<std::string>());
        }
    }
    view.from_s = number(json, "t0", 0);
    view.to_s = number(json, "t1", 0);
    view.window_s = number(json, "window_s", 0);
    double const widest = std::min(static_cast<double>(kMaxPixels),
                                   static_cast<double>(kMaxPoints) / static_cast<double>(2 * view.names.size() + 1));
    view.pixels = static_cast<std::size_t>(std::clamp(number(json, "px", 800), 16.0, widest));
    std::lock_guard const lock{mutex_};
    auto const it = inboxes_.find(client);
    if (it != inboxes_.end() && (it->second.views.contains(view.id) || it->second.views.size() < 4 * kMaxViews)) {
        it->second.views[view.id] = std::move(view);
    }
}

/// Requests of clients become the views that they are sent.
void PushHub::collect() {
    std::map<web::ClientId, Inbox> said;
    {
        std::lock_guard const lock{mutex_};
        for (auto& [id, inbox] : inboxes_) {
            said.emplace(id, std::exchange(inbox, {}));
        }
    }
    std::erase_if(clients_, [&](auto const& entry) { return !said.contains(entry.first); });
    for (auto& [id, inbox] : said) {
        Client& client = clients_[id];
        std::erase_if(client.views, [&](auto const& entry) { // the old ones make room first
            auto const it = inbox.views.find(entry.first);
            return it != inbox.views.end() && it->second.names.empty();
        });
        for (auto& [name, view] : inbox.views) {
            if (!view.names.empty() && (client.views.contains(name) || client.views.size() < kMaxViews)) {
                client.views[name] = std::move(view);
            }
        }
        if (inbox.seek) {
            seek(client, *inbox.seek);
        }
    }
}

void PushHub::seek(Client& client, double at_s) {
    client.at_s = std::isfinite(at_s) ? std::optional{at_s} : std::nullopt;
    client.moved = true;
    for (auto& [id, view] : client.views) {
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
    return json_text(out);
}

std::string PushHub::series(View& view, std::optional<double> at_s) const {
    Json header{{"op", "series"}, {"id", view.id}, {"series", Json::array()}};
    std::string numbers;
    std::int64_t newest = INT64_MIN;
    {
        std::lock_guard const lock{run_.mutex};
        for (std::string const& name : view.names) {
            if (auto const [window, column] = run_.find_signal(name); window != nullptr && !window->empty()) {
                newest = std::max({newest, window->newest_ns(), ns(run_.clock.time_s)}); // all pictures end there
            }
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
        std::lock_guard const lock{run_.mutex}; // for each by itself: others wait for it
        auto const [window, column] = run_.find_signal(name);
        if (window == nullptr) {
            continue;
        }
        stream::Plot plot = window->plot(column, from, to, view.pixels);
        bool const steps = window->columns()[column].steps;
        if (double const end = static_cast<double>(std::min(to, newest)) * 1e-9;
            steps && !plot.times_s.empty() && plot.times_s.back() < end) {
            plot.times_s.push_back(end); // it holds
            plot.values.push_back(plot.values.back());
        }
        header["series"].push_back({{"name", name},
                                    {"unit", window->columns()[column].unit},
                                    {"steps", steps},
                                    {"points", plot.times_s.size()}});
        append(numbers, plot.times_s);
        append(numbers, plot.values);
    }
    header["t0"] = static_cast<double>(from) * 1e-9;
    header["t1"] = static_cast<double>(to) * 1e-9;
    // Length of the header, the header, blanks up to a multiple of eight, then the numbers.
    std::string text = json_text(header);
    text.append((8 - (4 + text.size()) % 8) % 8, ' ');
    auto const size = static_cast<std::uint32_t>(text.size());
    std::string out(4, '\0');
    std::memcpy(out.data(), &size, 4);
    return out + text + numbers;
}

bool PushHub::step(web::Server& server, std::chrono::steady_clock::time_point now) {
    collect();
    if (clients_.empty()) {
        return true;
    }
    if (now - state_sent_ >= kStatePeriod) {
        bool const topics_due = now - topics_sent_ >= kTopicsPeriod;
        tell(server, topics_due);
        state_sent_ = now;
        topics_sent_ = topics_due ? now : topics_sent_;
    }
    return draw(server, now);
}

/// What all clients are sent.
void PushHub::tell(web::Server& server, bool topics_due) {
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
        if (client.signals_sent != signals) {
            client.signals_sent = signals;
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
        } else if (server.waiting(id).messages <= kViewsAtOnce && std::exchange(client.moved, false)) {
            server.push(id, {.octets = state_at(client.at_s), .lasting = true});
        }
        if (topics_due || client.fresh) {
            topics = topics == nullptr ? share(wrapped("topics", "list", api_.topics())) : topics;
            streams = streams == nullptr ? share(wrapped("streams", "list", api_.streams())) : streams;
            server.push(id, {.octets = topics});
            server.push(id, {.octets = streams});
        }
        if (std::uint64_t const dropped = server.dropped(id); dropped != client.dropped_reported) {
            client.dropped_reported = dropped;
            for (auto& [name, view] : client.views) {
                view.asked = true; // it may be the one that was lost, and of a finished run nothing new would come
            }
            server.push(id, {.octets = share(fmt::format(R"({{"op":"dropped","count":{}}})", dropped))});
        }
        client.fresh = false;
    }
}

/// The views that are due, of one client after the other, while there is time.
bool PushHub::draw(web::Server& server, std::chrono::steady_clock::time_point now) {
    auto const deadline = std::chrono::steady_clock::now() + kDrawing;
    bool all = true;
    auto client_at = clients_.upper_bound(drawn_last_);
    for (std::size_t i = 0; i < clients_.size(); ++i, ++client_at) {
        client_at = client_at == clients_.end() ? clients_.begin() : client_at;
        auto& [id, client] = *client_at;
        web::Waiting const waiting = server.waiting(id);
        if (waiting.messages > kFewMessages || waiting.octets > kFewOctets) {
            continue;
        }
        std::size_t messages = 0, octets = 0;
        auto view_at = client.views.upper_bound(client.drawn_last);
        for (std::size_t k = 0; k < client.views.size(); ++k, ++view_at) {
            view_at = view_at == client.views.end() ? client.views.begin() : view_at;
            View& view = view_at->second;
            if (!view.asked && now - view.drawn < kViewPeriod) {
                continue;
            }
            if (messages >= kViewsAtOnce || octets >= kOctetsAtOnce) {
                all = false;
                break;
            }
            view.drawn = now;
            client.drawn_last = view.id;
            std::string bytes;
            try {
                bytes = series(view, client.at_s);
            } catch (std::exception const& error) { // the others are drawn on
                view.asked = false;
                log::warning("a view of a client cannot be drawn: {}", error.what());
            }
            if (!bytes.empty()) {
                ++messages;
                octets += bytes.size();
                server.push(id, {.octets = share(std::move(bytes)), .binary = true});
            }
            if (std::chrono::steady_clock::now() >= deadline) {
                drawn_last_ = id;
                return false;
            }
        }
    }
    return all;
}

} // namespace gridspace::monitor
