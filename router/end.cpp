// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "router/end.hpp"

#include "common/text.hpp"
#include "common/unique_fd.hpp"
#include "router/route_table.hpp"

#include <algorithm>
#include <catalog.h>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>

namespace gridspace::router {
namespace {

constexpr std::size_t kMaxWaiting = 32U << 20U; ///< octets in front of one end
constexpr std::chrono::milliseconds kLastWords{1000}, kLookForThem{20};
constexpr std::chrono::milliseconds kAddressPatience{2000}; ///< a link that was just set up

} // namespace

/// Threads inherit the network namespace of who makes them: all of a participant's, when it is made inside.
Result<void> End::inside(std::function<Result<void>()> const& body) const {
    if (config_.network_namespace.empty()) {
        return body();
    }
    Result<void> result;
    std::thread{[&] {
        UniqueFd const fd{::open(config_.network_namespace.c_str(), O_RDONLY | O_CLOEXEC)};
        if (!fd || ::setns(fd.get(), CLONE_NEWNET) != 0) {
            result = fail(ExitCode::environment,
                          fmt::format("cannot enter the network namespace '{}': {}", config_.network_namespace.string(),
                                      std::strerror(errno)),
                          "that needs root");
            return;
        }
        result = body();
    }}.join();
    return result;
}

Result<std::unique_ptr<End>> End::open(EndConfig const& config, std::string const& router,
                                       std::filesystem::path const& qos_file, bus::DiscoveryObserver* observer,
                                       std::function<void()> freed) {
    std::unique_ptr<End> end{new End{config}};
    end->freed_ = std::move(freed);
    bus::ParticipantOptions options;
    options.process = router;
    options.program = std::string{kProgram};
    options.domain = static_cast<int>(config.domain);
    options.qos_file = config.qos.empty() ? qos_file : config.qos;
    options.profile = config.profile;
    options.addresses = config.addresses;
    options.address_patience = kAddressPatience;
    auto joined = end->inside([&]() -> Result<void> {
        auto participant = config.link ? bus::join_over_tcp(std::move(options), *config.link, observer)
                                       : bus::Participant::create(std::move(options), observer);
        if (!participant) {
            return std::unexpected{participant.error()};
        }
        end->participant_ = std::move(*participant);
        bus::EndpointQos kept;
        kept.reliable = true;
        kept.durability = bus::Durability::transient_local;
        auto types =
            bus::create_writer_like(*end->participant_, "type_catalog", bus::codec_of<TypeCatalogEntry>(), kept, 1);
        if (!types) {
            return std::unexpected{types.error()};
        }
        end->types_ = std::move(*types);
        return {};
    });
    if (!joined) {
        return fail(joined.error().code, fmt::format("{}: {}", config.name.name, joined.error().message),
                    joined.error().remedy);
    }
    end->thread_ = std::jthread{[raw = end.get()](std::stop_token const& stop) { raw->write_waiting(stop); }};
    return end;
}

End::~End() {
    thread_ = {}; // what waits is written
    types_.reset();
    participant_.reset();
}

Result<std::unique_ptr<bus::RawReader>> End::read(std::string const& topic, bus::Codec const& codec,
                                                  bus::EndpointQos const& qos, bus::SampleHandler handler) {
    std::unique_ptr<bus::RawReader> out;
    auto done = inside([&]() -> Result<void> {
        auto reader = bus::create_reader_like(*participant_, topic, codec, qos, std::move(handler));
        if (!reader) {
            return std::unexpected{reader.error()};
        }
        out = std::move(*reader);
        return {};
    });
    return done ? Result<std::unique_ptr<bus::RawReader>>{std::move(out)} : std::unexpected{done.error()};
}

Result<std::shared_ptr<Lane>> End::open_lane(std::string const& topic, bus::Codec const& codec,
                                             bus::EndpointQos const& qos, std::int32_t depth, std::string_view idl) {
    auto lane = std::make_shared<Lane>();
    lane->topic = topic;
    if (auto model = idl::parse(idl); codec.keyed && model) {
        if (auto const type = model->find(codec.type_name)) {
            lane->model = std::move(*model);
            lane->key.emplace(lane->model, *type);
        }
    }
    auto done = inside([&]() -> Result<void> {
        auto writer = bus::create_writer_like(*participant_, topic, codec, qos, depth);
        if (!writer) {
            return std::unexpected{writer.error()};
        }
        lane->writer = std::move(*writer);
        return {};
    });
    return done ? Result<std::shared_ptr<Lane>>{std::move(lane)} : std::unexpected{done.error()};
}

void End::carry(std::shared_ptr<Lane> const& lane, std::span<std::byte const> cdr, std::int64_t source_ns) {
    {
        std::lock_guard const lock{mutex_};
        waiting_octets_ += cdr.size();
        for (auto oldest = waiting_.begin(); waiting_octets_ > kMaxWaiting;) {
            oldest = std::find_if(oldest, waiting_.end(), [](Item const& item) { return !item.last; });
            if (oldest == waiting_.end()) {
                break;
            }
            waiting_octets_ -= oldest->cdr.size();
            ++oldest->lane->total->dropped;
            oldest = waiting_.erase(oldest);
        }
        waiting_.push_back({lane, {cdr.begin(), cdr.end()}, source_ns, false});
    }
    arrived_.notify_one();
}

void End::close_lane(std::shared_ptr<Lane> lane) {
    {
        std::lock_guard const lock{mutex_};
        waiting_.push_back({std::move(lane), {}, 0, true});
    }
    arrived_.notify_one();
}

void End::write_waiting(std::stop_token const& stop) {
    std::deque<Item> items;
    while (true) {
        items.clear();
        {
            std::unique_lock lock{mutex_};
            auto const some = [&] { return !waiting_.empty(); };
            if (closed_.empty()) {
                arrived_.wait(lock, stop, some);
            } else {
                arrived_.wait_for(lock, stop, kLookForThem, some);
            }
            items.swap(waiting_);
            waiting_octets_ = 0;
        }
        for (Item const& item : items) {
            write(item);
        }
        bool const ends = items.empty() && stop.stop_requested();
        give_up_closed(ends);
        if (ends) {
            return;
        }
    }
}

/// `at_once`: each is waited for as long as it has; otherwise only looked at, so that nobody else's samples wait.
void End::give_up_closed(bool at_once) {
    auto const now = std::chrono::steady_clock::now();
    auto const given_up = std::erase_if(closed_, [&](Closed const& closed) {
        auto const left = std::chrono::duration_cast<std::chrono::milliseconds>(closed.until - now);
        bool const acknowledged = closed.lane->writer->wait_acknowledged(
            at_once ? std::max(left, std::chrono::milliseconds{0}) : std::chrono::milliseconds{0});
        bool const over = acknowledged || at_once || left.count() <= 0;
        if (over) {
            closed.lane->writer.reset();
        }
        return over;
    });
    if (given_up > 0 && !at_once) {
        freed_();
    }
}

void End::write(Item const& item) {
    Lane& lane = *item.lane;
    if (item.last) {
        closed_.push_back({item.lane, std::chrono::steady_clock::now() + kLastWords});
        return;
    }
    bus::KeyHash hash;
    bus::KeyHash const* key_hash = nullptr;
    if (lane.key) {
        auto const key = lane.key->key_of(item.cdr);
        if (!key) {
            ++lane.total->refused;
            return;
        }
        hash = bus::key_hash(*key, lane.key->is_short());
        key_hash = &hash;
    }
    bool const has_time = item.source_ns > 0;
    if (lane.writer->write_cdr(item.cdr, has_time ? std::optional{item.source_ns} : std::nullopt, key_hash)) {
        ++lane.total->samples;
        lane.total->octets += item.cdr.size();
    } else {
        ++lane.total->refused;
    }
}

void End::publish_type(std::string const& type, std::string const& idl) {
    TypeCatalogEntry entry;
    entry.type_name(type.c_str());
    entry.idl(idl);
    (void)types_->write(&entry, std::nullopt);
}

} // namespace gridspace::router
