// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/member/topic_exchange.hpp"

#include "bus/key_hash.hpp"
#include "bus/topics.hpp"
#include "common/idl/cdr_visitor.hpp"
#include "common/idl/native_sample.hpp"
#include "common/log.hpp"
#include "timebox/door/door_message.hpp"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <memory_resource>
#include <tuple>

namespace gridspace::timebox {
namespace {

constexpr std::string_view kTime = "time_ns"; ///< when a sample takes effect, for readers that know its type

std::string text_of(BoxedTopic const& topic) {
    if (topic.idl.empty()) {
        return std::string{bus::idl_of_type(topic.type)};
    }
    std::ifstream stream{topic.idl};
    return {std::istreambuf_iterator<char>{stream}, {}};
}

} // namespace

TopicExchange::TopicExchange(bus::Node& node, MemberConfig const& config)
    : node_{node}, config_{config}, clock_{node},
      latency_ns_{clock_.lasting(node.time_base().ceil(config.latency_us / Rational{1'000'000}), 1)} {}

Result<std::unique_ptr<TopicExchange>> TopicExchange::open(bus::Node& node, MemberConfig const& config) {
    auto out = std::unique_ptr<TopicExchange>{new TopicExchange{node, config}};
    for (BoxedTopic const& topic : config.reads) {
        if (auto ok = out->add(topic, true); !ok) {
            return std::unexpected{ok.error()};
        }
    }
    for (BoxedTopic const& topic : config.writes) {
        if (auto ok = out->add(topic, false); !ok) {
            return std::unexpected{ok.error()};
        }
    }
    return out;
}

Result<void> TopicExchange::add(BoxedTopic const& wanted, bool to_program) {
    auto model = idl::parse(text_of(wanted));
    std::optional<std::size_t> const type = model ? model->find(wanted.type) : std::nullopt;
    if (!type) {
        return fail(ExitCode::usage,
                    fmt::format("no IDL defines the type '{}' of topic '{}'", wanted.type, wanted.topic),
                    "`idl: FILE` beside it names the file that does");
    }
    Topic& topic = topics_.emplace_back();
    topic.type = wanted.type;
    topic.codec.type_name = topic.type;
    topic.codec.keyed = model->is_keyed(*type);
    topic.door = {to_program, wanted.topic, wanted.type, topic.codec.keyed};
    if (bus::Codec const* const known = bus::find_codec(topic.type)) {
        topic.codec.max_size = known->max_size;
    }
    auto layout = idl::NativeLayout::create(std::make_shared<idl::Model const>(std::move(*model)), wanted.type);
    if (layout) {
        topic.layout = std::move(*layout);
        if (topic.codec.keyed) {
            topic.key.emplace(topic.layout->model(), topic.layout->type());
        }
    } else if (topic.codec.keyed) {
        return fail(ExitCode::usage,
                    fmt::format("the type '{}' of topic '{}': {}", wanted.type, wanted.topic, layout.error().message),
                    "its key must be found in its samples");
    }
    if (to_program) {
        auto reader = node_.cdr_reader(wanted.topic, topic.codec);
        if (!reader) {
            return std::unexpected{reader.error()};
        }
        topic.reader = std::move(*reader);
        hears_simulator_ = hears_simulator_ || node_.is_of_simulator(wanted.topic);
        return {};
    }
    auto writer = node_.cdr_writer(wanted.topic, topic.codec);
    if (!writer) {
        return std::unexpected{writer.error()};
    }
    topic.writer = std::move(*writer);
    return {};
}

DoorOptions TopicExchange::door() {
    std::vector<DoorTopic> topics;
    for (Topic const& topic : topics_) {
        topics.push_back(topic.door);
    }
    return {door_command(std::filesystem::absolute(node_.config().qos), config_.dds_domain, topics),
            [this](std::int64_t now_ns, std::span<std::byte const> octets) { take(now_ns, octets); }};
}

bool TopicExchange::find_key(Topic const& topic, std::span<std::byte const> cdr, bus::KeyHash& hash) const {
    auto const key = topic.key->key_of(cdr);
    if (key) {
        hash = bus::key_hash(*key, topic.key->is_short());
    }
    return key.has_value();
}

void TopicExchange::bring(Box& box) {
    struct Arrival {
        bus::Origin origin;
        std::uint32_t topic;
        std::vector<std::byte> cdr;
    };
    std::vector<Arrival> arrivals;
    std::uint32_t number = 0;
    for (Topic const& topic : topics_) {
        if (!topic.door.to_program) {
            continue;
        }
        for (auto& received : topic.reader->take()) {
            arrivals.push_back({received.origin, number, std::move(received.value.cdr)});
        }
        ++number;
    }
    std::sort(arrivals.begin(), arrivals.end(), [](Arrival const& a, Arrival const& b) {
        return std::tie(a.origin, a.topic) < std::tie(b.origin, b.topic);
    });
    for (Arrival const& arrival : arrivals) {
        Topic const& topic = topics_[arrival.topic]; // those that it reads come first
        std::int64_t const at_ns = clock_.of(arrival.origin.time);
        DoorMessage message;
        message.topic = arrival.topic;
        message.source_ns = node_.config().clock.epoch_unix_s * 1'000'000'000 + at_ns;
        message.keyed = topic.key ? 1 : 0;
        if (topic.key && !find_key(topic, arrival.cdr, message.key_hash)) {
            ++counters_.misfits;
            continue;
        }
        ++counters_.read;
        box.hand(at_ns, to_octets(message, arrival.cdr));
    }
}

void TopicExchange::take(std::int64_t now_ns, std::span<std::byte const> octets) {
    auto const message = door_message(octets);
    if (over_ || !message) {
        return;
    }
    std::uint32_t number = message->topic;
    for (Topic& topic : topics_) {
        if (topic.door.to_program || number-- > 0) {
            continue;
        }
        auto const body = octets.subspan(sizeof *message);
        std::vector<std::byte> cdr{body.begin(), body.end()};
        SimTime const effect = clock_.at_or_after(now_ns + latency_ns_);
        bus::KeyHash hash{};
        if (topic.key && !find_key(topic, cdr, hash)) {
            ++counters_.misfits;
            return;
        }
        not_before(topic, effect, cdr);
        topic.writer->write(cdr, effect, topic.key ? &hash : nullptr);
        last_effect_ = std::max(last_effect_.value_or(effect), effect);
        ++counters_.written;
        return;
    }
}

void TopicExchange::not_before(Topic const& topic, SimTime effect, std::vector<std::byte>& cdr) const {
    if (!topic.layout) {
        return;
    }
    std::int64_t const effect_ns = clock_.of(effect);
    auto const offset = topic.layout->offset_of(kTime, idl::Kind::int64);
    auto const told = idl::find_integer(topic.layout->model(), topic.layout->type(), cdr, kTime);
    if (!offset || !told || *told >= effect_ns) {
        return;
    }
    std::pmr::monotonic_buffer_resource memory;
    auto* const sample = static_cast<std::byte*>(memory.allocate(topic.layout->size(), alignof(std::max_align_t)));
    if (idl::decode(*topic.layout, cdr, sample, memory)) {
        std::memcpy(sample + *offset, &effect_ns, sizeof effect_ns);
        std::vector<std::byte> later;
        if (idl::encode(*topic.layout, sample, later)) {
            cdr = std::move(later);
        }
    }
}

} // namespace gridspace::timebox
