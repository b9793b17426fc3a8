// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "router/router.hpp"

#include "bus/topics.hpp"
#include "common/log.hpp"

#include <algorithm>
#include <catalog.h>
#include <fmt/format.h>
#include <utility>

namespace gridspace::router {
namespace {

constexpr std::size_t kMaxTypes = 4096; ///< whose IDL is kept

} // namespace

/// Passes on what is discovered at one end.
struct Router::Watch final : bus::DiscoveryObserver {
    Watch(Router& owner, std::size_t index) : router{owner}, end{index} {}

    void participant_found(bus::DiscoveredParticipant const& found) override {
        std::lock_guard const lock{router.mutex_};
        router.table_.participant_found(end, found.id, found.peer.program);
        if (router.config_.ends[end].link && sites.emplace(found.id, found.peer.process).second) {
            say(found.peer.process, true, true);
        }
        router.wake_();
    }
    void participant_gone(std::string const& id, bool clean) override {
        std::lock_guard const lock{router.mutex_};
        router.table_.participant_gone(id);
        if (auto const site = sites.find(id); site != sites.end()) {
            say(site->second, false, clean);
            sites.erase(site);
        }
        router.wake_();
    }
    void endpoint_found(bus::DiscoveredEndpoint const& endpoint) override {
        std::lock_guard const lock{router.mutex_};
        router.table_.endpoint_found(end, endpoint);
        router.wake_();
    }
    void endpoint_gone(std::string const& id) override {
        std::lock_guard const lock{router.mutex_};
        router.table_.endpoint_gone(id);
        router.wake_();
    }
    void say(std::string const& name, bool here, bool clean) {
        router.reports_.emplace_back([this, name, here, clean] {
            router.reporter_.site(router.config_.ends[end].name.name, name, here, clean);
        });
    }

    Router& router;
    std::size_t end;
    std::map<std::string, std::string> sites; ///< names by participant; on a link
};

Router::Router(RouterConfig const& config, Reporter& reporter) : config_{config}, reporter_{reporter}, table_{config} {}

Router::~Router() {
    close();
}

Result<void> Router::open(std::filesystem::path const& qos_file, std::function<void()> wake) {
    wake_ = std::move(wake);
    published_.resize(config_.ends.size());
    for (std::size_t i = 0; i < config_.ends.size(); ++i) {
        watches_.push_back(std::make_unique<Watch>(*this, i));
        auto end = End::open(config_.ends[i], config_.name, qos_file, watches_.back().get(), wake_);
        if (!end) {
            return std::unexpected{end.error()};
        }
        ends_.push_back(std::move(*end));
        bus::EndpointQos kept;
        kept.reliable = true;
        kept.durability = bus::Durability::transient_local;
        auto reader = ends_.back()->read("type_catalog", bus::codec_of<TypeCatalogEntry>(), kept,
                                         [this](std::span<std::byte const> cdr, bus::SampleHeader const&) {
                                             TypeCatalogEntry entry;
                                             if (bus::codec_of<TypeCatalogEntry>().decode(cdr, &entry)) {
                                                 std::lock_guard const lock{mutex_};
                                                 keep_type(entry.type_name().c_str(), entry.idl());
                                             }
                                         });
        if (!reader) {
            return std::unexpected{reader.error()};
        }
        type_readers_.push_back(std::move(*reader));
    }
    return {};
}

void Router::keep_type(std::string const& type, std::string const& idl) {
    if (idl_.contains(type)) {
        return;
    }
    bool const fits =
        idl_.size() < kMaxTypes && idl.size() <= bus::kLongestIdl && idl_octets_ + idl.size() <= bus::kMostIdl;
    if (fits) {
        idl_octets_ += idl.size();
        idl_.emplace(type, idl);
        wake_();
    } else if (!std::exchange(types_are_full_, true)) {
        log::warning("the IDL of {} types is kept, {} octets; that of others is not: '{}' has {} octets", idl_.size(),
                     idl_octets_, type, idl.size());
    }
}

std::string Router::idl_of(std::string const& type) {
    if (std::string_view const ours = bus::idl_of_type(type); !ours.empty()) {
        return std::string{ours};
    }
    std::lock_guard const lock{mutex_};
    auto const heard = idl_.find(type);
    return heard == idl_.end() ? "" : heard->second;
}

void Router::update() {
    std::vector<Route> wanted;
    std::vector<std::string> notes;
    std::vector<std::function<void()>> reports;
    {
        std::lock_guard const lock{mutex_};
        wanted = table_.routes();
        notes = table_.take_notes();
        reports.swap(reports_);
    }
    for (auto const& report : reports) {
        report();
    }
    for (std::string const& note : notes) {
        reporter_.note(note);
    }
    for (auto it = carried_.begin(); it != carried_.end();) {
        bool const stays =
            std::any_of(wanted.begin(), wanted.end(), [&](Route const& r) { return same_route(r, (*it)->route); });
        if (!stays) {
            close_route(**it);
            it = carried_.erase(it);
        } else {
            ++it;
        }
    }
    for (Route& route : wanted) {
        bool const is_open =
            std::any_of(carried_.begin(), carried_.end(), [&](auto const& c) { return same_route(route, c->route); });
        if (!is_open) {
            open_route(std::move(route));
        }
    }
    publish_types();
}

void Router::note_silent_links() {
    for (auto const& watch : watches_) {
        auto const& link = config_.ends[watch->end].link;
        if (!link || link->listens) {
            continue; // who listens cannot know whether somebody ought to have come
        }
        std::unique_lock lock{mutex_};
        bool const silent = watch->sites.empty();
        lock.unlock();
        if (silent) {
            reporter_.note(
                fmt::format("{}: no router has answered at {}:{} yet{}; it goes on trying",
                            config_.ends[watch->end].name.name, link->address, link->port,
                            link->tls ? " (does one listen there, with TLS and a certificate of the same authority?)"
                                      : " (does one listen there, without TLS?)"));
        }
    }
}

void Router::open_route(Route route) {
    auto carried = std::make_unique<Carried>();
    carried->route = std::move(route);
    Route const& r = carried->route;
    bus::Codec codec; // octets, whatever the type
    codec.type_name = r.type;
    codec.keyed = r.keyed;
    auto const refuse = [&](Error const& error) {
        if (refused_.insert(r.topic + "/" + r.type).second) {
            reporter_.note(fmt::format("'{}' is not carried: {}", r.topic, describe(error)));
        }
    };
    std::string const idl = idl_of(r.type);
    for (std::size_t const to : r.to) {
        auto lane = ends_[to]->open_lane(r.topic, codec, r.qos, r.depth, idl);
        if (!lane) {
            refuse(lane.error());
            return;
        }
        (*lane)->total = &totals_[{r.topic, r.from, to}];
        carried->lanes.emplace_back(to, std::move(*lane));
    }
    End* const from = ends_[r.from].get();
    auto reader =
        from->read(r.topic, codec, r.qos,
                   [this, from, raw = carried.get()](std::span<std::byte const> cdr, bus::SampleHeader const& header) {
                       if (!table_.takes(raw->route.from, from->peer(header.peer).program)) {
                           return; // another router wrote it: it has been carried already
                       }
                       for (auto const& [to, lane] : raw->lanes) {
                           ends_[to]->carry(lane, cdr, header.source_ns);
                       }
                   });
    if (!reader) {
        refuse(reader.error());
        return;
    }
    carried->reader = std::move(*reader);
    reporter_.carries(r, config_, true);
    carried_.push_back(std::move(carried));
}

void Router::close_route(Carried& carried) {
    carried.reader.reset();
    for (auto& [to, lane] : carried.lanes) {
        ends_[to]->close_lane(lane);
    }
    reporter_.carries(carried.route, config_, false);
}

void Router::publish_types() {
    for (auto const& carried : carried_) {
        std::string const idl = idl_of(carried->route.type);
        for (std::size_t const to : carried->route.to) {
            if (!idl.empty() && published_[to].insert(carried->route.type).second) {
                ends_[to]->publish_type(carried->route.type, idl);
            }
        }
    }
}

void Router::close() {
    if (ends_.empty()) {
        return;
    }
    for (auto const& carried : carried_) {
        close_route(*carried);
    }
    carried_.clear();
    type_readers_.clear();
    ends_.clear(); // writes what waits; discovery ends before the watches go
    for (auto const& [way, total] : totals_) {
        auto const& [topic, from, to] = way;
        reporter_.total(topic, config_.ends[from].name.name, config_.ends[to].name.name, total.samples, total.octets,
                        total.refused, total.dropped);
    }
    totals_.clear();
    watches_.clear();
}

} // namespace gridspace::router
